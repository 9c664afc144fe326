#define FASCIA_LANES_NAMESPACE baseline
#define FASCIA_SHEET_STEP step_baseline
#include "sim/sheet/sheet_loops.h"
