#define FASCIA_LANES_NAMESPACE avx512
#define FASCIA_PRODUCT product_avx512
#include "cli/take/product_body.h"
