/* A face in Godot 3: the NativeScript class FasciaFace, on GDNative's C interface. See README.md for its
 * methods.
 *
 * Godot owns the files and the scene: GDScript hands over a rig's bytes and takes arrays for ArrayMesh. */
#include <gdnative_api_struct.gen.h>

#include <fascia/fascia.h>

static const godot_gdnative_core_api_struct* api;
static const godot_gdnative_ext_nativescript_api_struct* script_api;

typedef struct face_data {
  fascia_asset* asset;
  fascia_face* face;
} face_data;

static godot_variant nothing(void) {
  godot_variant result;
  api->godot_variant_new_nil(&result);
  return result;
}

static godot_variant number(double value) {
  godot_variant result;
  api->godot_variant_new_real(&result, value);
  return result;
}

static godot_variant text(const char* utf8) {
  godot_string string = api->godot_string_chars_to_utf8(utf8 != NULL ? utf8 : "");
  godot_variant result;
  api->godot_variant_new_string(&result, &string);
  api->godot_string_destroy(&string);
  return result;
}

/* OK, or the error's message in Godot's log and false. */
static godot_variant outcome(fascia_result result) {
  godot_variant answer;
  if (result != FASCIA_OK && result != FASCIA_ERROR_DIVERGED)
    api->godot_print_error(fascia_last_message(), "FasciaFace", __FILE__, __LINE__);
  api->godot_variant_new_bool(&answer, result == FASCIA_OK || result == FASCIA_ERROR_DIVERGED);
  return answer;
}

static void* make(godot_object* instance, void* method_data) {
  face_data* data = api->godot_alloc(sizeof *data);
  (void)instance;
  (void)method_data;
  data->asset = NULL;
  data->face = NULL;
  return data;
}

static void drop(face_data* data) {
  fascia_face_release(data->face);
  fascia_asset_release(data->asset);
  data->face = NULL;
  data->asset = NULL;
}

static void destroy(godot_object* instance, void* method_data, void* user_data) {
  (void)instance;
  (void)method_data;
  drop(user_data);
  api->godot_free(user_data);
}

#define METHOD(name)                                                                               \
  static godot_variant name(godot_object* instance, void* method_data, void* user_data, int count, \
                            godot_variant** arguments)
#define UNUSED (void)instance, (void)method_data, (void)count, (void)arguments
#define NEEDS(arguments_needed)      \
  face_data* const data = user_data; \
  UNUSED;                            \
  if (count < (arguments_needed) || data->face == NULL) return nothing()

/* load(bytes: PoolByteArray, level := -1) -> bool */
METHOD(load) {
  face_data* const data = user_data;
  UNUSED;
  if (count < 1) return nothing();
  godot_pool_byte_array bytes = api->godot_variant_as_pool_byte_array(arguments[0]);
  godot_pool_byte_array_read_access* access = api->godot_pool_byte_array_read(&bytes);
  fascia_face_options options = fascia_default_face_options();
  fascia_result result;
  options.level = count > 1 ? (int32_t)api->godot_variant_as_int(arguments[1]) : -1;
  drop(data);
  result = fascia_asset_load(api->godot_pool_byte_array_read_access_ptr(access),
                             (size_t)api->godot_pool_byte_array_size(&bytes), &data->asset);
  if (result == FASCIA_OK) result = fascia_face_create(data->asset, &options, &data->face);
  api->godot_pool_byte_array_read_access_destroy(access);
  api->godot_pool_byte_array_destroy(&bytes);
  if (result != FASCIA_OK) {
    const godot_variant answer = outcome(result);
    drop(data);
    return answer;
  }
  return outcome(result);
}

/* set_value(name: String, value: float) -> bool */
METHOD(set_value) {
  NEEDS(2);
  godot_string name = api->godot_variant_as_string(arguments[0]);
  godot_char_string utf8 = api->godot_string_utf8(&name);
  const fascia_result result = fascia_face_set(data->face, api->godot_char_string_get_data(&utf8),
                                               (float)api->godot_variant_as_real(arguments[1]));
  api->godot_char_string_destroy(&utf8);
  api->godot_string_destroy(&name);
  return outcome(result);
}

METHOD(clear) {
  NEEDS(0);
  return outcome(fascia_face_clear(data->face));
}

/* step(seconds: float) -> bool */
METHOD(step) {
  NEEDS(1);
  const double seconds = api->godot_variant_as_real(arguments[0]);
  return outcome(fascia_face_step(data->face, (float)(seconds < 1.0 ? seconds : 1.0)));
}

METHOD(pose) {
  NEEDS(0);
  return outcome(fascia_face_pose(data->face));
}

METHOD(reset) {
  NEEDS(0);
  return outcome(fascia_face_reset(data->face));
}

METHOD(mesh_count) {
  NEEDS(0);
  fascia_asset_info info = {.struct_size = sizeof info};
  fascia_asset_get_info(data->asset, &info);
  return number(info.mesh_count);
}

/* part(mesh: int) -> String: skin, eye_left, teeth_lower, ... */
METHOD(part) {
  NEEDS(1);
  fascia_mesh_info info = {.struct_size = sizeof info};
  const uint32_t mesh = (uint32_t)api->godot_variant_as_int(arguments[0]);
  return fascia_asset_get_mesh(data->asset, mesh, &info) == FASCIA_OK ? text(info.part) : nothing();
}

/* name(mesh: int) -> String: of the mesh in the rig's file */
METHOD(name) {
  NEEDS(1);
  fascia_mesh_info info = {.struct_size = sizeof info};
  const uint32_t mesh = (uint32_t)api->godot_variant_as_int(arguments[0]);
  return fascia_asset_get_mesh(data->asset, mesh, &info) == FASCIA_OK ? text(info.name) : nothing();
}

static godot_variant vectors_of(const fascia_vectors* vectors) {
  godot_pool_vector3_array array;
  godot_variant result;
  api->godot_pool_vector3_array_new(&array);
  api->godot_pool_vector3_array_resize(&array, (godot_int)vectors->count);
  godot_pool_vector3_array_write_access* access = api->godot_pool_vector3_array_write(&array);
  godot_vector3* to = api->godot_pool_vector3_array_write_access_ptr(access);
  for (uint32_t v = 0; v < vectors->count; ++v)
    api->godot_vector3_new(&to[v], vectors->data[3 * v], vectors->data[3 * v + 1], vectors->data[3 * v + 2]);
  api->godot_pool_vector3_array_write_access_destroy(access);
  api->godot_variant_new_pool_vector3_array(&result, &array);
  api->godot_pool_vector3_array_destroy(&array);
  return result;
}

/* positions(mesh: int) -> PoolVector3Array, and normals */
METHOD(positions) {
  NEEDS(1);
  fascia_vectors vectors = {.struct_size = sizeof vectors};
  const fascia_result result =
      fascia_face_positions(data->face, (uint32_t)api->godot_variant_as_int(arguments[0]), &vectors);
  return result == FASCIA_OK ? vectors_of(&vectors) : outcome(result);
}

METHOD(normals) {
  NEEDS(1);
  fascia_vectors vectors = {.struct_size = sizeof vectors};
  const fascia_result result =
      fascia_face_normals(data->face, (uint32_t)api->godot_variant_as_int(arguments[0]), &vectors);
  return result == FASCIA_OK ? vectors_of(&vectors) : outcome(result);
}

/* texcoords(mesh: int) -> PoolVector2Array, empty if the file has none */
METHOD(texcoords) {
  NEEDS(1);
  fascia_vectors vectors = {.struct_size = sizeof vectors};
  godot_pool_vector2_array array;
  godot_variant answer;
  const uint32_t mesh = (uint32_t)api->godot_variant_as_int(arguments[0]);
  const fascia_result result = fascia_asset_texcoords(data->asset, mesh, &vectors);
  if (result != FASCIA_OK) return outcome(result);
  api->godot_pool_vector2_array_new(&array);
  api->godot_pool_vector2_array_resize(&array, (godot_int)vectors.count);
  godot_pool_vector2_array_write_access* access = api->godot_pool_vector2_array_write(&array);
  godot_vector2* to = api->godot_pool_vector2_array_write_access_ptr(access);
  for (uint32_t v = 0; v < vectors.count; ++v)
    api->godot_vector2_new(&to[v], vectors.data[2 * v], vectors.data[2 * v + 1]);
  api->godot_pool_vector2_array_write_access_destroy(access);
  api->godot_variant_new_pool_vector2_array(&answer, &array);
  api->godot_pool_vector2_array_destroy(&array);
  return answer;
}

/* triangles(mesh: int) -> PoolIntArray, wound as Godot wants them: clockwise seen from outside */
METHOD(triangles) {
  NEEDS(1);
  fascia_mesh_info info = {.struct_size = sizeof info};
  godot_pool_int_array array;
  godot_variant result;
  const uint32_t mesh = (uint32_t)api->godot_variant_as_int(arguments[0]);
  if (fascia_asset_get_mesh(data->asset, mesh, &info) != FASCIA_OK) return nothing();
  api->godot_pool_int_array_new(&array);
  api->godot_pool_int_array_resize(&array, (godot_int)(3 * info.triangle_count));
  godot_pool_int_array_write_access* access = api->godot_pool_int_array_write(&array);
  godot_int* to = api->godot_pool_int_array_write_access_ptr(access);
  for (uint32_t t = 0; t < info.triangle_count; ++t) {
    to[3 * t] = (godot_int)info.triangles[3 * t];
    to[3 * t + 1] = (godot_int)info.triangles[3 * t + 2];
    to[3 * t + 2] = (godot_int)info.triangles[3 * t + 1];
  }
  api->godot_pool_int_array_write_access_destroy(access);
  api->godot_variant_new_pool_int_array(&result, &array);
  api->godot_pool_int_array_destroy(&array);
  return result;
}

GDN_EXPORT void godot_gdnative_init(godot_gdnative_init_options* options);
GDN_EXPORT void godot_gdnative_terminate(godot_gdnative_terminate_options* options);
GDN_EXPORT void godot_nativescript_init(void* handle);

void godot_gdnative_init(godot_gdnative_init_options* options) {
  api = options->api_struct;
  for (unsigned i = 0; i < api->num_extensions; ++i)
    if (api->extensions[i]->type == GDNATIVE_EXT_NATIVESCRIPT)
      script_api = (const godot_gdnative_ext_nativescript_api_struct*)api->extensions[i];
}

void godot_gdnative_terminate(godot_gdnative_terminate_options* options) {
  (void)options;
  api = NULL;
  script_api = NULL;
}

void godot_nativescript_init(void* handle) {
  static const struct {
    const char* name;
    godot_variant (*run)(godot_object*, void*, void*, int, godot_variant**);
  } methods[] = {
      {"load", load},          {"set_value", set_value}, {"clear", clear},           {"step", step},
      {"pose", pose},          {"reset", reset},         {"mesh_count", mesh_count}, {"part", part},
      {"name", name},          {"positions", positions}, {"normals", normals},       {"triangles", triangles},
      {"texcoords", texcoords}};
  const godot_instance_create_func create = {make, NULL, NULL};
  const godot_instance_destroy_func release = {destroy, NULL, NULL};
  const godot_method_attributes attributes = {GODOT_METHOD_RPC_MODE_DISABLED};
  if (script_api == NULL) return;
  script_api->godot_nativescript_register_class(handle, "FasciaFace", "Reference", create, release);
  for (unsigned i = 0; i < sizeof methods / sizeof methods[0]; ++i) {
    const godot_instance_method method = {methods[i].run, NULL, NULL};
    script_api->godot_nativescript_register_method(handle, "FasciaFace", methods[i].name, attributes, method);
  }
}
