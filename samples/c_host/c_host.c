/* The least a host does: load a rig, smile, let a second pass, look at the vertices. */
#include <fascia/fascia.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The whole of a file; NULL when it cannot be read. */
static unsigned char* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  unsigned char* bytes = NULL;
  long length;
  if (file == NULL) return NULL;
  if (fseek(file, 0, SEEK_END) == 0 && (length = ftell(file)) > 0 && fseek(file, 0, SEEK_SET) == 0) {
    bytes = malloc((size_t)length);
    *size = bytes == NULL ? 0 : fread(bytes, 1, (size_t)length, file);
    if (*size != (size_t)length) {
      free(bytes);
      bytes = NULL;
    }
  }
  fclose(file);
  return bytes;
}

static int fail(const char* what) {
  fprintf(stderr, "%s: %s\n", what, fascia_last_message());
  return 1;
}

/* Longest way a vertex of any mesh has gone from `rest`, in metres. */
static double farthest(fascia_face* face, uint32_t mesh, const float* rest) {
  fascia_vectors now = {sizeof now, 0, 0, 0, NULL};
  double most = 0;
  uint32_t i;
  if (fascia_face_positions(face, mesh, &now) != FASCIA_OK) return 0;
  for (i = 0; i < now.count; ++i) {
    const double x = now.data[3 * i] - rest[3 * i], y = now.data[3 * i + 1] - rest[3 * i + 1],
                 z = now.data[3 * i + 2] - rest[3 * i + 2];
    const double way = sqrt(x * x + y * y + z * z);
    if (way > most) most = way;
  }
  return most;
}

static int smile(fascia_face* face) {
  /* A rig without the ARKit set still has the muscles. */
  if (fascia_face_set(face, "arkit:mouthSmileLeft", 0.8f) == FASCIA_OK &&
      fascia_face_set(face, "arkit:mouthSmileRight", 0.8f) == FASCIA_OK)
    return 1;
  return fascia_face_set(face, "zygomaticus_major_left", 0.8f) == FASCIA_OK &&
         fascia_face_set(face, "zygomaticus_major_right", 0.8f) == FASCIA_OK;
}

int main(int argc, char** argv) {
  fascia_asset* asset = NULL;
  fascia_face* face = NULL;
  fascia_face_options options = fascia_default_face_options();
  fascia_asset_info info = {0};
  fascia_vectors positions = {sizeof positions, 0, 0, 0, NULL};
  unsigned char* bytes;
  float* rest;
  size_t size = 0;
  int frame;
  uint32_t i;

  if (argc != 2) {
    fprintf(stderr, "usage: sample_c_host RIG.glb\n");
    return 2;
  }
  bytes = read_file(argv[1], &size);
  if (bytes == NULL) {
    fprintf(stderr, "cannot read %s\n", argv[1]);
    return 1;
  }
  if (fascia_asset_load(bytes, size, &asset) != FASCIA_OK) return fail(argv[1]);
  free(bytes); /* the asset does not need it */

  info.struct_size = sizeof info;
  if (fascia_asset_get_info(asset, &info) != FASCIA_OK || info.mesh_count == 0) return fail("info");
  options.space = FASCIA_SPACE_METRES;
  if (fascia_face_create(asset, &options, &face) != FASCIA_OK) return fail("face");
  if (fascia_face_positions(face, 0, &positions) != FASCIA_OK) return fail("positions");
  rest = malloc(positions.count * 3 * sizeof *rest);
  if (rest == NULL) return 1;
  for (i = 0; i < positions.count * 3; ++i)
    rest[i] = positions.data[i];

  if (!smile(face)) return fail("smile");
  for (frame = 0; frame < 60; ++frame)
    if (fascia_face_step(face, 1.0f / 60.0f) != FASCIA_OK) return fail("step");
  printf("%u meshes, %u channels, %u muscles\n", (unsigned)info.mesh_count, (unsigned)info.channel_count,
         (unsigned)info.muscle_count);
  printf("one second of smiling moved the first mesh by up to %.2f mm\n", 1000.0 * farthest(face, 0, rest));

  free(rest);
  fascia_face_release(face);
  fascia_asset_release(asset);
  return 0;
}
