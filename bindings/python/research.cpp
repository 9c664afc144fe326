#include "research.h"

#include <pybind11/stl.h>

#include <map>
#include <span>
#include <string>
#include <vector>

#include "views.h"

namespace py = pybind11;
using fascia::api::Asset;
using fascia::api::check;
using fascia::api::Face;
using fascia::api::sized;

namespace fascia::python {
namespace {

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

py::array_t<float> nodes_of(const py::object& self) {
  auto vectors = sized<fascia_vectors>();
  check(fascia_face_nodes(self.cast<Face&>().handle(), &vectors));
  return py::array_t<float>({static_cast<py::ssize_t>(vectors.count), py::ssize_t{3}}, vectors.data);
}

py::dict energies_of(Face& face) {
  const fascia_energies energies = face.energies();
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

py::array_t<float> node_forces_of(Face& face) {
  const auto forces = face.node_forces();
  return py::array_t<float>({static_cast<py::ssize_t>(forces.size()), py::ssize_t{3}},
                            forces.empty() ? nullptr : forces.front().data());
}

py::array_t<float> array_of(const std::vector<float>& numbers) {
  return py::array_t<float>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

py::array_t<float> gradient_of(Face& face, const std::map<std::uint32_t, Floats>& slopes) {
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

py::array_t<float> member_gradient_of(const Face& face, const std::string& set, const Floats& by_channel) {
  if (by_channel.ndim() != 1) throw py::value_error("the derivatives by the channels must be one list");
  const std::span<const float> given(by_channel.data(), static_cast<std::size_t>(by_channel.size()));
  for (std::uint32_t i = 0; i < face.asset().info().set_count; ++i)
    if (face.asset().set(i).name == set) return array_of(face.member_gradient(i, given));
  throw py::key_error("the rig has no set " + set);
}

}  // namespace

void add_research(py::class_<Asset>& asset_class, py::class_<Face>& face_class) {
  asset_class
      .def("lattice", lattice_of, py::arg("level"), "The tissue's nodes and elements of a level at rest.")
      .def("fibres", fibres_of, py::arg("level"),
           "The muscles' fibres of a level as polylines at rest, metres.");
  face_class.def("nodes", nodes_of, "Places of the level's nodes, metres: a copy.")
      .def("energies", energies_of, "Potential energy by what holds it, joules.")
      .def("node_forces", node_forces_of, "The sum of all forces on each node, newtons: n x 3, a copy.")
      .def(
          "fibre_forces", [](Face& face) { return array_of(face.fibre_forces()); },
          "Tension of each fibre, newtons.")
      .def("gradient", gradient_of, py::arg("slopes"),
           "A loss's derivative by every channel at a static pose, from its derivatives by positions: {mesh: "
           "array of vertex_count x 3}.")
      .def("member_gradient", member_gradient_of, py::arg("set"), py::arg("by_channel"),
           "What gradient returned as derivatives by the members of a set, in the order of Asset.sets[set].");
}

}  // namespace fascia::python
