#pragma once

#include <stdexcept>
#include <string>

namespace skycap {

/// Why an operation could not be carried out; `missions/` maps each kind to an exit code.
enum class ErrorKind {
  bad_usage,     ///< command line
  bad_config,    ///< a key of a mission file or a field of a configuration
  bad_file,      ///< a file that cannot be read or written, or does not hold what it should
  bad_geometry,  ///< a mesh, cloud or scan that cannot be worked with
};

/// The one exception type that Skycap throws. `what()` is a sentence for the user:
/// it names the value, says what is wrong with it, and what would be right.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace skycap
