#pragma once

#include <string>

namespace skycap::missions::cli {

/// The text of --version, without a line feed at its end: version; then a line each for commit,
/// compiler and build.
std::string build_text();

}  // namespace skycap::missions::cli
