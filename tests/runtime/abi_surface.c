/* The whole interface as one type: the table has every function, and so every structure and enumeration. */
#include "fascia/api.h"

FASCIA_API const fascia_api* fascia_abi_surface(void);

const fascia_api* fascia_abi_surface(void) {
  return NULL;
}
