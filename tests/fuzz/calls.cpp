// Sequences of calls of the C interface on a small rig, with values of any kind. Positions stay finite.
#include <fascia/fit.h>
#include <fascia/gpu.h>
#include <fascia/research.h>

#include <cmath>
#include <cstring>

#include "tests/fuzz/asset_calls.h"
#include "tests/fuzz/input.h"
#include "tests/rig/tiny_rig.h"

namespace {

using fascia::fuzz::Input;

fascia_asset* asset() {
  static fascia_asset* const loaded = [] {
    fascia::rig::Rig rig = fascia::test::tiny_rig();
    for (const char* name : {"jaw_forward", "jaw_lateral"})
      rig.actuation.channels.push_back({name, "jaw", -1.0F, 1.0F, 0.0F, -1, "1"});
    const std::vector<uint8_t> bytes = fascia::rig::write(fascia::test::tiny_head(), rig);
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

void call_layers(Input& input, fascia_face* face) {
  float values[16];
  for (float& value : values)
    value = input.value();
  switch (input.byte() % 8) {
    case 0: {
      const fascia_layer layer = {input.byte() % 16 ? static_cast<uint32_t>(sizeof layer) : input.byte(),
                                  static_cast<fascia_combine>(input.index()), input.value(), 0,
                                  input.byte() % 2 ? values : nullptr};
      fascia_face_set_layer(face, input.index(), &layer);
      break;
    }
    case 1:
      fascia_face_layer_set(face, input.index(), "zygomaticus_major_right", input.value());
      break;
    case 2:
      fascia_face_layer_clear(face, input.index());
      break;
    case 3:
      if (float* const own = fascia_face_layer_values(face, input.index())) own[input.byte() % 4] = values[0];
      break;
    case 4:
      fascia_face_layer_set_member(face, input.index(), input.index(), input.index(), input.value());
      break;
    case 5:
      fascia_face_layer_remove(face, input.index());
      break;
    case 6:
      fascia_face_look_at(face, input.byte() % 4 ? values : nullptr, input.value());
      break;
    default:
      fascia_face_blend(face, input.value(), input.value());
      break;
  }
}

/// A state put back, as it was or with a byte changed: it is refused then, or the face goes on with it.
void call_state(Input& input, fascia_face* face) {
  std::vector<uint8_t> state;
  size_t size = 0;
  fascia_face_save(face, nullptr, 0, &size);
  state.resize(size);
  if (fascia_face_save(face, state.data(), state.size() - input.byte() % 2, &size) != FASCIA_OK) return;
  fascia_face_step(face, 0.02F);
  if (input.byte() % 2) state[input.index() % state.size()] = input.byte();
  fascia_face_restore(face, state.data(), input.byte() % 8 ? state.size() : input.byte());
}

void call_outputs(Input& input, fascia_face* face) {
  static float room[4 * 3 * 289], slopes[3 * 289];
  for (int k = 0; k < 12; ++k)
    slopes[input.index() % std::size(slopes)] = input.value();
  const float* const slopes_by_mesh[] = {input.byte() % 4 ? slopes : nullptr};
  fascia_energies energies = {};
  energies.struct_size = sizeof energies;
  fascia_skinning skinning = {};
  skinning.struct_size = sizeof skinning;
  fascia_vectors vectors = {};
  vectors.struct_size = sizeof vectors;
  float scale = 0.0F;
  switch (input.byte() % 12) {
    case 0:
      fascia_face_write_deltas(face, input.index(), static_cast<fascia_delta_format>(input.index()), room,
                               input.byte() % 32, 289, &scale);
      break;
    case 1:
      fascia_face_skinning(face, input.index(), &skinning);
      break;
    case 2:
      fascia_face_write_node_texture(face, input.index(), room, 3 * 289 - input.byte() % 2);
      break;
    case 3:
      fascia_face_bone_matrices(face, input.index(), room);
      break;
    case 4:
      fascia_face_energies(face, &energies);
      break;
    case 5:
      fascia_face_node_forces(face, room, 3 * 289);
      fascia_face_fibre_forces(face, room, input.byte());
      break;
    case 6:
      fascia_face_gradient(face, slopes_by_mesh, room);
      fascia_face_member_gradient(face, input.index(), room, room + 100);
      break;
    case 7:
      fascia_face_tangents(face, input.index(), &vectors);
      fascia_face_fibre_points(face, &vectors);
      fascia_face_nodes(face, &vectors);
      break;
    case 9:
      fascia_face_write_normals(face, input.index(), room, input.byte() % 32, 289U + input.index());
      fascia_face_write_tangents(face, input.index(), room, input.byte() % 32, 289U - input.byte() % 2);
      break;
    case 10:
      if (const float* const values = fascia_face_effective_values(face); values && !std::isfinite(values[0]))
        __builtin_trap();
      if (fascia_face_level(face) < 0) __builtin_trap();
      break;
    case 8:
      fascia_face_set_member(face, input.index(), input.index(), input.value());
      break;
    default:
      fascia_face_set_level(face, static_cast<int32_t>(input.index()) - 1, input.value());
      break;
  }
}

/// A stream of six points, sound or not.
void call_fit(Input& input) {
  static const fascia_fit_place places[] = {
      {0, {40, 41, 58}, {1, 0, 0}},    {0, {60, 61, 78}, {0.5F, 0.5F, 0}}, {0, {144, 145, 162}, {0, 0, 1}},
      {0, {200, 201, 218}, {1, 0, 0}}, {0, {230, 231, 248}, {1, 0, 0}},    {0, {250, 251, 268}, {1, 0, 0}}};
  fascia_fit_landmarks landmarks = {sizeof landmarks, 6U - input.byte() % 2U, nullptr, nullptr, places};
  if (input.byte() % 8 == 0) landmarks.set = "ibug68";
  fascia_fit_options options = fascia_default_fit_options();
  if (input.byte() % 2) {
    options.iterations = static_cast<int32_t>(input.byte() % 8);
    options.finds_scale = input.byte() % 2;
    options.ridge = input.value();
    options.smoothness = input.value();
  }
  if (input.byte() % 4 == 0) options.focal[0] = options.focal[1] = 900.0F * input.value();
  fascia_fit* fit = nullptr;
  if (fascia_fit_create(asset(), &landmarks, &options, &fit) != FASCIA_OK) return;
  float points[18], weights[6];
  for (int frame = 0; frame < 3; ++frame) {
    for (int p = 0; p < 6; ++p) {
      const uint32_t v = places[p].vertices[0];
      points[3 * p] = 0.0075F * static_cast<float>(v % 17) + 0.01F * input.value();
      points[3 * p + 1] = 0.01F * static_cast<float>(v / 17) + 0.01F * input.value();
      points[3 * p + 2] = 0.01F * input.value();
      weights[p] = input.value();
    }
    fascia_fit_result result = {};
    result.struct_size = sizeof result;
    if (frame == 0 && input.byte() % 2) fascia_fit_set_neutral(fit, points, nullptr);
    if (fascia_fit_push(fit, points, input.byte() % 2 ? weights : nullptr, &result) == FASCIA_OK)
      for (int k = 0; k < 16; ++k)
        if (!std::isfinite(result.head[k])) __builtin_trap();
    if (input.byte() % 4 == 0) fascia_fit_reset(fit);
  }
  fascia_fit_release(fit);
}

void call(Input& input, fascia_face* face) {
  static const char* const names[] = {"zygomaticus_major_left", "jaw_open", "arkit:jawOpen", "nothing", ""};
  float values[16];
  switch (input.byte() % 20) {
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
    case 14:
      call_layers(input, face);
      break;
    case 15:
      call_state(input, face);
      break;
    case 16:
      call_outputs(input, face);
      break;
    case 17:
      if (input.byte() % 4 == 0) call_fit(input);
      break;
    case 18:
      fascia::fuzz::call_asset(input, asset());
      break;
    case 19:
      fascia::fuzz::call_curves(input, asset(), face);
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
