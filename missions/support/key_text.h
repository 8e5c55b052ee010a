/// Error messages about keys.
#pragma once

#include <string>
#include <string_view>

namespace skycap::missions::support {

/// Returns "KEY is 3; it must be ..." if `what` begins with a predicate such as "is", otherwise
/// "KEY: what".
std::string about_key(std::string_view key, std::string_view what);

}  // namespace skycap::missions::support
