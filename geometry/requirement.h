/// How configurations complain of a value.
#pragma once

#include <string>

namespace skycap {

/// Throws Error{bad_config} "FIELD is VALUE; it must be RULE", the value with six significant
/// digits, unless what is required holds.
void require(bool holds, const std::string& field, double value, const std::string& rule);

}  // namespace skycap
