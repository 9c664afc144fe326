/* A host that loads the library by itself and knows no function but fascia_get_api.
 *   table_host LIBRARY RIG.glb
 */
#include "fascia/api.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#include <windows.h>
static fascia_get_api_function look_up(const char* path) {
  HMODULE library = LoadLibraryA(path);
  return library == NULL ? NULL : (fascia_get_api_function)(void*)GetProcAddress(library, "fascia_get_api");
}
#else
#include <dlfcn.h>
static fascia_get_api_function look_up(const char* path) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  fascia_get_api_function function = NULL;
  void* symbol = library == NULL ? NULL : dlsym(library, "fascia_get_api");
  memcpy(&function, &symbol, sizeof function);
  return function;
}
#endif

static const fascia_api* api;

static void require(int condition, const char* what) {
  if (condition) return;
  fprintf(stderr, "failed: %s (%s)\n", what, api == NULL ? "no table" : api->last_message());
  exit(1);
}

static unsigned char* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  unsigned char* bytes = malloc(64 << 20);
  require(file != NULL && bytes != NULL, "the rig is there");
  *size = fread(bytes, 1, 64 << 20, file);
  fclose(file);
  return bytes;
}

static fascia_vectors positions(fascia_face* face) {
  fascia_vectors vectors = {sizeof vectors, 0, 0, 0, NULL};
  require(api->face_positions(face, 0, &vectors) == FASCIA_OK, "positions");
  return vectors;
}

/* A frame played again from a saved state ends with the same bits. */
static void rewind_a_frame(fascia_face* face) {
  size_t size = 0;
  fascia_vectors now = positions(face);
  const size_t bytes = (size_t)now.count * now.stride;
  unsigned char *state, *first = malloc(bytes), *rest = malloc(bytes);
  require(api->face_save(face, NULL, 0, &size) == FASCIA_OK && size > 0, "size of a state");
  state = malloc(size);
  require(state != NULL && first != NULL && rest != NULL, "memory");
  memcpy(rest, now.data, bytes);
  api->face_values(face)[0] = 0.8f;
  require(api->face_step(face, 0.1f) == FASCIA_OK, "a step");
  require(api->face_save(face, state, size, &size) == FASCIA_OK, "save");
  require(api->face_step(face, 0.1f) == FASCIA_OK, "another step");
  memcpy(first, positions(face).data, bytes);
  require(memcmp(first, rest, bytes) != 0, "the face moves");
  require(api->face_step(face, 0.1f) == FASCIA_OK, "a third step");
  require(api->face_restore(face, state, size) == FASCIA_OK, "restore");
  require(api->face_step(face, 0.1f) == FASCIA_OK, "the step again");
  require(memcmp(first, positions(face).data, bytes) == 0, "the same bits");
  free(state);
  free(first);
  free(rest);
}

/* The members at the end of the table. */
static void use_a_layer(const fascia_asset* asset, fascia_face* face) {
  fascia_vectors texcoords = {sizeof texcoords, 0, 0, 0, NULL};
  const fascia_layer layer = {sizeof layer, FASCIA_COMBINE_MAX, 1.0f, 0, NULL};
  require(api->asset_texcoords(asset, 0, &texcoords) == FASCIA_OK, "texture coordinates");
  require(api->face_set_layer(face, 1, &layer) == FASCIA_OK, "a layer");
  require(api->face_layer_set_member(face, 1, 0, 0, 0.5f) == FASCIA_OK, "a member of a layer");
  require(api->face_layer_remove(face, 1) == FASCIA_OK, "the layer is removed");
  require(api->face_layer_values(face, 1) == NULL, "the layer is gone");
}

int main(int argc, char** argv) {
  fascia_get_api_function get_api;
  fascia_asset* asset = NULL;
  fascia_face* face = NULL;
  unsigned char* bytes;
  size_t size = 0;
  require(argc == 3, "table_host LIBRARY RIG.glb");
  get_api = look_up(argv[1]);
  require(get_api != NULL, "the library has fascia_get_api");
  require(get_api((FASCIA_VERSION_MAJOR + 1) << 16, &api) == FASCIA_ERROR_VERSION && api == NULL,
          "another major version is refused");
  require(get_api(FASCIA_VERSION_MAJOR << 16 | FASCIA_VERSION_MINOR << 8, &api) == FASCIA_OK, "the table");
  require(api->struct_size == sizeof *api, "the table is this header's");
  bytes = read_file(argv[2], &size);
  require(api->asset_load(bytes, size, &asset) == FASCIA_OK, "load");
  require(api->face_create(asset, NULL, &face) == FASCIA_OK, "create");
  rewind_a_frame(face);
  use_a_layer(asset, face);
  require(api->asset_load(bytes, size / 2, &asset) == FASCIA_ERROR_FORMAT, "half a rig is refused");
  api->face_release(face);
  api->asset_release(asset);
  free(bytes);
  puts("table_host: the table is all there is");
  return 0;
}
