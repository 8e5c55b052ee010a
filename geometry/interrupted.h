/// Cancellation of work in progress.
#pragma once

#include <exception>

namespace skycap {

/// Thrown by cancelled work, such as a path search. Not derived from Error, because a cancellation
/// is not a failure that the user has to correct.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

}  // namespace skycap
