#include "bench/people/npz.h"

#include <zlib.h>

#include <cstring>

#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::bench {

namespace {

uint32_t little(const std::vector<uint8_t>& bytes, size_t at, size_t count) {
  uint32_t value = 0;
  for (size_t i = 0; i < count; ++i)
    value |= static_cast<uint32_t>(bytes.at(at + i)) << (8 * i);
  return value;
}

/// The member `name` of a ZIP archive: its central directory says where. PKWARE's APPNOTE, 4.3.
std::vector<uint8_t> zip_member(const std::vector<uint8_t>& zip, const std::string& name) {
  const size_t end_size = 22;
  size_t end = zip.size() >= end_size ? zip.size() - end_size : 0;
  while (end > 0 && little(zip, end, 4) != 0x06054b50)
    --end;
  size_t entry = little(zip, end + 16, 4);
  for (uint32_t count = little(zip, end + 10, 2); count > 0; --count) {
    const uint32_t method = little(zip, entry + 10, 2), packed = little(zip, entry + 20, 4),
                   size = little(zip, entry + 24, 4), name_size = little(zip, entry + 28, 2),
                   local = little(zip, entry + 42, 4);
    const std::string here(zip.begin() + static_cast<std::ptrdiff_t>(entry + 46),
                           zip.begin() + static_cast<std::ptrdiff_t>(entry + 46 + name_size));
    entry += 46 + name_size + little(zip, entry + 30, 2) + little(zip, entry + 32, 2);
    if (here != name) continue;
    const size_t data = local + 30 + little(zip, local + 26, 2) + little(zip, local + 28, 2);
    if (data + packed > zip.size()) throw Error("the archive is cut off");
    std::vector<uint8_t> out(size);
    if (method == 0) {
      std::memcpy(out.data(), zip.data() + data, size);
      return out;
    }
    z_stream stream{};
    stream.next_in = const_cast<Bytef*>(zip.data() + data);
    stream.avail_in = packed;
    stream.next_out = out.data();
    stream.avail_out = size;
    const bool is_whole =
        inflateInit2(&stream, -MAX_WBITS) == Z_OK && inflate(&stream, Z_FINISH) == Z_STREAM_END;
    inflateEnd(&stream);
    if (!is_whole) throw Error("member '" + name + "' does not unpack");
    return out;
  }
  throw Error("it has no member '" + name + "'");
}

/// What stands behind `key` in the dictionary of a .npy header.
std::string header_value(const std::string& header, const std::string& key, char open, char close) {
  const size_t at = header.find("'" + key + "'");
  const size_t begin = header.find(open, header.find(':', at)) + 1;
  return header.substr(begin, header.find(close, begin) - begin);
}

template <class Number>
std::vector<double> as_doubles(const std::vector<uint8_t>& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(Number));
  for (size_t i = 0; i < numbers.size(); ++i) {
    Number number;
    std::memcpy(&number, bytes.data() + i * sizeof(Number), sizeof(Number));
    numbers[i] = static_cast<double>(number);
  }
  return numbers;
}

}  // namespace

std::vector<double> NumpyArray::numbers() const {
  if (type == "<f4") return as_doubles<float>(bytes);
  if (type == "<i2") return as_doubles<int16_t>(bytes);
  if (type == "<i4") return as_doubles<int32_t>(bytes);
  throw Error("NumPy arrays of type '" + type + "' are not read");
}

NumpyArray read_npz(const std::filesystem::path& path, const std::string& name) {
  try {
    const std::vector<uint8_t> file = zip_member(formats::read_bytes(path), name + ".npy");
    const size_t header_size = little(file, 8, 2);
    const std::string header(file.begin() + 10, file.begin() + 10 + static_cast<std::ptrdiff_t>(header_size));
    NumpyArray array;
    array.type = header_value(header, "descr", '\'', '\'');
    std::string shape = header_value(header, "shape", '(', ')');
    for (size_t at = 0; at < shape.size();) {
      const size_t comma = std::min(shape.find(',', at), shape.size());
      if (shape.find_first_of("0123456789", at) < comma) array.shape.push_back(std::stoul(shape.substr(at)));
      at = comma + 1;
    }
    array.bytes.assign(file.begin() + 10 + static_cast<std::ptrdiff_t>(header_size), file.end());
    return array;
  } catch (const std::exception& error) {
    throw Error("'" + path.string() + "', array '" + name + "': " + error.what());
  }
}

}  // namespace fascia::bench
