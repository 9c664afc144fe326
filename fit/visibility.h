#pragma once

#include <Eigen/Core>
#include <vector>

namespace fascia::fit {

/// How much of what each channel moves a frame of a take shows, of what the frames before it have shown. A
/// channel that nothing tells of any more is neither drawn to rest nor free to follow what is left: it stays.
class Visibility {
 public:
  /// Takes a frame's confidences by vertex. With `is_next` false the take begins here.
  void begin(const Eigen::VectorXd& confidence, bool is_next);
  /// Whether the frame shows all that was ever shown; shares are 1 then.
  bool is_whole() const { return is_whole_; }
  /// The largest confidence of each vertex so far.
  const Eigen::VectorXd& ever() const { return ever_; }
  /// Shares from the diagonals of the error's Hessian, one a channel: over the frame's confidences, and over
  /// `ever`.
  void find(const Eigen::VectorXd& shown, const Eigen::VectorXd& whole);

  /// 0 to 1: the share of channel `i`'s motion that is seen, by which its price counts.
  double share(Eigen::Index i) const { return shares_.size() > 0 ? shares_[i] : 1.0; }
  /// 0 where channel `i` is seen, up to 1000 where hardly anything is: how dear change is for that.
  double hold(Eigen::Index i) const;

 private:
  Eigen::VectorXd ever_, shares_;
  bool is_whole_ = true;
};

}  // namespace fascia::fit
