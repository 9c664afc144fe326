// Eigen includes <mmintrin.h> with SSE2; emscripten has SSE2 but no MMX, which nothing uses.
#pragma once
