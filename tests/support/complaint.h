/// What code says when it refuses its input.
#pragma once

#include <string>

#include "geometry/error.h"

namespace skycap::testing_support {

/// The message of the Error that the action throws; empty if it throws none.
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
