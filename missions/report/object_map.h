/// A page with the objects of a map from above: a click on one prints the command that surveys it.
#pragma once

#include <string>
#include <vector>

#include "missions/site_data/prior.h"

namespace skycap::missions::report {

/// The page as one HTML file that loads nothing. `command` is the command without the target,
/// quoted for a shell; a click appends " --id 'NAME'". North is up. Objects without an area are
/// omitted. O(triangles).
std::string object_map(const std::string& title, const std::vector<site_data::Object>& objects,
                       const std::string& command);

}  // namespace skycap::missions::report
