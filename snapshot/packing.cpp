#include "snapshot/packing.h"

#include <zlib.h>

#include <algorithm>

#include "geometry/base64.h"
#include "geometry/error.h"

namespace fascia::snapshot {

namespace {

[[noreturn]] void damaged() {
  throw Error("its packed numbers are damaged: record the snapshot anew");
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
  size_t skipped = 0;
  const std::vector<uint8_t> deflated = from_base64(text, &skipped);
  if (skipped > 0) damaged();
  // A number is a byte at least; deflate makes of a byte 1032 at most.
  constexpr size_t longest_number = 5, most_inflated = 1032;
  const size_t most = most_inflated * deflated.size();
  if (count > most) damaged();
  std::vector<uint8_t> bytes(std::min(longest_number * count, most));
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
