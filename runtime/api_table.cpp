#include "fascia/api.h"

#include "runtime/api.h"

using namespace fascia::runtime;

namespace {

const fascia_api table = {
    .struct_size = sizeof(fascia_api),
    .library_version = FASCIA_VERSION_MAJOR << 16 | FASCIA_VERSION_MINOR << 8 | FASCIA_VERSION_PATCH,
    .version = fascia_version,
    .result_name = fascia_result_name,
    .last_message = fascia_last_message,
    .set_log = fascia_set_log,
    .set_allocator = fascia_set_allocator,
    .asset_load = fascia_asset_load,
    .asset_release = fascia_asset_release,
    .asset_get_info = fascia_asset_get_info,
    .asset_get_level = fascia_asset_get_level,
    .asset_get_mesh = fascia_asset_get_mesh,
    .asset_get_channels = fascia_asset_get_channels,
    .asset_get_set = fascia_asset_get_set,
    .asset_find_channel = fascia_asset_find_channel,
    .asset_find_member = fascia_asset_find_member,
    .asset_surface = fascia_asset_surface,
    .asset_fibres = fascia_asset_fibres,
    .default_face_options = fascia_default_face_options,
    .face_create = fascia_face_create,
    .face_release = fascia_face_release,
    .face_values = fascia_face_values,
    .face_set = fascia_face_set,
    .face_get = fascia_face_get,
    .face_set_member = fascia_face_set_member,
    .face_clear = fascia_face_clear,
    .face_set_layer = fascia_face_set_layer,
    .face_layer_values = fascia_face_layer_values,
    .face_layer_set = fascia_face_layer_set,
    .face_layer_clear = fascia_face_layer_clear,
    .face_look_at = fascia_face_look_at,
    .face_blend = fascia_face_blend,
    .face_effective_values = fascia_face_effective_values,
    .face_pose = fascia_face_pose,
    .face_step = fascia_face_step,
    .faces_step = fascia_faces_step,
    .face_reset = fascia_face_reset,
    .face_set_level = fascia_face_set_level,
    .face_level = fascia_face_level,
    .face_save = fascia_face_save,
    .face_restore = fascia_face_restore,
    .face_set_acceleration = fascia_face_set_acceleration,
    .face_move_head = fascia_face_move_head,
    .face_touch = fascia_face_touch,
    .face_clear_touches = fascia_face_clear_touches,
    .face_positions = fascia_face_positions,
    .face_normals = fascia_face_normals,
    .face_tangents = fascia_face_tangents,
    .face_compression = fascia_face_compression,
    .face_write_positions = fascia_face_write_positions,
    .face_write_normals = fascia_face_write_normals,
    .face_write_tangents = fascia_face_write_tangents,
    .face_fibre_points = fascia_face_fibre_points,
    .face_jaw = fascia_face_jaw,
    .curves_load = fascia_curves_load,
    .curves_load_as = fascia_curves_load_as,
    .curves_release = fascia_curves_release,
    .curves_get_info = fascia_curves_get_info,
    .curves_match = fascia_curves_match,
    .curves_head = fascia_curves_head,
    .curves_apply = fascia_curves_apply,
    .curves_apply_to_layer = fascia_curves_apply_to_layer,
    .face_write_deltas = fascia_face_write_deltas,
    .face_skinning = fascia_face_skinning,
    .face_write_node_texture = fascia_face_write_node_texture,
    .face_bone_matrices = fascia_face_bone_matrices,
    .asset_lattice = fascia_asset_lattice,
    .face_nodes = fascia_face_nodes,
    .face_energies = fascia_face_energies,
    .face_node_forces = fascia_face_node_forces,
    .face_fibre_forces = fascia_face_fibre_forces,
    .face_gradient = fascia_face_gradient,
    .default_fit_options = fascia_default_fit_options,
    .fit_create = fascia_fit_create,
    .fit_release = fascia_fit_release,
    .fit_get_info = fascia_fit_get_info,
    .fit_set_neutral = fascia_fit_set_neutral,
    .fit_push = fascia_fit_push,
    .fit_reset = fascia_fit_reset,
    .face_member_gradient = fascia_face_member_gradient,
    .asset_texcoords = fascia_asset_texcoords,
    .face_layer_set_member = fascia_face_layer_set_member,
    .face_layer_remove = fascia_face_layer_remove,
};

}  // namespace

extern "C" fascia_result fascia_get_api(uint32_t version, const fascia_api** api) {
  return guarded([&] {
    require(api != nullptr, "the table to write is null");
    const uint32_t major = version >> 16, minor = version >> 8 & 0xffU;
    const bool fits = major == FASCIA_VERSION_MAJOR &&
                      (major == 0 ? minor == FASCIA_VERSION_MINOR : minor <= FASCIA_VERSION_MINOR);
    if (!fits)
      throw Failure(FASCIA_ERROR_VERSION, "the host was made for version " + std::to_string(major) + "." +
                                              std::to_string(minor) + " of the library, which is " +
                                              std::to_string(FASCIA_VERSION_MAJOR) + "." +
                                              std::to_string(FASCIA_VERSION_MINOR));
    *api = &table;
    return FASCIA_OK;
  });
}
