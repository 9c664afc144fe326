// VTK's vtkThinPlateSplineTransform on the same work: bench_splines_vtk LANDMARKS [OUTPUT].
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkThinPlateSplineTransform.h>

#include "bench/splines/workload.h"

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 100;
  if (count < 4) return std::fputs("usage: bench_splines_vtk LANDMARKS [OUTPUT]\n", stderr), 2;
  const bench::Workload work = bench::workload(count);
  const auto points = [](const std::vector<bench::Point>& from, vtkPoints* out) {
    out->SetDataTypeToDouble();
    for (const bench::Point& p : from)
      out->InsertNextPoint(p.data());
  };
  vtkNew<vtkPoints> source, target, in, out;
  points(work.source, source);
  points(work.target, target);
  points(work.points, in);
  out->SetDataTypeToDouble();
  vtkNew<vtkThinPlateSplineTransform> transform;
  transform->SetBasisToR();
  transform->SetSourceLandmarks(source);
  transform->SetTargetLandmarks(target);
  const double fit = bench::milliseconds([&] { transform->Update(); });
  const double apply = bench::milliseconds([&] { transform->TransformPoints(in, out); });
  bench::report("VTK", count, fit, apply);
  if (argc > 2) {
    std::vector<bench::Point> carried(work.points.size());
    for (size_t i = 0; i < carried.size(); ++i)
      out->GetPoint(static_cast<vtkIdType>(i), carried[i].data());
    bench::write_points(argv[2], carried);
  }
}
