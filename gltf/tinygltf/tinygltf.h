#pragma once

// The one way to include tinygltf in this project.
#if defined(__GNUC__)
#pragma GCC system_header
#endif

// Under a name of our own: Debian's libdraco exports a tinygltf of another make, and a linker would mix the
// two.
#define tinygltf fascia_tinygltf
#include <tiny_gltf.h>
