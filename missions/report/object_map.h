/// HTML page with a map of objects. A click on an object displays the command that surveys it.
#pragma once

#include <string>
#include <vector>

#include "missions/site_data/prior.h"

namespace skycap::missions::report {

/// Returns the page as one HTML file that loads no other files. `command` is the command without
/// the target, quoted for a shell. A click appends " --id 'NAME'". North is up. Objects without an
/// area are skipped. O(triangles).
std::string object_map(const std::string& title, const std::vector<site_data::Object>& objects,
                       const std::string& command);

}  // namespace skycap::missions::report
