#pragma once

#include <string>
#include <vector>

#include "cli/take/performance.h"

namespace fascia::cli {

/// A mesh of the file with all its primitives that the face moves.
struct MeshOfFile {
  uint32_t mesh = 0;
  std::vector<size_t> parts;   ///< in Face::meshes
  std::vector<size_t> firsts;  ///< of each part: number of its first vertex
  size_t vertices = 0;
  double metres = 1.0;  ///< the most that a unit of its coordinates is, where its node shows it
};

/// `face` in mesh space and `in_metres`, the same face in metres.
std::vector<MeshOfFile> meshes_of_file(const Face& face, const Face& in_metres);

/// Displacement of every vertex of the mesh from rest, three numbers each.
void displacement(const Face& face, const MeshOfFile& mesh, std::vector<float>& to);

/// The motion of one mesh of the file, ready to be written.
struct MeshMotion {
  MeshOfFile mesh;
  std::vector<uint32_t> vertices;       ///< those that move, in the order of the shapes' rows
  std::vector<Eigen::VectorXf> shapes;  ///< of 3 #moving vertices each
  std::vector<size_t> keys;             ///< frames whose weights are written; between them they are linear
  Eigen::MatrixXf weights;              ///< #shapes x #keys
  double largest_error = 0.0;           ///< of what is written, at most, at any vertex of any frame, metres
  size_t largest_error_frame = 0;
  size_t wanted = 0;  ///< how many shapes would be within the tolerance; 0: not known
};

/// What a run through a take leaves.
struct Recording {
  std::vector<MeshMotion> meshes;  ///< those that move
  Eigen::MatrixXf values;          ///< #channels x #frames
  PerformanceFigures figures;
};

struct RecordingOptions {
  size_t most_targets = 1024;
  double tolerance = 0.0;  ///< metres: what the written motion may be off
};

/// Runs through the take on siblings of `face` and keeps of it what can be written.
///
/// It runs twice: the first time to find shapes that span the motion, the second time, which repeats the
/// first to the last bit, to fit their weights to the frames themselves and to measure what they leave, at
/// every vertex. Memory grows by the channels and the shapes' weights, not by vertices times frames. Errors
/// are sums of what shapes leave of a frame and what keys leave of their weights: no vertex is off farther.
Recording record(const Common& common, const Take& take, const Face& face, std::vector<MeshOfFile> meshes,
                 const RecordingOptions& options);

}  // namespace fascia::cli
