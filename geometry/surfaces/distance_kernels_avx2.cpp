#define SKYCAP_KERNELS_NAME avx2_distance_kernels
#include "geometry/surfaces/distance_kernels_body.h"
