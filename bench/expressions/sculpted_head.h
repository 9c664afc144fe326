#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "fit/subject.h"

namespace fascia::bench {

/// A head whose own ARKit shapes are known, sculpted or measured.
struct SculptedHead {
  std::string name, family;  ///< family: who made the shapes; heads of one family are not independent
  std::filesystem::path head, shapes;  ///< the file a user would build from; the file with the morph targets
  std::filesystem::path anatomy;       ///< folder of corrected anatomy to build with, or empty
};

/// All of them that lie in the measured data: ICT-FaceKit's people and avatars of other makers. Empty when
/// the data are not there.
std::vector<SculptedHead> sculpted_heads();

/// The generic head as a file of its own, named "embedded"; it has no shapes.
SculptedHead generic_head();

/// The rig of `head` at `detail`, built by the tool with landmarks found, as a user would; a rig is kept in
/// the temporary folder and built anew when the head's file or the tool has changed. Throws fascia::Error
/// with the tool's message when it is refused.
std::filesystem::path rig_of(const SculptedHead& head, const std::string& detail);

/// A shape to be explained.
struct KnownShape {
  std::map<std::string, double> values;  ///< expression -> weight that plays it
  Eigen::VectorXd truth;                 ///< 3 x #face vertices, metres
};

/// A head with its rig and what its face should do. Not for two threads at once.
class KnownFace {
 public:
  KnownFace(const SculptedHead& head, const std::string& detail);

  const SculptedHead& head() const { return head_; }
  fit::Subject& subject() { return *subject_; }
  const fit::Subject& subject() const { return *subject_; }
  /// The face's vertices among the subject's: of the skin with the shapes, without the linings of mouth and
  /// sockets where the model tells them apart.
  const std::vector<size_t>& face() const { return face_; }
  /// Triangles of the skin, by place in face().
  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// By ARKit name. mouthClose corrects an open jaw and is played and known with jawOpen.
  const std::map<std::string, KnownShape>& shapes() const { return shapes_; }

  /// Channel values that play expressions of `table`, each by its response (eyes by the value itself), held
  /// to their channels' ranges.
  std::vector<float> activations(const anatomy::ExpressionSet& table,
                                 const std::map<std::string, double>& values) const;
  /// 3 x #face vertices, metres: the static pose of `activations`, from rest.
  Eigen::VectorXd pose(const std::vector<float>& activations);
  /// The face's rows of something over all the subject's vertices.
  Eigen::VectorXd face_rows(const Eigen::VectorXd& all) const;

 private:
  void read_shapes();

  SculptedHead head_;
  std::unique_ptr<fit::Subject> subject_;
  std::vector<size_t> face_;
  std::vector<Triangle> triangles_;
  std::map<std::string, KnownShape> shapes_;
};

}  // namespace fascia::bench
