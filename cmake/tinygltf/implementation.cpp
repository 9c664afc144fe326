#define TINYGLTF_IMPLEMENTATION
#include "cmake/tinygltf/tinygltf.h"
