/// Operations on four numbers at a time. Internal to this folder.
#pragma once

#include <cmath>
#include <cstring>

namespace skycap::sim {

/// Four lanes in one register of any processor. Explicit vectors are required because the compiler
/// does not vectorise loops with comparisons. A comparison gives -1 for true and 0 for false.
using FourFloats [[gnu::vector_size(16), gnu::may_alias]] = float;
using FourInts [[gnu::vector_size(16), gnu::may_alias]] = int;

/// Returns four lanes from memory that is aligned to 16 bytes.
template <typename Four, typename Lane>
Four four(const Lane* lanes) {
  return *reinterpret_cast<const Four*>(lanes);
}
template <typename Four, typename Lane>
void put_four(Lane* lanes, Four values) {
  std::memcpy(lanes, &values, sizeof values);
}
inline int sum(FourInts lanes) { return lanes[0] + lanes[1] + lanes[2] + lanes[3]; }
inline FourFloats square_root(FourFloats of) {
  for (int lane = 0; lane < 4; ++lane) of[lane] = std::sqrt(of[lane]);
  return of;
}

}  // namespace skycap::sim
