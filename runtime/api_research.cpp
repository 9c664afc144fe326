#include "fascia/research.h"

#include "runtime/api.h"
#include "runtime/gradient.h"

using namespace fascia::runtime;
namespace sim = fascia::sim;

namespace {

/// The simulation's own view of the face as it stands.
struct Standing {
  explicit Standing(Face& face) : frame(face.model().make_frame()), places(face.model().rest()) {
    sim::Controls controls = face.controls();
    controls.jaw = face.shown_jaw();
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i] += face.bones().displacements[i].cast<double>();
    face.model().place(controls, frame);
    face.model().find_facing(places.data(), frame);
  }
  sim::Frame frame;
  sim::Positions places;
};

template <class T>
const T* list(const auto& numbers) {
  return numbers.empty() ? nullptr : reinterpret_cast<const T*>(numbers.data());
}

}  // namespace

extern "C" {

fascia_result fascia_asset_lattice(const fascia_asset* handle, uint32_t index, fascia_lattice* lattice) {
  return guarded([&] {
    const auto& levels = checked(handle).rig().tissue.levels;
    check_index(index, levels.size(), "level");
    const auto& level = levels[index];
    hand_out(fascia_lattice{0, static_cast<uint32_t>(level.rest.size()), level.columns,
                            static_cast<uint32_t>(level.triangles.size()),
                            static_cast<uint32_t>(level.spring_nodes.size()), 0, list<float>(level.rest),
                            list<float>(level.masses), list<uint8_t>(level.kinds),
                            list<uint32_t>(level.triangles), list<uint32_t>(level.spring_nodes)},
             lattice);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_nodes(fascia_face* face, fascia_vectors* nodes) {
  return guarded([&] {
    hand_out_vectors(checked(face).nodes(), nodes);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_energies(fascia_face* handle, fascia_energies* energies) {
  return guarded([&] {
    Face& face = checked(handle);
    const Standing now(face);
    const sim::EnergyShares shares = face.model().energy_shares(now.frame, now.places.data());
    hand_out(fascia_energies{0, 0, shares.total, shares.springs, shares.membranes, shares.bending,
                             shares.volume, shares.tethers, shares.fibres, shares.others},
             energies);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_node_forces(fascia_face* handle, float* to, size_t capacity) {
  return guarded([&] {
    Face& face = checked(handle);
    require(to != nullptr, "the memory is null");
    require(capacity >= face.model().rest().size(), "the memory holds fewer nodes than the level has");
    const Standing now(face);
    sim::Positions gradient(now.places.size(), sim::Vec3::Zero());
    face.model().energy(now.frame, now.places.data(), gradient.data());
    for (std::size_t i = 0; i < gradient.size(); ++i)
      Eigen::Map<Vec3f>(to + 3 * i) = -gradient[i].cast<float>();
    return FASCIA_OK;
  });
}

fascia_result fascia_face_fibre_forces(fascia_face* handle, float* to, size_t capacity) {
  return guarded([&] {
    Face& face = checked(handle);
    const uint32_t fibres = face.model().lattice().fibre_count();
    require(to != nullptr, "the memory is null");
    require(capacity >= fibres, "the memory holds fewer fibres than the level has");
    const Standing now(face);
    for (uint32_t f = 0; f < fibres; ++f)
      to[f] = static_cast<float>(face.model().fibre_tension(now.frame, f, now.places.data()));
    return FASCIA_OK;
  });
}

fascia_result fascia_face_gradient(fascia_face* handle, const float* const* slopes, float* by_channel) {
  return guarded([&] {
    Face& face = checked(handle);
    require(slopes != nullptr && by_channel != nullptr, "the slopes or the result is null");
    find_gradient(face, {slopes, face.mesh_count()}, {by_channel, face.asset().channel_names.size()});
    return FASCIA_OK;
  });
}

fascia_result fascia_face_member_gradient(const fascia_face* handle, uint32_t set, const float* by_channel,
                                          float* by_member) {
  return guarded([&] {
    const Face& face = checked(handle);
    const Asset& asset = face.asset();
    check_index(set, asset.set_members.size(), "set");
    require(by_channel != nullptr && by_member != nullptr, "the derivatives or the result is null");
    const std::span<const float> slopes(by_channel, asset.channel_names.size());
    const uint32_t first = asset.first_member(set);
    for (uint32_t m = 0; m < asset.set_members[set].size(); ++m) {
      const float weight = face.mixer().get(0, {Target::Kind::member, first + m});
      by_member[m] = asset.members()[first + m].slope(weight, slopes);
    }
    return FASCIA_OK;
  });
}

}  // extern "C"
