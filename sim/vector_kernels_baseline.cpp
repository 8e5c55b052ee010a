#define SKYCAP_KERNELS_NAME baseline_kernels
#define SKYCAP_KERNELS_LABEL "baseline"
#include "sim/vector_kernels_body.h"
