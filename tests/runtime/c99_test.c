/* The public header as a C99 program sees it. */
#include "fascia/api.h"

#include <stdio.h>
#include <string.h>

static int failures = 0;

static void expect(int condition, const char* what) {
  if (condition) return;
  fprintf(stderr, "failed: %s\n", what);
  ++failures;
}

int main(void) {
  fascia_asset* asset = NULL;
  fascia_asset_info info = {.struct_size = sizeof info};
  const fascia_face_options options = fascia_default_face_options();
  expect(fascia_version() == (FASCIA_VERSION_MAJOR << 16 | FASCIA_VERSION_MINOR << 8 | FASCIA_VERSION_PATCH),
         "header and library are of one version");
  expect(sizeof(fascia_result) == 4 && sizeof(fascia_space) == 4 && sizeof(fascia_solver) == 4,
         "enums are 32 bits");
  expect(options.struct_size == sizeof options && options.level == -1, "default options");
  expect(strcmp(fascia_last_message(), "") == 0, "no message before a failure");
  expect(fascia_asset_load("glTF", 4, &asset) == FASCIA_ERROR_FORMAT, "four bytes are no rig");
  expect(asset == NULL, "nothing is written on failure");
  expect(strstr(fascia_last_message(), "cut short") != NULL, "the message says why");
  expect(fascia_asset_get_info(NULL, &info) == FASCIA_ERROR_ARGUMENT, "null asset");
  expect(strcmp(fascia_result_name(FASCIA_ERROR_FORMAT), "FASCIA_ERROR_FORMAT") == 0, "result names");
  fascia_asset_release(NULL);
  fascia_face_release(NULL);
  fascia_curves_release(NULL);
  return failures;
}
