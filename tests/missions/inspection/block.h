/// Block of 4 x 4 x 5 m on the ground.
#pragma once

namespace skycap::missions {

inline constexpr const char* block_obj = R"(
v -2 -2 0
v 2 -2 0
v 2 2 0
v -2 2 0
v -2 -2 5
v 2 -2 5
v 2 2 5
v -2 2 5
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

}  // namespace skycap::missions
