#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

/// Recorded displacements of a face's skin, for regression tests.
namespace fascia::snapshot {

/// A mesh of the rig's file that has watched vertices.
struct Mesh {
  uint32_t mesh = 0, primitive = 0;  ///< indices in the file
  uint32_t vertex_count = 0;         ///< to detect a different mesh
};

/// A watched vertex.
struct Vertex {
  uint32_t mesh = 0;    ///< in Snapshot::meshes
  uint32_t vertex = 0;  ///< of that mesh

  auto operator<=>(const Vertex&) const = default;
};

/// A group of watched vertices, of one mesh or several.
struct Region {
  std::string name;
  std::vector<Vertex> vertices;  ///< ascending
  double tolerance_mm = 0.0;     ///< allowed root mean square difference
};

/// Values of channels or members of vocabularies by name: a static pose.
using Values = std::vector<std::pair<std::string, double>>;

struct Pose {
  std::string name;
  Values values;
};

/// A curves file that is simulated, and the frames that are recorded.
struct Take {
  std::string name;                 ///< the file's own name
  std::string path;                 ///< from the snapshot's folder
  std::string hash;                 ///< formats::content_hash of the file
  double frames_per_second = 60.0;  ///< of the simulation
  std::vector<uint32_t> frames;     ///< kept, ascending
};

/// The watched vertices in one pose or frame, in quanta: of the state at rest positions in the rig's metres,
/// of others displacements from rest. x, y, z of each vertex, regions one after the other.
struct State {
  std::string name;
  std::vector<int32_t> quanta;
};

struct Snapshot {
  std::string rig;    ///< formats::content_hash of the rig's file
  std::string level;  ///< low, medium or high
  double quantum_mm = 0.01;
  std::vector<std::string> reasons;  ///< why it was recorded and updated
  std::vector<Mesh> meshes;
  std::vector<Region> regions;
  std::vector<Pose> poses;
  std::vector<Take> takes;
  std::vector<State> states;  ///< rest, the poses in order, the takes' frames in order

  /// Number of watched vertices of all regions.
  size_t vertex_count() const;
  /// First watched vertex of a region among all.
  size_t first_vertex(size_t region) const;
};

/// Throws fascia::Error unless a snapshot may hold so many watched vertices, up to a million, in so many
/// states, up to twenty million places in all.
void check_size(size_t vertices, size_t states);

/// Names of the states that `poses` and `takes` give, in order; the first is "rest".
std::vector<std::string> state_names(const Snapshot& snapshot);

}  // namespace fascia::snapshot
