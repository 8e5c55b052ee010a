/// For the functions that most of the planning time is spent in: compiled twice, for every
/// processor and for AVX2. Contraction is off (see CMakeLists.txt), so that both give the same
/// bits.
///
/// Such a function is a body that is always inlined, and two functions that do nothing but call it,
/// one of them with SKYCAP_FOR_AVX2 before it.
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
