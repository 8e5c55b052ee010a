/// Help for whoever misspelt a key of a mission.
#pragma once

#include <span>
#include <string>

#include "missions/config/key.h"

namespace skycap::missions::config {

/// What is wrong with a key that is none of `keys`: the one that was probably meant, or those of
/// its section.
std::string unknown_key_message(const std::string& path, std::span<const Key> keys);

}  // namespace skycap::missions::config
