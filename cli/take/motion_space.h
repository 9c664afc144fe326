#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace fascia::cli {

/// The motion of a mesh over a take of any length, kept as few directions and each frame's coefficients on
/// them.
///
/// Frames come one after the other and are not kept. Each is projected on the directions known so far; where
/// that leaves a vertex more than the tolerance off, what is left becomes a new direction (a greedy reduced
/// basis; Haasdonk 2013, Convergence rates of the POD-greedy method). Both are done at a sample of the
/// vertices only, on which the directions are orthonormal, and carried over to all: the skin follows a
/// lattice with far fewer degrees of freedom than the sample has (gappy POD; Everson & Sirovich 1995). A
/// motion of many directions is followed less closely the more it has, and of a long take every second frame
/// is kept, every fourth, and so on: the space is where shapes are looked for, not what is written.
class MotionSpace {
 public:
  struct Options {
    double tolerance = 0.0;            ///< at a sampled vertex, in the frames' unit
    size_t sampled_vertices = 2500;    ///< about, of those that move
    size_t fine_directions = 224;      ///< beyond, the tolerance grows and those of little weight go
    size_t most_directions = 448;      ///< beyond, the least are given up
    size_t most_bytes = 96 * 1000000;  ///< of directions, the same
    size_t most_frames = 8192;         ///< beyond, every second one's coefficients are given up
  };

  /// `vertices` of the mesh; frames have three numbers for each.
  MotionSpace(size_t vertices, const Options& options);

  /// Takes the next frame: displacements of all vertices from rest.
  void add(std::span<const float> displacement);

  /// Ends the take: every frame is in.
  void finish();

  /// What the frames were followed to: the options' tolerance, or more.
  double tolerance() const { return options_.tolerance; }
  /// The vertices that move at all, in the order of `directions`.
  const std::vector<uint32_t>& vertices() const { return moving_; }
  /// #directions x #frames that are kept.
  const Eigen::MatrixXf& coefficients() const { return coefficients_; }
  /// 3 #which x #directions: the directions at some of the vertices, given by their places in `vertices`.
  Eigen::MatrixXf directions_at(std::span<const Eigen::Index> which) const;
  /// 3 #vertices() x #columns: the directions mixed by `mix` (#directions x #columns).
  Eigen::MatrixXf mixed(const Eigen::MatrixXf& mix) const;

 private:
  void take_block();
  void find_moving();
  void loosen_tolerance();
  void extend(Eigen::Index column);
  void give_up(double budget, size_t least);
  void keep_fewer_frames();
  std::vector<const float*> columns(Eigen::Index row) const;
  Eigen::VectorXf whole(std::span<const float> frame) const;

  Options options_;
  size_t vertex_count_ = 0, stride_ = 0, kept_frames_ = 0;
  size_t every_ = 1;                       ///< one of so many frames is kept
  std::vector<uint8_t> moves_;             ///< by vertex
  std::vector<uint32_t> moving_;           ///< in the order they were seen to move
  std::vector<uint32_t> sampled_;          ///< vertices
  std::vector<std::vector<float>> block_;  ///< whole frames not yet taken in
  size_t waiting_ = 0;
  std::vector<Eigen::VectorXf> directions_;  ///< at moving vertices
  Eigen::MatrixXf sampled_directions_;
  std::vector<Eigen::MatrixXf> taken_;  ///< coefficients of each block; later directions are zero there
  Eigen::MatrixXf coefficients_;        ///< all of them, once the take has ended
  Eigen::MatrixXf sampled_frames_, sampled_left_;
};

}  // namespace fascia::cli
