#define SKYCAP_KERNELS_NAME avx512_distance_kernels
#include "geometry/surfaces/distance_kernels_body.h"
