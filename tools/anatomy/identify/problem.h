#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/expressions/sculpted_head.h"
#include "sim/sensitivity.h"

namespace fascia::identify {

/// Channel -> value.
using Weights = std::map<std::string, double>;

/// `weights` of the other side: `_left` and `_right` swapped, what goes sideways turned round.
Weights mirrored(const Weights& weights);

/// One number that a row of the table may choose, from 0 to 1: what channels it moves and how far at 1.
struct Parameter {
  std::string word;  ///< as the figures name it
  Weights limits;
};

/// What may make a shape, as figures/expression_actuators.json says.
struct ShapeEntry {
  std::string shape;       ///< ARKit's name without its side where it has two
  bool is_paired = false;  ///< each side of the face has its own
  std::string corrects;    ///< the shape it is added to
  std::vector<std::string> actuators;
  Weights given, bones;

  /// The row fitted; its mirror image serves the other.
  std::string name() const { return is_paired ? shape + "Left" : shape; }
  /// Name of the mirrored row, or empty when the shape is symmetric.
  std::string mirror() const;
};

std::vector<ShapeEntry> read_entries(const std::string& path);

/// The parameters of `entry` on rigs with `channels`. Throws fascia::Error when an actuator is not among
/// them.
std::vector<Parameter> parameters(const ShapeEntry& entry, const std::vector<rig::Channel>& channels,
                                  double reach);

/// A head to fit on, with what linearises it. Not for two threads at once.
struct FittedHead {
  std::unique_ptr<bench::KnownFace> face;
  std::unique_ptr<sim::Sensitivity> sensitivity;
  double weight = 1.0;  ///< of the head in a sum

  FittedHead(const bench::SculptedHead& head, const std::string& detail);
  std::vector<float> values(const Weights& weights) const;
  /// Displacements of the face, 3 x #vertices: the static pose, from rest.
  Eigen::VectorXd pose(const Weights& weights) { return face->pose(values(weights)); }
  /// Their derivatives by `parameters` at the pose just made by `weights`.
  Eigen::MatrixXd slopes(const Weights& weights, const std::vector<Parameter>& parameters);
};

}  // namespace fascia::identify
