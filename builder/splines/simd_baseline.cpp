#define FASCIA_SIMD_NAMESPACE baseline
#define FASCIA_SIMD_NAME "baseline"
#define FASCIA_SIMD_LANES 2
#include "builder/splines/simd_loops.h"
