#define SKYCAP_KERNELS_NAME avx512_kernels
#include "sim/sensors/vector_kernels_body.h"
