#include <cstdio>

#include "anatomy/anatomy.h"
#include "builder/rigging/build_rig.h"

int main() {
  const fascia::anatomy::GenericAnatomy anatomy = fascia::anatomy::load_generic();
  std::printf("landmarks %zu\n", anatomy.landmarks.size());
  return anatomy.landmarks.empty() ? 1 : 0;
}
