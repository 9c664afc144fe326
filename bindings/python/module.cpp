// The Python module fascia._runtime: the classes of fascia.hpp, with arrays that are views of the runtime's
// memory.
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <optional>

#include "fit.h"
#include "research.h"
#include "views.h"

namespace py = pybind11;
using fascia::api::Asset;
using fascia::api::check;
using fascia::api::Curves;
using fascia::api::Face;
using fascia::api::sized;
using fascia::python::Floats;
using fascia::python::matrix_of;
using fascia::python::view;

namespace {

std::span<const std::uint8_t> bytes_of(const py::bytes& bytes) {
  char* data = nullptr;
  py::ssize_t size = 0;
  if (PyBytes_AsStringAndSize(bytes.ptr(), &data, &size) != 0) throw py::error_already_set();
  return {reinterpret_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size)};
}

py::dict channel_of(const fascia_channels& channels, std::uint32_t i) {
  py::dict channel;
  channel["name"] = channels.names[i];
  channel["group"] = channels.groups[i];
  channel["unit"] = channels.units[i];
  channel["minimum"] = channels.minimum[i];
  channel["maximum"] = channels.maximum[i];
  channel["rest"] = channels.rest[i];
  return channel;
}

py::list channels_of(const Asset& asset) {
  const fascia_channels channels = asset.channels();
  py::list list;
  for (std::uint32_t i = 0; i < channels.count; ++i)
    list.append(channel_of(channels, i));
  return list;
}

py::dict sets_of(const Asset& asset) {
  py::dict sets;
  for (std::uint32_t i = 0; i < asset.info().set_count; ++i) {
    const fascia_set_info info = asset.set(i);
    py::list members;
    for (std::uint32_t m = 0; m < info.member_count; ++m)
      members.append(info.members[m]);
    sets[info.name] = members;
  }
  return sets;
}

py::list meshes_of(const py::object& self) {
  const auto& asset = self.cast<const Asset&>();
  py::list meshes;
  for (std::uint32_t i = 0; i < asset.info().mesh_count; ++i) {
    const fascia_mesh_info info = asset.mesh(i);
    py::dict mesh;
    mesh["name"] = info.name;
    mesh["part"] = info.part;
    mesh["mesh"] = info.mesh;
    mesh["primitive"] = info.primitive;
    mesh["vertex_count"] = info.vertex_count;
    mesh["triangles"] = view(info.triangles, info.triangle_count, 3, self);
    meshes.append(mesh);
  }
  return meshes;
}

std::unique_ptr<Face> make_face(const Asset& asset, int level, const std::string& space,
                                const std::string& solver, int iterations) {
  fascia_face_options options = fascia_default_face_options();
  options.level = level;
  options.iterations = iterations;
  if (space == "mesh")
    options.space = FASCIA_SPACE_MESH;
  else if (space == "input")
    options.space = FASCIA_SPACE_INPUT;
  else if (space == "metres")
    options.space = FASCIA_SPACE_METRES;
  else
    throw py::value_error("space must be \"mesh\", \"input\" or \"metres\"");
  if (solver == "own")
    options.solver = FASCIA_SOLVER_OWN;
  else if (solver == "bullet")
    options.solver = FASCIA_SOLVER_BULLET;
  else if (solver == "reference")
    options.solver = FASCIA_SOLVER_REFERENCE;
  else
    throw py::value_error("solver must be \"own\", \"bullet\" or \"reference\"");
  py::gil_scoped_release released;
  return std::make_unique<Face>(asset, options);
}

template <class Function>
py::array_t<float> vectors_of(const py::object& self, std::uint32_t mesh, Function function) {
  auto vectors = sized<fascia_vectors>();
  check(function(self.cast<Face&>().handle(), mesh, &vectors));
  return view(vectors.data, vectors.count, vectors.stride / 4, self);
}

void set_layer(Face& face, std::uint32_t index, const std::string& combine, float weight,
               const std::optional<Floats>& mask) {
  constexpr std::array<const char*, 4> names = {"add", "max", "saturate", "override"};
  const auto found = std::find(names.begin(), names.end(), combine);
  if (found == names.end())
    throw py::value_error("combine must be \"add\", \"max\", \"saturate\" or \"override\"");
  std::span<const float> weights;
  if (mask) weights = {mask->data(), static_cast<std::size_t>(mask->size())};
  if (mask && weights.size() != face.values().size())
    throw py::value_error("the mask must have one weight for each channel");
  face.set_layer(index, static_cast<fascia_combine>(found - names.begin()), weight, weights);
}

py::array_t<float> layer_values(const py::object& self, std::uint32_t layer) {
  const auto values = self.cast<Face&>().layer_values(layer);
  if (values.empty())
    throw fascia::api::Error(FASCIA_ERROR_ARGUMENT, "the face has no layer " + std::to_string(layer));
  return view(values.data(), static_cast<py::ssize_t>(values.size()), 0, self, true);
}

void move_head(Face& face, const Floats& matrix, float inertia_scale) {
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
    throw py::value_error("the matrix must be 4 x 4");
  fascia::api::Matrix4 by_columns;
  for (py::ssize_t row = 0; row < 4; ++row)
    for (py::ssize_t column = 0; column < 4; ++column)
      by_columns[static_cast<std::size_t>(4 * column + row)] = matrix.at(row, column);
  face.move_head(by_columns, inertia_scale);
}

py::class_<Asset> add_asset(py::module_& module) {
  py::class_<Asset> made(module, "Asset", "A loaded rig: immutable, for any thread.");
  made.def_static(
          "from_bytes", [](const py::bytes& bytes) { return Asset::load(bytes_of(bytes)); }, py::arg("bytes"),
          "Loads a rig from the bytes of a .glb file.")
      .def_property_readonly("channels", channels_of,
                             "One dictionary a channel: name, group, unit, minimum, maximum, rest.")
      .def_property_readonly("sets", sets_of, "Members of each vocabulary, by its name.")
      .def_property_readonly("meshes", meshes_of,
                             "One dictionary a mesh: name, part, vertex_count, triangles, ...")
      .def_property_readonly(
          "levels",
          [](const Asset& asset) {
            std::vector<std::string> names;
            for (std::uint32_t i = 0; i < asset.info().level_count; ++i)
              names.emplace_back(asset.level(i).name);
            return names;
          },
          "Names of the levels of detail, coarse to fine.")
      .def_property_readonly(
          "input_to_metres", [](const Asset& asset) { return matrix_of(asset.info().input_to_metres); },
          "4 x 4: from the file's axes and units to metres.")
      .def(
          "find_member",
          [](const Asset& asset, const std::string& name) {
            const Asset::Member found = asset.find_member(name);
            return std::make_pair(found.set, found.member);
          },
          py::arg("name"), "Indices of a member (\"arkit:jawOpen\"): its set's, and its own in that set.")
      .def(
          "texcoords",
          [](const py::object& self, std::uint32_t mesh) {
            const auto list = self.cast<const Asset&>().texcoords(mesh);
            const float* const data = list.empty() ? nullptr : list.front().data();
            return view(data, static_cast<py::ssize_t>(list.size()), 2, self);
          },
          py::arg("mesh") = 0,
          "Texture coordinates, a row for each vertex: a view; none if the file has none.");
  return made;
}

void add_curves(py::module_& module) {
  py::class_<Curves>(module, "Curves", "Named values over time: immutable, for any thread.")
      .def_static(
          "from_bytes",
          [](const py::bytes& bytes, double frames_per_second) {
            return Curves::load(bytes_of(bytes), frames_per_second);
          },
          py::arg("bytes"), py::arg("frames_per_second") = 0.0, "Loads a CSV, JSON or glTF file of curves.")
      .def_property_readonly("names",
                             [](const Curves& curves) {
                               const fascia_curves_info info = curves.info();
                               return std::vector<std::string>(info.names, info.names + info.count);
                             })
      .def_property_readonly(
          "notes",
          [](const Curves& curves) {
            const fascia_curves_info info = curves.info();
            return std::vector<std::string>(info.notes, info.notes + info.note_count);
          },
          "How the file was taken, and what was mended.")
      .def_property_readonly(
          "duration", [](const Curves& curves) { return curves.info().duration; }, "Seconds.");
}

py::class_<Face> add_face(py::module_& module) {
  py::class_<Face> made(module, "Face", "One head. For one thread at a time.");
  made.def(py::init(&make_face), py::arg("asset"), py::arg("level") = -1, py::arg("space") = "input",
           py::arg("solver") = "own", py::arg("iterations") = 0)
      .def_property_readonly(
          "values",
          [](const py::object& self) {
            const auto values = self.cast<Face&>().values();
            return view(values.data(), static_cast<py::ssize_t>(values.size()), 0, self, true);
          },
          "The channels' own values: a view, to read and write.")
      .def_property_readonly(
          "effective_values",
          [](const py::object& self) {
            const auto values = self.cast<Face&>().effective_values();
            return view(values.data(), static_cast<py::ssize_t>(values.size()), 0, self);
          },
          "What the last pose or step used: a view.")
      .def("set", &Face::set, py::arg("name"), py::arg("value"),
           "Sets a channel or a member (\"arkit:jawOpen\").")
      .def("set_member", &Face::set_member, py::arg("set"), py::arg("member"), py::arg("value"),
           "Sets a member by the indices that Asset.find_member gives.")
      .def("get", &Face::get, py::arg("name"))
      .def("clear", &Face::clear)
      .def(
          "set_layer", set_layer, py::arg("index"), py::arg("combine") = "add", py::arg("weight") = 1.0F,
          py::arg("mask") = py::none(),
          "Adds layer 1 to 7, or changes how it is combined with those below: \"add\", \"max\", \"saturate\" "
          "or \"override\". The mask has a weight for each channel.")
      .def("layer_values", layer_values, py::arg("layer"),
           "A layer's own values: a view, to read and write, without effect once the layer is removed.")
      .def("layer_set", &Face::layer_set, py::arg("layer"), py::arg("name"), py::arg("value"))
      .def("layer_set_member", &Face::layer_set_member, py::arg("layer"), py::arg("set"), py::arg("member"),
           py::arg("value"))
      .def("layer_clear", &Face::layer_clear, py::arg("layer"))
      .def("layer_remove", &Face::layer_remove, py::arg("layer"))
      .def("apply", &Face::apply, py::arg("curves"), py::arg("seconds"), py::arg("weight") = 1.0F,
           py::arg("layer") = 0)
      .def("pose", &Face::pose, py::call_guard<py::gil_scoped_release>(),
           "Goes to the pose in which all forces balance.")
      .def("step", &Face::step, py::arg("seconds"), py::call_guard<py::gil_scoped_release>(),
           "Lets time pass; False when the simulation had to be put back to rest.")
      .def("reset", &Face::reset)
      .def("move_head", move_head, py::arg("matrix"), py::arg("inertia_scale") = 1.0F,
           "Sets the pose of the head in the world before a step: 4 x 4, a rigid transform in metres.")
      .def("touch", &Face::touch, py::arg("mesh"), py::arg("vertex"), py::arg("force"),
           "Applies a force, newtons in the rig's axes, until touches are cleared.")
      .def("clear_touches", &Face::clear_touches)
      .def("set_acceleration", &Face::set_acceleration, py::arg("acceleration"),
           "Inertial acceleration of the tissue in the head's frame, m/s^2; zeros for none.")
      .def("look_at", &Face::look_at, py::arg("point"), py::arg("weight") = 1.0F)
      .def("blend", &Face::blend, py::arg("share"), py::arg("seconds"))
      .def("set_level", &Face::set_level, py::arg("level"), py::arg("seconds") = 0.25F)
      .def_property_readonly("level", &Face::level)
      .def(
          "positions",
          [](const py::object& self, std::uint32_t mesh) {
            return vectors_of(self, mesh, fascia_face_positions);
          },
          py::arg("mesh") = 0, "Vertex positions: a view that keeps up with the face.")
      .def(
          "normals",
          [](const py::object& self, std::uint32_t mesh) {
            return vectors_of(self, mesh, fascia_face_normals);
          },
          py::arg("mesh") = 0)
      .def(
          "tangents",
          [](const py::object& self, std::uint32_t mesh) {
            return vectors_of(self, mesh, fascia_face_tangents);
          },
          py::arg("mesh") = 0,
          "Unit tangents and their handedness, 4 numbers each; none if the mesh has none.")
      .def(
          "jaw", [](const Face& face) { return matrix_of(face.jaw().data()); },
          "Pose of the mandible: 4 x 4, a rigid transform in metres, a copy.")
      .def(
          "compression",
          [](const py::object& self, std::uint32_t mesh) {
            return vectors_of(self, mesh, fascia_face_compression);
          },
          py::arg("mesh") = 0)
      .def(
          "save",
          [](Face& face) {
            const std::vector<std::uint8_t> state = face.save();
            return py::bytes(reinterpret_cast<const char*>(state.data()), state.size());
          },
          "All that the next steps depend on.")
      .def(
          "restore", [](Face& face, const py::bytes& state) { face.restore(bytes_of(state)); },
          py::arg("state"));
  return made;
}

}  // namespace

PYBIND11_MODULE(_runtime, module) {
  module.doc() = "Fascia's runtime: see the package fascia.";
  py::register_exception<fascia::api::Error>(module, "Error");
  module.def("version", [] {
    const std::uint32_t version = fascia_version();
    return std::to_string(version >> 16) + "." + std::to_string(version >> 8 & 255) + "." +
           std::to_string(version & 255);
  });
  auto asset = add_asset(module);
  add_curves(module);
  auto face = add_face(module);
  fascia::python::add_research(asset, face);
  fascia::python::add_fit(module);
}
