#include "fascia/fascia.h"  // the library is made of runtime_core; a shared library needs a source of its own
