#define FASCIA_SIMD_NAMESPACE avx512
#define FASCIA_SIMD_NAME "avx512"
#define FASCIA_SIMD_LANES 8
#include "builder/splines/simd_loops.h"
