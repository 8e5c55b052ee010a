#define SKYCAP_KERNELS_NAME baseline_ray_kernels
#include "sim/scene/ray_kernels_body.h"
