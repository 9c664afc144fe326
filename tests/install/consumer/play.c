#include <fascia/fascia.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Loads a rig, contracts its first channel and says how far the skin moved. */
int main(int argc, char** argv) {
  static unsigned char bytes[1 << 22];
  fascia_asset* asset = NULL;
  fascia_face* face = NULL;
  fascia_vectors positions = {sizeof(fascia_vectors), 0, 0, 0, NULL};
  FILE* file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (file == NULL) return 2;
  size_t size = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  if (fascia_asset_load(bytes, size, &asset) != FASCIA_OK ||
      fascia_face_create(asset, NULL, &face) != FASCIA_OK) {
    fprintf(stderr, "%s\n", fascia_last_message());
    return 1;
  }
  fascia_face_positions(face, 0, &positions);
  float* rest = malloc(sizeof(float) * 3 * positions.count);
  for (size_t i = 0; i < (size_t)3 * positions.count; ++i)
    rest[i] = positions.data[i];
  fascia_face_values(face)[0] = 1.0f;
  fascia_face_pose(face);
  fascia_face_positions(face, 0, &positions);
  float most = 0.0f;
  for (size_t i = 0; i < (size_t)3 * positions.count; ++i)
    most = fmaxf(most, fabsf(positions.data[i] - rest[i]));
  printf("version %u moved %.6f\n", (unsigned)fascia_version(), most);
  free(rest);
  fascia_face_release(face);
  fascia_asset_release(asset);
  return most > 0.0f && isfinite(most) ? 0 : 1;
}
