#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkMarchingCubes.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <cmath>

#include "bench/smas/workload.h"

namespace fascia::bench {

Meshed mesh_by_vtk(const splines::Spline& field, const Bounds& box, double cell) {
  Meshed out;
  const double started = processor_time();
  const Vec3 origin = box.lower - Vec3::Constant(cell);
  int count[3];
  for (int k = 0; k < 3; ++k)
    count[k] = static_cast<int>(std::ceil(box.size()[k] / cell)) + 3;
  std::vector<Vec3> points;
  points.reserve(static_cast<size_t>(count[0]) * count[1] * count[2]);
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x)
        points.push_back(origin + cell * Vec3(x, y, z));
  const Eigen::MatrixXd values = field.values(points);
  out.evaluations = static_cast<long>(points.size());
  vtkNew<vtkImageData> image;
  image->SetDimensions(count);
  image->SetOrigin(origin[0], origin[1], origin[2]);
  image->SetSpacing(cell, cell, cell);
  vtkNew<vtkDoubleArray> scalars;
  scalars->SetArray(const_cast<double*>(values.data()), values.size(), 1);
  image->GetPointData()->SetScalars(scalars);
  vtkNew<vtkMarchingCubes> cubes;
  cubes->SetInputData(image);
  cubes->SetValue(0, 0.0);
  cubes->ComputeNormalsOff();
  cubes->ComputeGradientsOff();
  cubes->ComputeScalarsOff();
  cubes->Update();
  vtkPolyData* surface = cubes->GetOutput();
  out.seconds = processor_time() - started;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    double p[3];
    surface->GetPoint(i, p);
    out.mesh.vertices.push_back({p[0], p[1], p[2]});
  }
  vtkCellArray* cells = surface->GetPolys();
  vtkIdType size;
  const vtkIdType* corners;
  for (cells->InitTraversal(); cells->GetNextCell(size, corners);)
    out.mesh.triangles.push_back(
        {static_cast<int>(corners[0]), static_cast<int>(corners[1]), static_cast<int>(corners[2])});
  return out;
}

}  // namespace fascia::bench
