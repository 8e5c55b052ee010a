#include "sim/sensors/vector_kernels.h"

#include "geometry/instruction_set.h"

namespace skycap::sim {

const VectorKernels& vector_kernels() {
#ifdef SKYCAP_X86_64_KERNELS
  switch (geometry::instruction_set()) {
    case geometry::InstructionSet::avx512:
      return avx512_kernels;
    case geometry::InstructionSet::avx2:
      return avx2_kernels;
    case geometry::InstructionSet::baseline:
      break;
  }
#endif
  return baseline_kernels;
}

}  // namespace skycap::sim
