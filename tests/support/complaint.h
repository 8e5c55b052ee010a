/// Error messages of the code under test.
#pragma once

#include <string>

#include "geometry/error.h"

namespace skycap::testing_support {

/// Returns the message of the Error that the action throws, or an empty string.
template <typename Action>
std::string thrown_message(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace skycap::testing_support
