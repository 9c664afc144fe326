#pragma once

#include <fascia/fascia.h>

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/engine/take.h"
#include "geometry/mesh.h"

namespace fascia::app {

/// One primitive that the rig moves.
struct FacePart {
  std::string name, part;            ///< of the mesh in the file; skin, eye_left, ...
  uint32_t mesh = 0, primitive = 0;  ///< where it is in the file
  uint32_t vertex_count = 0;
  std::vector<Triangle> triangles;
  std::vector<float> rest;  ///< vertex_count * 3, metres
};

struct FaceChannel {
  std::string name, group, unit;
  float minimum = 0.0F, maximum = 1.0F, rest = 0.0F;
};

/// A vocabulary: arkit, au, viseme, ...
struct FaceSet {
  std::string name;
  std::vector<std::string> members;
};

/// A triangle surface of the anatomy at rest.
struct FaceSurface {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

/// A rig, loaded through the runtime's C interface: what does not change while it is played. Shared by
/// threads.
class FaceAsset {
 public:
  /// Loads a rig from the bytes of a .glb file. Throws fascia::Error naming `name`.
  FaceAsset(const std::vector<uint8_t>& bytes, const std::string& name);

  fascia_asset* handle() const { return asset_.get(); }
  std::vector<FacePart> parts;  ///< in the runtime's order of meshes
  std::vector<FaceChannel> channels;
  std::vector<FaceSet> sets;
  std::vector<std::string> levels;  ///< coarse to fine
  FaceSurface cranium, mandible, teeth_upper, teeth_lower, smas;
  /// Fibres of the finest level: fibre f has the points offsets[f] .. offsets[f+1] of a frame's fibre points.
  std::vector<uint32_t> fibre_offsets;
  std::vector<std::string> fibre_muscles;  ///< one a fibre
  std::vector<uint32_t> fibre_channels;    ///< one a fibre
  size_t lattice_columns = 0;              ///< of the finest level
  std::vector<Triangle> lattice_prisms;
  Mat4 input_to_metres = Mat4::Identity();

  /// Index of a channel by name, or -1.
  int channel(const std::string& name) const;
  /// Least and most value of a channel or a set's member, and where it rests.
  FaceChannel range_of(const std::string& name) const;

 private:
  struct Release {
    void operator()(fascia_asset* asset) const { fascia_asset_release(asset); }
  };
  void read_parts(uint32_t count);
  std::unique_ptr<fascia_asset, Release> asset_;
};

/// A force on one vertex, newtons in the rig's axes.
struct Touch {
  uint32_t mesh = 0, vertex = 0;
  Eigen::Vector3f force = Eigen::Vector3f::Zero();

  bool operator==(const Touch&) const = default;
};

/// A recording with how much of it is added.
struct PlayedTake {
  std::shared_ptr<const Take> take;
  double weight = 1.0;

  bool operator==(const PlayedTake&) const = default;
};

/// What a face is asked to do in one step.
struct FaceInputs {
  std::map<std::string, double> pose;  ///< by name, as `--set` takes them
  std::map<std::string, double> live;  ///< captured now, by name; what the rig does not know is left out
  std::vector<PlayedTake> takes;       ///< added to the pose and to one another
  double take_time = 0.0;              ///< seconds in the takes
  std::vector<Touch> touches;          ///< at most 64
  Eigen::Vector3f acceleration = Eigen::Vector3f::Zero();  ///< that loose tissue feels, m/s^2
  Eigen::Matrix4f head = Eigen::Matrix4f::Identity();      ///< where the head stands in the world
  bool wants_nodes = false;        ///< whether frames say where the lattice's nodes are
  bool wants_compression = false;  ///< whether frames say how the skin is compressed
  uint32_t resets = 0;             ///< counts up: the face is put to rest when it changes

  bool operator==(const FaceInputs&) const = default;
};

/// How a face stands after a step. Arrays as the runtime lists them, metres.
struct FaceFrame {
  std::vector<std::vector<float>> positions, normals;  ///< one a part, 3 numbers a vertex
  std::vector<std::vector<float>> compression;         ///< see fascia_face_compression; empty unless wanted
  std::vector<float> fibre_points;
  std::vector<float> nodes;   ///< of the lattice; empty unless wanted
  std::vector<float> values;  ///< of the channels, as they were used
  Eigen::Matrix4f jaw = Eigen::Matrix4f::Identity();
  double step_milliseconds = 0.0;
  double largest_motion = 0.0;  ///< of any vertex since the frame before, metres
  uint64_t number = 0;          ///< counts up with each frame
  bool was_reset = false;       ///< the simulation had become unsound and was put back
};

/// One face of a rig with its solver. Used by one thread at a time.
class FaceSession {
 public:
  /// `solver` as fascia_solver. Throws fascia::Error when the face or its solver cannot be made.
  FaceSession(std::shared_ptr<const FaceAsset> asset, fascia_solver solver);

  /// Lets `seconds` pass under `inputs`; 0: the pose in which all forces balance.
  void advance(const FaceInputs& inputs, double seconds);
  const FaceFrame& frame() const { return frame_; }
  const FaceAsset& asset() const { return *asset_; }

 private:
  struct Release {
    void operator()(fascia_face* face) const { fascia_face_release(face); }
  };
  void apply(const FaceInputs& inputs);
  void read_frame(const FaceInputs& inputs);

  std::shared_ptr<const FaceAsset> asset_;
  std::unique_ptr<fascia_face, Release> face_;
  FaceFrame frame_;
  uint32_t resets_ = 0;
};

}  // namespace fascia::app
