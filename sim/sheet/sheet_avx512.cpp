#define FASCIA_LANES_NAMESPACE avx512
#define FASCIA_SHEET_STEP step_avx512
#include "sim/sheet/sheet_loops.h"
