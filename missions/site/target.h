/// The thing that is to be surveyed, found in a file.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "missions/prior/source.h"
#include "missions/site/wishes.h"

namespace skycap::missions::site {

struct Target {
  std::vector<std::string> ids;  ///< in the file; empty: all of it
  flight::GeodeticPoint origin;  ///< of a frame about its middle, at its lowest place
  Eigen::AlignedBox3d box;       ///< in that frame
};

/// The prior data that the wishes name: the target, everything of its file and what else there is
/// as obstacles, the terrain. Files are as the wishes have them.
std::vector<prior::Source> sources_of(const Wishes& wishes, const std::vector<std::string>& target);

/// Throws Error{bad_config} if the pick is none or several of the file's things, in words that say
/// which there are; what prior::read_prior() throws.
Target find_target(const Wishes& wishes);

}  // namespace skycap::missions::site
