#include "geometry/surfaces/distance_kernels.h"

#include "geometry/instruction_set.h"

namespace skycap::geometry {

const DistanceKernels& distance_kernels() {
#ifdef SKYCAP_X86_64_KERNELS
  switch (instruction_set()) {
    case InstructionSet::avx512:
      return avx512_distance_kernels;
    case InstructionSet::avx2:
      return avx2_distance_kernels;
    case InstructionSet::baseline:
      break;
  }
#endif
  return baseline_distance_kernels;
}

}  // namespace skycap::geometry
