/// The thing that is to be surveyed, found in a file.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/source.h"
#include "missions/wizard/wishes.h"

namespace skycap::missions::wizard {

struct Target {
  std::vector<std::string> ids;  ///< in the file; empty: all of it
  flight::GeodeticPoint origin;  ///< of a frame about its middle, at its lowest place
  Eigen::AlignedBox3d box;       ///< in that frame
  double uncertainty = 0.0;      ///< how far off it may be [m]
};

/// The files that the wishes name, each with what it does not say itself: the map, as an obstacle,
/// then the other obstacles and the terrain. Files are as the wishes have them. Throws what
/// site_data::completed() throws.
std::vector<site_data::Source> files_of(const Wishes& wishes);

/// The prior data of a mission: the target, of the first of the files, and all of them.
std::vector<site_data::Source> sources_of(const std::vector<site_data::Source>& files,
                                          const std::vector<std::string>& target);

/// What `select` means of the first of the files, on the terrain, about an origin. Throws what
/// site_data::read_prior() throws.
site_data::Prior read_things(const std::vector<site_data::Source>& files,
                             const site_data::Selection& select,
                             const flight::GeodeticPoint& origin);

/// Throws Error{bad_config} if several of a file's things have that name.
void require_single(const std::vector<site_data::Object>& objects, const std::string& id,
                    const std::string& file);

/// Throws Error{bad_config} if the pick is none of the file's things, or several that are not named
/// one by one, in words that say which there are; what site_data::read_prior() throws.
Target find_target(const std::vector<site_data::Source>& files, const Pick& pick);

}  // namespace skycap::missions::wizard
