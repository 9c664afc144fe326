#define FASCIA_LANES_NAMESPACE avx512
#define FASCIA_LOOPS loops_avx512
#include "sim/realtime/loops.h"
