/** \file
 * All functions of Fascia's runtime in one table, for hosts that load the library dynamically: look up
 * fascia_get_api only (dlsym, GetProcAddress) and call the other functions through the table.
 */
#ifndef FASCIA_API_H
#define FASCIA_API_H

#include "fascia/fascia.h"
#include "fascia/fit.h"
#include "fascia/gpu.h"
#include "fascia/research.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The table. Each member is the function of the same name with the prefix fascia_, and is documented there.
 * Within a major version members are only appended. */
typedef struct fascia_api {
  uint32_t struct_size;     /**< of the library's table: later members do not exist */
  uint32_t library_version; /**< as returned by fascia_version */
  uint32_t (*version)(void);
  const char* (*result_name)(fascia_result result);
  const char* (*last_message)(void);
  void (*set_log)(fascia_log_function function, void* user);
  fascia_result (*set_allocator)(const fascia_allocator* allocator);
  fascia_result (*asset_load)(const void* bytes, size_t size, fascia_asset** asset);
  void (*asset_release)(fascia_asset* asset);
  fascia_result (*asset_get_info)(const fascia_asset* asset, fascia_asset_info* info);
  fascia_result (*asset_get_level)(const fascia_asset* asset, uint32_t level, fascia_level_info* info);
  fascia_result (*asset_get_mesh)(const fascia_asset* asset, uint32_t mesh, fascia_mesh_info* info);
  fascia_result (*asset_get_channels)(const fascia_asset* asset, fascia_channels* channels);
  fascia_result (*asset_get_set)(const fascia_asset* asset, uint32_t set, fascia_set_info* info);
  int32_t (*asset_find_channel)(const fascia_asset* asset, const char* name);
  fascia_result (*asset_find_member)(const fascia_asset* asset, const char* name, uint32_t* set,
                                     uint32_t* member);
  fascia_result (*asset_surface)(const fascia_asset* asset, const char* name, fascia_surface* surface);
  fascia_result (*asset_fibres)(const fascia_asset* asset, uint32_t level, fascia_fibres* fibres);
  fascia_face_options (*default_face_options)(void);
  fascia_result (*face_create)(fascia_asset* asset, const fascia_face_options* options, fascia_face** face);
  void (*face_release)(fascia_face* face);
  float* (*face_values)(fascia_face* face);
  fascia_result (*face_set)(fascia_face* face, const char* name, float value);
  fascia_result (*face_get)(const fascia_face* face, const char* name, float* value);
  fascia_result (*face_set_member)(fascia_face* face, uint32_t set, uint32_t member, float value);
  fascia_result (*face_clear)(fascia_face* face);
  fascia_result (*face_set_layer)(fascia_face* face, uint32_t index, const fascia_layer* layer);
  float* (*face_layer_values)(fascia_face* face, uint32_t layer);
  fascia_result (*face_layer_set)(fascia_face* face, uint32_t layer, const char* name, float value);
  fascia_result (*face_layer_clear)(fascia_face* face, uint32_t layer);
  fascia_result (*face_look_at)(fascia_face* face, const float* point, float weight);
  fascia_result (*face_blend)(fascia_face* face, float share, float seconds);
  const float* (*face_effective_values)(const fascia_face* face);
  fascia_result (*face_pose)(fascia_face* face);
  fascia_result (*face_step)(fascia_face* face, float seconds);
  fascia_result (*faces_step)(fascia_face* const* faces, uint32_t count, float seconds,
                              const fascia_tasks* tasks);
  fascia_result (*face_reset)(fascia_face* face);
  fascia_result (*face_set_level)(fascia_face* face, int32_t level, float seconds);
  int32_t (*face_level)(const fascia_face* face);
  fascia_result (*face_save)(fascia_face* face, void* to, size_t capacity, size_t* size);
  fascia_result (*face_restore)(fascia_face* face, const void* bytes, size_t size);
  fascia_result (*face_set_acceleration)(fascia_face* face, const float* acceleration);
  fascia_result (*face_move_head)(fascia_face* face, const float matrix[16], float inertia_scale);
  fascia_result (*face_touch)(fascia_face* face, uint32_t mesh, uint32_t vertex, const float force[3]);
  fascia_result (*face_clear_touches)(fascia_face* face);
  fascia_result (*face_positions)(fascia_face* face, uint32_t mesh, fascia_vectors* positions);
  fascia_result (*face_normals)(fascia_face* face, uint32_t mesh, fascia_vectors* normals);
  fascia_result (*face_tangents)(fascia_face* face, uint32_t mesh, fascia_vectors* tangents);
  fascia_result (*face_compression)(fascia_face* face, uint32_t mesh, fascia_vectors* compression);
  fascia_result (*face_write_positions)(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                        size_t capacity);
  fascia_result (*face_write_normals)(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                      size_t capacity);
  fascia_result (*face_write_tangents)(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                       size_t capacity);
  fascia_result (*face_fibre_points)(fascia_face* face, fascia_vectors* points);
  fascia_result (*face_jaw)(const fascia_face* face, float matrix[16]);
  fascia_result (*curves_load)(const void* bytes, size_t size, fascia_curves** curves);
  fascia_result (*curves_load_as)(const void* bytes, size_t size, const fascia_curves_options* options,
                                  fascia_curves** curves);
  void (*curves_release)(fascia_curves* curves);
  fascia_result (*curves_get_info)(const fascia_curves* curves, fascia_curves_info* info);
  fascia_result (*curves_match)(const fascia_curves* curves, const fascia_asset* asset, uint32_t* count,
                                uint8_t* matched);
  fascia_result (*curves_head)(const fascia_curves* curves, double seconds, float quaternion[4]);
  fascia_result (*curves_apply)(const fascia_curves* curves, double seconds, float weight, fascia_face* face);
  fascia_result (*curves_apply_to_layer)(const fascia_curves* curves, double seconds, float weight,
                                         fascia_face* face, uint32_t layer);
  fascia_result (*face_write_deltas)(fascia_face* face, uint32_t mesh, fascia_delta_format format, void* to,
                                     size_t stride, size_t capacity, float* scale);
  fascia_result (*face_skinning)(fascia_face* face, uint32_t mesh, fascia_skinning* skinning);
  fascia_result (*face_write_node_texture)(fascia_face* face, uint32_t mesh, float* to, size_t capacity);
  fascia_result (*face_bone_matrices)(fascia_face* face, uint32_t mesh, float matrices[48]);
  fascia_result (*asset_lattice)(const fascia_asset* asset, uint32_t level, fascia_lattice* lattice);
  fascia_result (*face_nodes)(fascia_face* face, fascia_vectors* nodes);
  fascia_result (*face_energies)(fascia_face* face, fascia_energies* energies);
  fascia_result (*face_node_forces)(fascia_face* face, float* to, size_t capacity);
  fascia_result (*face_fibre_forces)(fascia_face* face, float* to, size_t capacity);
  fascia_result (*face_gradient)(fascia_face* face, const float* const* slopes, float* by_channel);
  fascia_fit_options (*default_fit_options)(void);
  fascia_result (*fit_create)(fascia_asset* asset, const fascia_fit_landmarks* landmarks,
                              const fascia_fit_options* options, fascia_fit** fit);
  void (*fit_release)(fascia_fit* fit);
  fascia_result (*fit_get_info)(const fascia_fit* fit, fascia_fit_info* info);
  fascia_result (*fit_set_neutral)(fascia_fit* fit, const float* points, const float* weights);
  fascia_result (*fit_push)(fascia_fit* fit, const float* points, const float* weights,
                            fascia_fit_result* result);
  fascia_result (*fit_reset)(fascia_fit* fit);
  fascia_result (*face_member_gradient)(const fascia_face* face, uint32_t set, const float* by_channel,
                                        float* by_member);
  fascia_result (*asset_texcoords)(const fascia_asset* asset, uint32_t mesh, fascia_vectors* texcoords);
  fascia_result (*face_layer_set_member)(fascia_face* face, uint32_t layer, uint32_t set, uint32_t member,
                                         float value);
  fascia_result (*face_layer_remove)(fascia_face* face, uint32_t layer);
} fascia_api;

/** Gives the library's table, a constant, to a host compiled for `version` (FASCIA_VERSION_MAJOR << 16 |
 * FASCIA_VERSION_MINOR << 8): FASCIA_ERROR_VERSION if the library has another major version or a smaller
 * minor version (before 1.0 any other minor version). */
FASCIA_API fascia_result fascia_get_api(uint32_t version, const fascia_api** api);

/** The type of fascia_get_api, for the symbol that dlsym or GetProcAddress returns. */
typedef fascia_result (*fascia_get_api_function)(uint32_t version, const fascia_api** api);

#ifdef __cplusplus
}
#endif

#endif
