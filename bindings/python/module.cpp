// The Python module fascia._runtime: the classes of fascia.hpp, with arrays that are views of the runtime's
// memory.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "fascia/fascia.hpp"
#include "fit.h"

namespace py = pybind11;
using fascia::api::Asset;
using fascia::api::check;
using fascia::api::Curves;
using fascia::api::Face;
using fascia::api::sized;

namespace {

/// An array of `rows` x `columns` (or `rows`, when columns is 0) that is a view of memory which `owner`
/// keeps.
template <class T>
py::array_t<T> view(const T* data, py::ssize_t rows, py::ssize_t columns, const py::handle& owner,
                    bool is_writable = false) {
  std::vector<py::ssize_t> shape{rows};
  if (columns > 0) shape.push_back(columns);
  if (data == nullptr) return py::array_t<T>(shape);
  py::array_t<T> array(shape, data, owner);
  if (!is_writable) array.attr("flags").attr("writeable") = false;
  return array;
}

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

py::dict lattice_of(const py::object& self, std::uint32_t level) {
  auto lattice = sized<fascia_lattice>();
  check(fascia_asset_lattice(self.cast<const Asset&>().handle(), level, &lattice));
  py::dict result;
  result["rest"] = view(lattice.rest, lattice.node_count, 3, self);
  result["masses"] = view(lattice.masses, lattice.node_count, 0, self);
  result["kinds"] = view(lattice.kinds, lattice.node_count, 0, self);
  result["triangles"] = view(lattice.triangles, lattice.triangle_count, 3, self);
  result["springs"] = view(lattice.springs, lattice.spring_count, 2, self);
  return result;
}

py::dict fibres_of(const py::object& self, std::uint32_t level) {
  auto fibres = sized<fascia_fibres>();
  check(fascia_asset_fibres(self.cast<const Asset&>().handle(), level, &fibres));
  py::dict result;
  py::list muscles;
  for (std::uint32_t f = 0; f < fibres.fibre_count; ++f)
    muscles.append(fibres.muscles[f]);
  result["muscles"] = muscles;
  result["offsets"] = view(fibres.offsets, fibres.fibre_count + 1, 0, self);
  result["channels"] = view(fibres.channels, fibres.fibre_count, 0, self);
  result["points"] = view(fibres.points, fibres.point_count, 3, self);
  return result;
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

py::array_t<float> nodes_of(const py::object& self) {
  auto vectors = sized<fascia_vectors>();
  check(fascia_face_nodes(self.cast<Face&>().handle(), &vectors));
  return py::array_t<float>({static_cast<py::ssize_t>(vectors.count), py::ssize_t{3}}, vectors.data);
}

py::dict energies_of(const Face& face) {
  auto energies = sized<fascia_energies>();
  check(fascia_face_energies(face.handle(), &energies));
  py::dict result;
  result["total"] = energies.total;
  result["springs"] = energies.springs;
  result["membranes"] = energies.membranes;
  result["bending"] = energies.bending;
  result["volume"] = energies.volume;
  result["tethers"] = energies.tethers;
  result["fibres"] = energies.fibres;
  result["others"] = energies.others;
  return result;
}

py::array_t<float> fibre_forces_of(const Face& face) {
  auto fibres = sized<fascia_fibres>();
  check(fascia_asset_fibres(face.asset().handle(), static_cast<std::uint32_t>(face.level()), &fibres));
  py::array_t<float> forces(static_cast<py::ssize_t>(fibres.fibre_count));
  check(fascia_face_fibre_forces(face.handle(), forces.mutable_data(), fibres.fibre_count));
  return forces;
}

py::array_t<float> gradient_of(
    Face& face,
    const std::map<std::uint32_t, py::array_t<float, py::array::c_style | py::array::forcecast>>& slopes) {
  const std::uint32_t meshes = face.asset().info().mesh_count;
  std::vector<const float*> lists(meshes, nullptr);
  for (const auto& [mesh, list] : slopes) {
    if (mesh >= meshes) throw py::index_error("there is no mesh " + std::to_string(mesh));
    if (list.ndim() != 2 || list.shape(1) != 3 ||
        list.shape(0) != static_cast<py::ssize_t>(face.asset().mesh(mesh).vertex_count))
      throw py::value_error("the slopes of a mesh must be an array of vertex_count x 3");
    lists[mesh] = list.data();
  }
  py::array_t<float> gradient(static_cast<py::ssize_t>(face.values().size()));
  float* const to = gradient.mutable_data();
  {
    py::gil_scoped_release released;
    check(fascia_face_gradient(face.handle(), lists.data(), to));
  }
  return gradient;
}

void add_asset(py::module_& module) {
  py::class_<Asset>(module, "Asset", "A loaded rig: immutable, for any thread.")
      .def_static(
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
          "input_to_metres",
          [](const Asset& asset) {
            const fascia_asset_info info = asset.info();
            py::array_t<float> matrix({4, 4});
            for (py::ssize_t row = 0; row < 4; ++row)
              for (py::ssize_t column = 0; column < 4; ++column)
                matrix.mutable_at(row, column) = info.input_to_metres[4 * column + row];
            return matrix;
          },
          "4 x 4: from the file's axes and units to metres.")
      .def("lattice", lattice_of, py::arg("level"), "The tissue's nodes and elements of a level at rest.")
      .def("fibres", fibres_of, py::arg("level"),
           "The muscles' fibres of a level as polylines at rest, metres.");
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

void add_face(py::module_& module) {
  py::class_<Face>(module, "Face", "One head. For one thread at a time.")
      .def(py::init(&make_face), py::arg("asset"), py::arg("level") = -1, py::arg("space") = "input",
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
      .def("get", &Face::get, py::arg("name"))
      .def("clear", &Face::clear)
      .def("apply", &Face::apply, py::arg("curves"), py::arg("seconds"), py::arg("weight") = 1.0F,
           py::arg("layer") = 0)
      .def("pose", &Face::pose, py::call_guard<py::gil_scoped_release>(),
           "Goes to the pose in which all forces balance.")
      .def("step", &Face::step, py::arg("seconds"), py::call_guard<py::gil_scoped_release>(),
           "Lets time pass; False when the simulation had to be put back to rest.")
      .def("reset", &Face::reset)
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
          "compression",
          [](const py::object& self, std::uint32_t mesh) {
            return vectors_of(self, mesh, fascia_face_compression);
          },
          py::arg("mesh") = 0)
      .def("nodes", nodes_of, "Places of the level's nodes, metres: a copy.")
      .def("energies", energies_of, "Potential energy by what holds it, joules.")
      .def("fibre_forces", fibre_forces_of, "Tension of each fibre, newtons.")
      .def("gradient", gradient_of, py::arg("slopes"),
           "A loss's derivative by every channel at a static pose, from its derivatives by positions: {mesh: "
           "array of vertex_count x 3}.")
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
  add_asset(module);
  add_curves(module);
  add_face(module);
  fascia::python::add_fit(module);
}
