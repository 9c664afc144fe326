#include "snapshot/packing.h"

#include <zlib.h>

#include <array>

#include "geometry/error.h"

namespace fascia::snapshot {

namespace {

constexpr char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string to_base64(const std::vector<uint8_t>& bytes) {
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? alphabet[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

[[noreturn]] void damaged() {
  throw Error("its packed numbers are damaged: record the snapshot anew");
}

std::vector<uint8_t> from_base64(std::string_view text) {
  static const std::array<int8_t, 256> values = [] {
    std::array<int8_t, 256> table;
    table.fill(-1);
    for (int8_t i = 0; i < 64; ++i)
      table[static_cast<uint8_t>(alphabet[i])] = i;
    return table;
  }();
  while (!text.empty() && text.back() == '=')
    text.remove_suffix(1);
  std::vector<uint8_t> bytes;
  uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const int8_t value = values[static_cast<uint8_t>(c)];
    if (value < 0) damaged();
    bits = bits << 6 | static_cast<uint32_t>(value);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes.push_back(static_cast<uint8_t>(bits >> held));
  }
  return bytes;
}

}  // namespace

std::string pack(const std::vector<int32_t>& numbers, size_t stride) {
  if (numbers.empty()) return "";
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i < numbers.size(); ++i) {
    const int64_t step = int64_t{numbers[i]} - (i >= stride ? numbers[i - stride] : 0);
    auto left = static_cast<uint64_t>(step << 1 ^ step >> 63);  // small for small steps of either sign
    for (; left > 127; left >>= 7)
      bytes.push_back(static_cast<uint8_t>(left | 128));
    bytes.push_back(static_cast<uint8_t>(left));
  }
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<uint8_t> deflated(size);
  if (compress2(deflated.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 9) != Z_OK)
    throw std::bad_alloc();
  deflated.resize(size);
  return to_base64(deflated);
}

std::vector<int32_t> unpack(std::string_view text, size_t stride, size_t count) {
  if (count == 0) return {};
  const std::vector<uint8_t> deflated = from_base64(text);
  std::vector<uint8_t> bytes(count * 5);  // the longest a number can be
  auto size = static_cast<uLongf>(bytes.size());
  if (uncompress(bytes.data(), &size, deflated.data(), static_cast<uLong>(deflated.size())) != Z_OK)
    damaged();
  std::vector<int32_t> numbers;
  numbers.reserve(count);
  size_t at = 0;
  while (numbers.size() < count) {
    uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      if (at >= size || shift > 28) damaged();
      value |= uint64_t{bytes[at] & 127U} << shift;
      if (bytes[at++] < 128) break;
    }
    const auto step = static_cast<int64_t>(value >> 1) ^ -static_cast<int64_t>(value & 1);
    const int64_t number = step + (numbers.size() >= stride ? numbers[numbers.size() - stride] : 0);
    if (number < INT32_MIN || number > INT32_MAX) damaged();
    numbers.push_back(static_cast<int32_t>(number));
  }
  if (at != size) damaged();
  return numbers;
}

}  // namespace fascia::snapshot
