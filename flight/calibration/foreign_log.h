/// Identification of logs that do not come from ArduPilot vehicles.
#pragma once

#include <string>
#include <string_view>

namespace skycap::flight {

/// Returns the kind of file with a remedy, such as "an ArduPilot text log; use the .bin file that
/// it was made from". Empty if the kind is unknown.
std::string foreign_kind(std::string_view bytes);

}  // namespace skycap::flight
