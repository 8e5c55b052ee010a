#pragma once

#include <stdexcept>
#include <string>

namespace skycap {

/// Category of a failure. `missions/` maps each category to an exit code.
enum class ErrorKind {
  bad_usage,     ///< invalid command line
  bad_config,    ///< invalid key of a mission file or field of a configuration
  bad_file,      ///< file that cannot be read or written, or whose content is invalid
  bad_geometry,  ///< mesh, cloud or scan that cannot be processed
};

/// The only exception type for failures in Skycap. `what()` is a message for the user: it names the
/// value, states what is wrong, and states the rule.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace skycap
