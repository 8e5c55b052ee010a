/// Suggestions for misspelt mission keys.
#pragma once

#include <span>
#include <string>

#include "missions/config/key.h"

namespace skycap::missions::config {

/// Returns the error message for an unknown key. It suggests the most similar key, or lists the
/// keys of the same section.
std::string unknown_key_message(const std::string& path, std::span<const Key> keys);

}  // namespace skycap::missions::config
