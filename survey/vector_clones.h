/// Support for functions compiled twice, for the baseline instruction set and for AVX2. Used for
/// the functions that dominate the planning time. Floating-point contraction is off (see
/// CMakeLists.txt), so that both versions give the same bits.
///
/// Such a function consists of an always-inlined body and two functions that only call it, one of
/// them marked SKYCAP_FOR_AVX2.
#pragma once

#include "geometry/instruction_set.h"

#if defined(__x86_64__)
#define SKYCAP_FOR_AVX2 __attribute__((target("arch=x86-64-v3")))
#else
#define SKYCAP_FOR_AVX2
#endif

namespace skycap::survey {

inline bool has_avx2() { return geometry::instruction_set() >= geometry::InstructionSet::avx2; }

}  // namespace skycap::survey
