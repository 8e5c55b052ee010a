#define SKYCAP_KERNELS_NAME baseline_kernels
#include "sim/sensors/vector_kernels_body.h"
