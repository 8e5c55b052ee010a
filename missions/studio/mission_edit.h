/// Edits single keys in the text of a mission file. Comments and layout are preserved.
#pragma once

#include <map>
#include <string>

namespace skycap::missions::studio {

/// Returns the values of all keys of a mission text in the notation of a mission file, by path,
/// such as "flight.clearance": "2.5". Values are in one line. Throws Error{bad_config}, prefixed
/// with `name` and the line, if the text is not YAML.
std::map<std::string, std::string> list_values(const std::string& text, const std::string& name);

/// Returns the text with a key set to a value in YAML notation; an empty value removes the key.
/// A value of several lines is replaced by one line; comments within it are moved before the line.
/// Throws Error{bad_config} if the value is not one YAML value. It also throws if the layout does
/// not permit replacing the key alone; the text must then be edited directly.
std::string with_key(const std::string& text, const std::string& key, const std::string& value);

}  // namespace skycap::missions::studio
