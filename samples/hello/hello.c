/* A face in fifty lines: hello RIG.glb > smile.obj */
#include <fascia/fascia.h>
#include <stdio.h>
#include <stdlib.h>

static void check(fascia_result result) {
  if (result == FASCIA_OK) return;
  fprintf(stderr, "hello: %s\n", fascia_last_message());
  exit(1);
}

int main(int argc, char** argv) {
  FILE* file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
    fprintf(stderr, "usage: hello RIG.glb > smile.obj\n");
    return 2;
  }
  const long size = ftell(file);
  unsigned char* bytes = malloc(size > 0 ? (size_t)size : 1);
  rewind(file);
  const size_t read = fread(bytes, 1, (size_t)size, file);
  fclose(file);
  fascia_asset* asset = NULL; /* the rig: load it once */
  fascia_face* face = NULL;   /* a head: one for each in the scene */
  check(fascia_asset_load(bytes, read, &asset));
  check(fascia_face_create(asset, NULL, &face));
  if (fascia_face_set(face, "arkit:mouthSmileLeft", 0.8f) != FASCIA_OK)
    check(fascia_face_set(face, "#0", 0.8f));

  for (int frame = 0; frame < 60; ++frame)
    check(fascia_face_step(face, 1.0f / 60.0f));
  fascia_asset_info info = {.struct_size = sizeof info};
  check(fascia_asset_get_info(asset, &info));
  for (uint32_t mesh = 0, first = 1; mesh < info.mesh_count; ++mesh) {
    fascia_mesh_info shape = {.struct_size = sizeof shape};
    fascia_vectors places = {.struct_size = sizeof places};
    check(fascia_asset_get_mesh(asset, mesh, &shape));
    check(fascia_face_positions(face, mesh, &places));
    for (uint32_t v = 0; v < places.count; ++v)
      printf("v %g %g %g\n", places.data[3 * v], places.data[3 * v + 1], places.data[3 * v + 2]);
    for (const uint32_t *t = shape.triangles, *end = t + 3 * shape.triangle_count; t < end; t += 3)
      printf("f %u %u %u\n", t[0] + first, t[1] + first, t[2] + first);
    first += places.count;
  }
  fascia_face_release(face);
  fascia_asset_release(asset);
  free(bytes);
  return 0;
}
