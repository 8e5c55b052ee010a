#define SKYCAP_KERNELS_NAME avx2_kernels
#define SKYCAP_KERNELS_LABEL "avx2"
#include "sim/sensors/vector_kernels_body.h"
