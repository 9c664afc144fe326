// Sequences of calls of the C interface on a small rig, with values of any kind. Positions stay finite.
#include <fascia/fascia.h>

#include <cmath>
#include <cstring>

#include "tests/rig/tiny_rig.h"

namespace {

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

fascia_asset* asset() {
  static fascia_asset* const loaded = [] {
    const std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
    fascia_asset* made = nullptr;
    if (fascia_asset_load(bytes.data(), bytes.size(), &made) != FASCIA_OK) __builtin_trap();
    return made;
  }();
  return loaded;
}

void expect_finite(fascia_face* face) {
  fascia_vectors positions = {};
  positions.struct_size = sizeof positions;
  if (fascia_face_positions(face, 0, &positions) != FASCIA_OK) __builtin_trap();
  for (uint32_t i = 0; i < 3 * positions.count; ++i)
    if (!std::isfinite(positions.data[i])) __builtin_trap();
}

void call(Input& input, fascia_face* face) {
  static const char* const names[] = {"zygomaticus_major_left", "jaw_open", "arkit:jawOpen", "nothing", ""};
  float values[16];
  switch (input.byte() % 14) {
    case 0:
      fascia_face_set(face, names[input.byte() % 5], input.value());
      break;
    case 1:
      fascia_face_step(face, input.value());
      break;
    case 2:
      fascia_face_pose(face);
      break;
    case 3:
      fascia_face_reset(face);
      break;
    case 4:
      fascia_face_clear(face);
      break;
    case 5:
      for (float& value : values)
        value = input.value();
      fascia_face_touch(face, input.index(), input.index(), values);
      break;
    case 6:
      fascia_face_clear_touches(face);
      break;
    case 7:
      for (float& value : values)
        value = input.value();
      fascia_face_move_head(face, values, input.value());
      break;
    case 8:
      for (float& value : values)
        value = input.value();
      fascia_face_set_acceleration(face, input.byte() % 4 ? values : nullptr);
      break;
    case 9: {
      fascia_vectors vectors = {};
      vectors.struct_size = input.byte() % 8 ? static_cast<uint32_t>(sizeof vectors) : input.byte();
      fascia_face_normals(face, input.index(), &vectors);
      fascia_face_compression(face, input.index(), &vectors);
      break;
    }
    case 10:
      fascia_face_values(face)[input.byte() % 3] = input.value();
      break;
    case 11:
      fascia_face_get(face, names[input.byte() % 5], values);
      break;
    case 12: {
      float room[30];
      fascia_face_write_positions(face, input.index(), room, 12, 10);
      break;
    }
    case 13:
      fascia_face_jaw(face, values);
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  Input input(bytes, size);
  fascia_face* faces[2] = {};
  for (fascia_face*& face : faces)
    if (fascia_face_create(asset(), nullptr, &face) != FASCIA_OK) __builtin_trap();
  for (int k = 0; k < 40 && !input.is_empty(); ++k) {
    call(input, faces[input.byte() % 2]);
    if (k % 8 == 7) fascia_faces_step(faces, 2, input.value(), nullptr);
  }
  for (fascia_face* face : faces) {
    expect_finite(face);
    fascia_face_release(face);
  }
  return 0;
}
