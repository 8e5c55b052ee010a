/// What can be told from a source's text without a compiler: draws of random numbers whose order is
/// the compiler's to choose.
#pragma once

#include <string>
#include <vector>

#include "tests/structure/source_tree.h"

namespace skycap::structure {

/// The text with spaces for comments, directives and what stands in quotes; lines stay.
std::string strip_comments(const std::string& text);

/// One line for each call whose arguments hold two draws of random numbers: compilers take
/// arguments of a call in any order, those within braces from left to right.
std::vector<std::string> unordered_draws(const std::filesystem::path& root,
                                         const std::vector<SourceFile>& sources);

}  // namespace skycap::structure
