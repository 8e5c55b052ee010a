#define SKYCAP_KERNELS_NAME avx512_ray_kernels
#include "sim/scene/ray_kernels_body.h"
