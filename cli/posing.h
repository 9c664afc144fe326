#pragma once

#include <fascia/fascia.h>

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/common.h"
#include "geometry/mesh.h"
#include "view/face/lattice_layers.h"

namespace fascia::cli {

/// One primitive of the rig's file, as the runtime lists it.
struct FaceMesh {
  uint32_t mesh = 0, primitive = 0, vertex_count = 0;
  std::string name, part;
  std::vector<Triangle> triangles;
};

/// A rig loaded through the runtime's own C interface, and one face of it. What fails throws fascia::Error.
class Face {
 public:
  struct Options {
    fascia_space space = FASCIA_SPACE_METRES;
    std::string solver = "own";  ///< own, reference or bullet
    std::string level;           ///< low, medium, high; empty: the finest
  };

  Face(const std::filesystem::path& rig, const Options& options);

  /// Another face of the same rig and options, at rest.
  Face sibling() const;

  const std::vector<FaceMesh>& meshes() const { return meshes_; }
  std::vector<std::string> set_names() const;
  std::vector<std::string> set_members(const std::string& set) const;
  std::vector<std::string> channel_names() const;

  /// " (did you mean ...?)" with the channels and members of sets that look most like `name`, or nothing.
  std::string suggestion(const std::string& name) const;

  /// Sets a channel or a set's member; throws when there is none of that name.
  void set(const std::string& name, double value);
  /// The values that a channel takes, or a member of a set; beyond, they are cut off.
  struct Range {
    double least = 0.0, most = 1.0;
  };
  Range range(const std::string& name) const;
  void clear();
  void pose();
  /// Lets time pass; returns false when the simulation had to be reset.
  bool step(double seconds);
  void reset();

  std::span<const float> positions(size_t mesh) const;
  std::span<const float> normals(size_t mesh) const;
  /// Positions at rest, in the same space.
  std::span<const float> rest(size_t mesh) const { return rest_[mesh]; }
  /// What `make` makes of this face at the first call, kept as long as the face lives: one thing of one type.
  template <class T, class Make>
  const T& kept(Make make) const {
    if (!kept_) kept_ = std::make_shared<T>(make());
    return *static_cast<const T*>(kept_.get());
  }
  /// The rig's file, as it is on disk.
  std::span<const uint8_t> file() const { return *bytes_; }
  const std::string& path() const { return path_; }
  /// Channels as they act now, by name.
  std::map<std::string, double> effective_values() const;
  /// Fibres as they stand, grouped by muscle, in metres.
  std::vector<std::pair<std::string, std::vector<std::vector<Vec3>>>> fibres() const;
  Mat4 jaw() const;
  /// The nodes of the face's level as they stand, in metres, and what connects them.
  view::Lattice lattice() const;

  fascia_face* handle() const { return face_.get(); }
  fascia_asset* asset() const { return asset_.get(); }

 private:
  struct Release {
    void operator()(fascia_asset* asset) const { fascia_asset_release(asset); }
    void operator()(fascia_face* face) const { fascia_face_release(face); }
  };
  Face() = default;
  void create(const std::string& rig);

  Options options_;
  std::shared_ptr<fascia_asset> asset_;
  std::unique_ptr<fascia_face, Release> face_;
  std::vector<FaceMesh> meshes_;
  std::vector<std::vector<float>> rest_;
  std::shared_ptr<const std::vector<uint8_t>> bytes_;
  std::string path_;
  mutable std::shared_ptr<const void> kept_;
  int32_t level_ = -1;
};

/// `NAME=VALUE` words and an activations file, in that order of strength: words win.
std::vector<std::pair<std::string, double>> activations(const std::vector<std::string>& words,
                                                        const std::filesystem::path& file);

/// Sets all of `values` on the face, and warns of those that lie beyond their range and are cut off.
void set_all(const Common& common, Face& face, const std::vector<std::pair<std::string, double>>& values);

/// Throws fascia::Error with the runtime's last message when `result` is a failure.
void check(fascia_result result, const std::string& what);

}  // namespace fascia::cli
