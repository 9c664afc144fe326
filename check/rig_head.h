#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "check/head.h"

namespace fascia::check {

/// A rig as a head with its own simulation to play poses, through the runtime's C interface.
class RigHead {
 public:
  /// From the bytes of a rig file. `level`: low, medium, high; empty: the finest. Throws fascia::Error,
  /// beginning with `name`, when the rig is not sound.
  RigHead(std::span<const uint8_t> bytes, const std::string& name, const std::string& level = "");
  ~RigHead();
  RigHead(const RigHead&) = delete;
  RigHead& operator=(const RigHead&) = delete;

  const Head& head() const;

  /// Poses the face statically with the rig's set `arkit`. The player must not outlive this; it may be called
  /// from several threads at once.
  Player player();

  /// Largest distance, metres, between the file's own vertex positions and those of the posed face with every
  /// channel at rest, in the file's coordinates: 0 when rest is exact to the last bit.
  double rest_motion() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fascia::check
