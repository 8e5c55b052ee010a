/// Cancellation of work in progress.
#pragma once

#include <exception>

namespace skycap {

/// Thrown by work that was told to stop, such as a search for a path. It is not an
/// Error: nothing is wrong, and there is nothing for the user to correct.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

}  // namespace skycap
