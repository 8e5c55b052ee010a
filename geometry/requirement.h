/// Validation of configuration values.
#pragma once

#include <string>

namespace skycap {

/// Throws Error{bad_config} unless `holds`. The message is "FIELD is VALUE; it must be RULE", with
/// six significant digits of the value.
void require(bool holds, const std::string& field, double value, const std::string& rule);

}  // namespace skycap
