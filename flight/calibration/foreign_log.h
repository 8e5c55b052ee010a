/// What a log is that ArduPilot's vehicles do not write.
#pragma once

#include <string>
#include <string_view>

namespace skycap::flight {

/// The kind of the bytes, with what to do instead, such as "a text log of ArduPilot; give the .bin
/// file that it was made from"; empty if it is not known.
std::string foreign_kind(std::string_view bytes);

}  // namespace skycap::flight
