/* What index.mjs asks of the C interface's structures, member by member, so that no layout is written down in
 * JavaScript. */
#include "fascia/api.h"

#define EXPORT __attribute__((visibility("default")))
#define NUMBER(pointer) ((uint32_t)(uintptr_t)(pointer))

EXPORT uint32_t web_asset_load(const void* bytes, uint32_t size) {
  fascia_asset* asset = 0;
  return fascia_asset_load(bytes, size, &asset) == FASCIA_OK ? NUMBER(asset) : 0;
}

EXPORT uint32_t web_asset_info(const fascia_asset* asset, uint32_t member) {
  static fascia_asset_info info;
  info.struct_size = sizeof info;
  if (fascia_asset_get_info(asset, &info) != FASCIA_OK) return 0;
  const uint32_t members[] = {info.level_count, info.mesh_count, info.channel_count, info.set_count,
                              NUMBER(info.input_to_metres)};
  return members[member];
}

EXPORT uint32_t web_asset_level(const fascia_asset* asset, uint32_t level, uint32_t member) {
  fascia_level_info info = {.struct_size = sizeof info};
  if (fascia_asset_get_level(asset, level, &info) != FASCIA_OK) return 0;
  const uint32_t members[] = {NUMBER(info.name), info.node_count};
  return members[member];
}

EXPORT uint32_t web_asset_mesh(const fascia_asset* asset, uint32_t mesh, uint32_t member) {
  fascia_mesh_info info = {.struct_size = sizeof info};
  if (fascia_asset_get_mesh(asset, mesh, &info) != FASCIA_OK) return 0;
  const uint32_t members[] = {
      info.mesh,         info.primitive,    info.vertex_count,     info.triangle_count,
      NUMBER(info.name), NUMBER(info.part), NUMBER(info.triangles)};
  return members[member];
}

EXPORT uint32_t web_asset_channels(const fascia_asset* asset, uint32_t member) {
  fascia_channels channels = {.struct_size = sizeof channels};
  if (fascia_asset_get_channels(asset, &channels) != FASCIA_OK) return 0;
  const uint32_t members[] = {channels.count,         NUMBER(channels.names),   NUMBER(channels.groups),
                              NUMBER(channels.units), NUMBER(channels.minimum), NUMBER(channels.maximum),
                              NUMBER(channels.rest)};
  return members[member];
}

EXPORT uint32_t web_asset_set(const fascia_asset* asset, uint32_t set, uint32_t member) {
  fascia_set_info info = {.struct_size = sizeof info};
  if (fascia_asset_get_set(asset, set, &info) != FASCIA_OK) return 0;
  const uint32_t members[] = {NUMBER(info.name), info.member_count, NUMBER(info.members)};
  return members[member];
}

EXPORT uint32_t web_face_create(fascia_asset* asset, uint32_t space, int32_t level, int32_t iterations) {
  fascia_face_options options = fascia_default_face_options();
  fascia_face* face = 0;
  options.space = (fascia_space)space;
  options.level = level;
  options.iterations = iterations;
  return fascia_face_create(asset, &options, &face) == FASCIA_OK ? NUMBER(face) : 0;
}

/* Positions (0), normals (1), compression (2) or tangents (3) of a mesh: where they are, 0 on a failure. */
EXPORT uint32_t web_face_vectors(fascia_face* face, uint32_t mesh, uint32_t kind) {
  fascia_vectors vectors = {.struct_size = sizeof vectors};
  fascia_result result = FASCIA_ERROR_ARGUMENT;
  if (kind == 0) result = fascia_face_positions(face, mesh, &vectors);
  if (kind == 1) result = fascia_face_normals(face, mesh, &vectors);
  if (kind == 2) result = fascia_face_compression(face, mesh, &vectors);
  if (kind == 3) result = fascia_face_tangents(face, mesh, &vectors);
  return result == FASCIA_OK ? NUMBER(vectors.data) : 0;
}

/* How many tangents a mesh has: one for each vertex or 0; -1 on a failure. */
EXPORT int32_t web_face_tangent_count(fascia_face* face, uint32_t mesh) {
  fascia_vectors vectors = {.struct_size = sizeof vectors};
  return fascia_face_tangents(face, mesh, &vectors) == FASCIA_OK ? (int32_t)vectors.count : -1;
}

EXPORT int32_t web_face_set_layer(fascia_face* face, uint32_t index, uint32_t combine, float weight,
                                  const float* mask) {
  const fascia_layer layer = {sizeof layer, (fascia_combine)combine, weight, 0, mask};
  return (int32_t)fascia_face_set_layer(face, index, &layer);
}

EXPORT uint32_t web_face_state_size(fascia_face* face) {
  size_t size = 0;
  return fascia_face_save(face, 0, 0, &size) == FASCIA_OK ? (uint32_t)size : 0;
}

EXPORT int32_t web_face_save(fascia_face* face, void* to, uint32_t capacity) {
  size_t size = 0;
  return (int32_t)fascia_face_save(face, to, capacity, &size);
}

EXPORT uint32_t web_curves_load(const void* bytes, uint32_t size, double frames_per_second) {
  const fascia_curves_options options = {sizeof options, 0, frames_per_second, 0.0};
  fascia_curves* curves = 0;
  return fascia_curves_load_as(bytes, size, &options, &curves) == FASCIA_OK ? NUMBER(curves) : 0;
}

EXPORT uint32_t web_curves_info(const fascia_curves* curves, uint32_t member) {
  fascia_curves_info info = {.struct_size = sizeof info};
  if (fascia_curves_get_info(curves, &info) != FASCIA_OK) return 0;
  const uint32_t members[] = {info.count, NUMBER(info.names), info.note_count, NUMBER(info.notes)};
  return members[member];
}

EXPORT double web_curves_duration(const fascia_curves* curves) {
  fascia_curves_info info = {.struct_size = sizeof info};
  return fascia_curves_get_info(curves, &info) == FASCIA_OK ? info.duration : 0.0;
}
