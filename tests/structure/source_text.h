/// Checks on source text without a compiler: random draws in unspecified order.
#pragma once

#include <string>
#include <vector>

#include "tests/structure/source_tree.h"

namespace skycap::structure {

/// Returns the text with comments, directives and quoted text replaced by spaces. Line breaks are
/// kept.
std::string strip_comments(const std::string& text);

/// Returns one line for each call with two random draws in its arguments. Compilers evaluate
/// arguments in any order, except within braces, where the order is left to right.
std::vector<std::string> unordered_draws(const std::filesystem::path& root,
                                         const std::vector<SourceFile>& sources);

}  // namespace skycap::structure
