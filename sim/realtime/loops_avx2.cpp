#define FASCIA_LANES_NAMESPACE avx2
#define FASCIA_LOOPS loops_avx2
#include "sim/realtime/loops.h"
