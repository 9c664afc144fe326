#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace fascia::app {

/// Undo and redo over whole states. A state is small (names and numbers), so that each step keeps a copy of
/// it: what is undone is then exactly what was, whichever part of the program changed it.
template <class State>
class History {
 public:
  explicit History(State first = {}, size_t limit = 300) : limit_(limit) { reset(std::move(first)); }

  const State& state() const { return steps_[present_].state; }

  /// Forgets all steps and begins with `first`.
  void reset(State first) {
    steps_.clear();
    steps_.push_back({std::move(first), "", ""});
    present_ = 0;
    is_sealed_ = true;
  }

  /// Makes `next` the present state; `label` says what was done, for the menu. A commit with the `gesture` of
  /// the one before it replaces that one's result, as long as the gesture is not sealed: a drag is one step.
  /// A state that changes nothing is no step. What had been undone is dropped.
  void commit(State next, std::string label, std::string gesture = {}) {
    if (next == state()) return;
    steps_.resize(present_ + 1);
    if (!gesture.empty() && !is_sealed_ && present_ > 0 && steps_[present_].gesture == gesture) {
      steps_[present_].state = std::move(next);
    } else {
      steps_.push_back({std::move(next), std::move(label), gesture});
      ++present_;
    }
    is_sealed_ = gesture.empty();
    if (steps_.size() > limit_) {
      steps_.erase(steps_.begin());
      --present_;
    }
  }

  /// Ends a gesture: the next commit is a step of its own.
  void seal() { is_sealed_ = true; }

  bool can_undo() const { return present_ > 0; }
  bool can_redo() const { return present_ + 1 < steps_.size(); }

  /// What undo() and redo() would take back or do again; empty when there is nothing.
  std::string undo_label() const { return can_undo() ? steps_[present_].label : ""; }
  std::string redo_label() const { return can_redo() ? steps_[present_ + 1].label : ""; }

  bool undo() {
    is_sealed_ = true;
    if (!can_undo()) return false;
    --present_;
    return true;
  }
  bool redo() {
    is_sealed_ = true;
    if (!can_redo()) return false;
    ++present_;
    return true;
  }

  size_t steps() const { return steps_.size() - 1; }

 private:
  struct Step {
    State state;
    std::string label, gesture;
  };
  std::vector<Step> steps_;
  size_t present_ = 0, limit_ = 300;
  bool is_sealed_ = true;
};

}  // namespace fascia::app
