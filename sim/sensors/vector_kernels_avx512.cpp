#define SKYCAP_KERNELS_NAME avx512_kernels
#define SKYCAP_KERNELS_LABEL "avx512"
#include "sim/sensors/vector_kernels_body.h"
