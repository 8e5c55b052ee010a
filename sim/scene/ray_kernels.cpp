#include "sim/scene/ray_kernels.h"

#include "geometry/instruction_set.h"

namespace skycap::sim {

const RayKernels& ray_kernels() {
#ifdef SKYCAP_X86_64_KERNELS
  // A single ray tests eight boxes at a time, which is half an AVX-512 register.
  static const RayKernels for_avx512 = {avx512_ray_kernels.cast,
                                        avx512_ray_kernels.cast_tile,
                                        avx512_ray_kernels.cast_tile_distances,
                                        avx2_ray_kernels.cast_single,
                                        avx2_ray_kernels.is_blocked,
                                        avx512_ray_kernels.blocked};
  switch (geometry::instruction_set()) {
    case geometry::InstructionSet::avx512:
      return for_avx512;
    case geometry::InstructionSet::avx2:
      return avx2_ray_kernels;
    case geometry::InstructionSet::baseline:
      break;
  }
#endif
  return baseline_ray_kernels;
}

}  // namespace skycap::sim
