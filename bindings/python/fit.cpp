#include "fit.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "fascia/fascia.hpp"

namespace py = pybind11;
using fascia::api::Asset;
using fascia::api::Fit;

namespace fascia::python {
namespace {

using Points = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Place = std::tuple<std::uint32_t, std::array<std::uint32_t, 3>, std::array<float, 3>>;

fascia_fit_options fit_options(int level, int iterations, bool finds_scale, float ridge, float sparsity,
                               float smoothness, const std::optional<std::array<float, 4>>& camera) {
  fascia_fit_options options = fascia_default_fit_options();
  options.level = level;
  options.iterations = iterations;
  options.finds_scale = finds_scale ? 1 : 0;
  options.ridge = ridge;
  options.sparsity = sparsity;
  options.smoothness = smoothness;
  for (std::size_t k = 0; camera && k < 2; ++k) {
    options.focal[k] = (*camera)[k];
    options.centre[k] = (*camera)[k + 2];
  }
  return options;
}

std::unique_ptr<Fit> make_fit(const Asset& asset, const py::object& landmarks,
                              const fascia_fit_options& options) {
  if (py::isinstance<py::str>(landmarks))
    return std::make_unique<Fit>(asset, landmarks.cast<std::string>(), options);
  const auto list = landmarks.cast<py::sequence>();
  if (py::len(list) == 0) throw py::value_error("there are no landmarks");
  if (py::isinstance<py::tuple>(list[0])) {
    std::vector<fascia_fit_place> places;
    for (const auto& [mesh, vertices, shares] : landmarks.cast<std::vector<Place>>())
      places.push_back({mesh, {vertices[0], vertices[1], vertices[2]}, {shares[0], shares[1], shares[2]}});
    return std::make_unique<Fit>(asset, places, options);
  }
  const auto texts = landmarks.cast<std::vector<std::optional<std::string>>>();
  std::vector<const char*> names;
  for (const auto& text : texts)
    names.push_back(text ? text->c_str() : nullptr);
  return std::make_unique<Fit>(asset, std::span<const char* const>(names), options);
}

std::span<const float> numbers_of(const std::optional<Points>& array) {
  if (!array) return {};
  return {array->data(), static_cast<std::size_t>(array->size())};
}

py::dict push(Fit& fit, const Asset& asset, const Points& points, const std::optional<Points>& weights) {
  const fascia_fit_result found = [&] {
    const auto numbers = numbers_of(points), seen = numbers_of(weights);
    py::gil_scoped_release released;
    return fit.push(numbers, seen);
  }();
  py::dict result;
  result["seen"] = found.seen;
  result["residual"] = found.residual;
  result["scale"] = found.scale;
  py::array_t<float> head({4, 4});
  for (py::ssize_t row = 0; row < 4; ++row)
    for (py::ssize_t column = 0; column < 4; ++column)
      head.mutable_at(row, column) = found.head[4 * column + row];
  result["head"] = head;
  result["values"] = py::array_t<float>(static_cast<py::ssize_t>(asset.channels().count), found.values);
  result["landmarks"] = py::array_t<float>(
      {static_cast<py::ssize_t>(fit.info().landmark_count), py::ssize_t{3}}, found.landmarks);
  return result;
}

/// A fit with the asset whose channels it names.
struct AssetsFit {
  Asset asset;
  std::unique_ptr<Fit> fit;
};

}  // namespace

void add_fit(py::module_& module) {
  const fascia_fit_options usual = fascia_default_fit_options();
  py::class_<AssetsFit>(module, "Fit", "From a stream of landmarks to muscles. For one thread at a time.")
      .def(py::init([](const Asset& asset, const py::object& landmarks, int level, int iterations,
                       bool finds_scale, float ridge, float sparsity, float smoothness,
                       const std::optional<std::array<float, 4>>& camera) {
             return std::make_unique<AssetsFit>(AssetsFit{
                 asset,
                 make_fit(asset, landmarks,
                          fit_options(level, iterations, finds_scale, ridge, sparsity, smoothness, camera))});
           }),
           py::arg("asset"), py::arg("landmarks") = "ibug68", py::arg("level") = usual.level,
           py::arg("iterations") = usual.iterations, py::arg("finds_scale") = usual.finds_scale != 0,
           py::arg("ridge") = usual.ridge, py::arg("sparsity") = usual.sparsity,
           py::arg("smoothness") = usual.smoothness, py::arg("camera") = py::none(),
           "landmarks: a detector's mark-up (\"ibug68\", \"mediapipe478\"), a name (or None) a point, or a "
           "place "
           "a point: (mesh, three vertices, their shares). camera: focal lengths and centre in pixels, for "
           "points "
           "in an image.")
      .def_property_readonly(
          "names",
          [](const AssetsFit& self) {
            const fascia_fit_info info = self.fit->info();
            return std::vector<std::string>(info.names, info.names + info.landmark_count);
          },
          "The landmarks that lie on the rig's skin.")
      .def_property_readonly("point_count",
                             [](const AssetsFit& self) { return self.fit->info().point_count; })
      .def_property_readonly("dimensions", [](const AssetsFit& self) { return self.fit->info().dimensions; })
      .def(
          "set_neutral",
          [](AssetsFit& self, const Points& points, const std::optional<Points>& weights) {
            self.fit->set_neutral(numbers_of(points), numbers_of(weights));
          },
          py::arg("points"), py::arg("weights") = py::none(), "Takes a frame of the same face at rest.")
      .def(
          "push",
          [](AssetsFit& self, const Points& points, const std::optional<Points>& weights) {
            return push(*self.fit, self.asset, points, weights);
          },
          py::arg("points"), py::arg("weights") = py::none(),
          "The next frame: point_count x dimensions numbers, nan where a point is not seen. Returns seen, "
          "residual "
          "(metres), scale, head (4 x 4), values (as Face.values) and landmarks: copies.")
      .def(
          "reset", [](AssetsFit& self) { self.fit->reset(); }, "Forgets all frames, as after a cut.");
}

}  // namespace fascia::python
