#pragma once

// The one way to include tinygltf in this project.
#if defined(__GNUC__)
#pragma GCC system_header
#endif

#include <tiny_gltf.h>
