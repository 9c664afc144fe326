#define FASCIA_LANES_NAMESPACE baseline
#define FASCIA_PRODUCT product_baseline
#include "cli/take/product_body.h"
