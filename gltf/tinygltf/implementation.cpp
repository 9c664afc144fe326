#define TINYGLTF_IMPLEMENTATION
#include "gltf/tinygltf/tinygltf.h"
