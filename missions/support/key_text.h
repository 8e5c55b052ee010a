/// Messages about a key of a file.
#pragma once

#include <string>
#include <string_view>

namespace skycap::missions::support {

/// "KEY is 3; it must be ..." if `what` begins with a verb, otherwise "KEY: what".
std::string about_key(std::string_view key, std::string_view what);

}  // namespace skycap::missions::support
