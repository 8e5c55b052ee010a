/// How what follows from a mission says what it is at.
#pragma once

#include <functional>
#include <string>

namespace skycap::missions::config {

/// Told what is being done, where that may take long. May be empty.
using Report = std::function<void(const std::string& what)>;

}  // namespace skycap::missions::config
