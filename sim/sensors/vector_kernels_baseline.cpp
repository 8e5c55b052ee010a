#define SKYCAP_KERNELS_NAME baseline_kernels
#define SKYCAP_KERNELS_LABEL "baseline"
#include "sim/sensors/vector_kernels_body.h"
