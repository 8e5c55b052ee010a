#define SKYCAP_KERNELS_NAME baseline_distance_kernels
#include "geometry/surfaces/distance_kernels_body.h"
