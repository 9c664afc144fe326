#define FASCIA_LANES_NAMESPACE baseline
#define FASCIA_LOOPS loops_baseline
#include "sim/realtime/loops.h"
