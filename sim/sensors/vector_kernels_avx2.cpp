#define SKYCAP_KERNELS_NAME avx2_kernels
#include "sim/sensors/vector_kernels_body.h"
