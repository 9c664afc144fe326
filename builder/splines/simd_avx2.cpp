#define FASCIA_SIMD_NAMESPACE avx2
#define FASCIA_SIMD_NAME "avx2"
#define FASCIA_SIMD_LANES 4
#include "builder/splines/simd_loops.h"
