#define FASCIA_LANES_NAMESPACE avx2
#define FASCIA_SHEET_STEP step_avx2
#include "sim/sheet/sheet_loops.h"
