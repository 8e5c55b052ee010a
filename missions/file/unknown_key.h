/// Help for whoever misspelt a key of a mission.
#pragma once

#include <string>

namespace skycap::missions::file {

/// What is wrong with an unknown key: the key that was probably meant, or those of its section.
std::string unknown_key_message(const std::string& path);

}  // namespace skycap::missions::file
