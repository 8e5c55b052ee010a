#pragma once

#include <string>

namespace skycap::missions::cli {

/// Returns the output of --version without a trailing line feed: the version, then one line each
/// for commit, compiler and build.
std::string build_text();

}  // namespace skycap::missions::cli
