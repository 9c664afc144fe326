#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace fascia::fuzz {

/// Takes numbers off the input; zeros when it is used up.
class Input {
 public:
  Input(const uint8_t* bytes, size_t size) : bytes_(bytes), left_(size) {}
  bool is_empty() const { return left_ == 0; }
  uint8_t byte() { return number<uint8_t>(); }
  /// Often a usual value, at times any bits at all.
  float value() {
    const uint8_t kind = byte();
    return kind < 200 ? static_cast<float>(kind) / 100.0F - 0.5F : number<float>();
  }
  uint32_t index() {
    const uint8_t kind = byte();
    return kind < 250 ? kind % 4 : number<uint32_t>();
  }

 private:
  template <class T>
  T number() {
    T value = {};
    const size_t size = left_ < sizeof(T) ? left_ : sizeof(T);
    std::memcpy(&value, bytes_, size);
    bytes_ += size;
    left_ -= size;
    return value;
  }
  const uint8_t* bytes_;
  size_t left_;
};

}  // namespace fascia::fuzz
