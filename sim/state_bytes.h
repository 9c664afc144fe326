#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace fascia::sim {

/// Serialisation of a state: the same sequence of calls counts, writes or reads the bytes, so that one
/// function describes all three. Numbers are in native byte order.
class StateBytes {
 public:
  /// Counts only.
  StateBytes() = default;
  static StateBytes to(std::span<uint8_t> bytes) {
    return StateBytes(Mode::writes, bytes.data(), bytes.size());
  }
  static StateBytes from(std::span<const uint8_t> bytes) {
    return StateBytes(Mode::reads, const_cast<uint8_t*>(bytes.data()), bytes.size());
  }

  /// One value, a plain structure of numbers without padding.
  template <class T>
  void value(T& one) {
    list(&one, 1);
  }
  /// `count` of them.
  template <class T>
  void list(T* values, size_t count) {
    const size_t size = count * sizeof(T);
    if (mode_ != Mode::counts && size > room_ - used_) is_short_ = true;
    if (mode_ != Mode::counts && !is_short_ && size > 0) {
      if (mode_ == Mode::writes)
        std::memcpy(bytes_ + used_, static_cast<const void*>(values), size);
      else
        std::memcpy(static_cast<void*>(values), bytes_ + used_, size);
    }
    if (!is_short_) used_ += size;
  }

  bool reads() const { return mode_ == Mode::reads; }
  size_t used() const { return used_; }        ///< bytes counted, written or read
  bool is_short() const { return is_short_; }  ///< the buffer was too short

 private:
  enum class Mode : uint8_t { counts, writes, reads };
  StateBytes(Mode mode, uint8_t* bytes, size_t room) : mode_(mode), bytes_(bytes), room_(room) {}

  Mode mode_ = Mode::counts;
  uint8_t* bytes_ = nullptr;
  size_t room_ = 0, used_ = 0;
  bool is_short_ = false;
};

}  // namespace fascia::sim
