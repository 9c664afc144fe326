#define FASCIA_LANES_NAMESPACE avx2
#define FASCIA_PRODUCT product_avx2
#include "cli/take/product_body.h"
