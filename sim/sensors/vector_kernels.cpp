#include "sim/sensors/vector_kernels.h"

namespace skycap::sim {

bool can_run(const VectorKernels& kernels) {
#ifdef SKYCAP_X86_64_KERNELS
  // What -march=x86-64-v3 and -v4 let the compiler use, of which these imply the rest.
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") &&
                    __builtin_cpu_supports("fma");
  if (&kernels == &avx2_kernels) return avx2;
  if (&kernels == &avx512_kernels) {
    return avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  }
#endif
  return &kernels == &baseline_kernels;
}

const VectorKernels& vector_kernels() {
#ifdef SKYCAP_X86_64_KERNELS
  static const VectorKernels& fastest = can_run(avx512_kernels) ? avx512_kernels
                                        : can_run(avx2_kernels) ? avx2_kernels
                                                                : baseline_kernels;
  return fastest;
#else
  return baseline_kernels;
#endif
}

}  // namespace skycap::sim
