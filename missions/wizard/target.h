/// Finds the object to survey in a map.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/source.h"
#include "missions/wizard/site_request.h"

namespace skycap::missions::wizard {

struct Target {
  std::vector<std::string> ids;  ///< identifiers in the file; empty: all objects
  /// Origin of a frame at the target's centre, at its minimum height.
  flight::GeodeticPoint origin;
  Eigen::AlignedBox3d box;   ///< bounding box in this frame [m]
  double uncertainty = 0.0;  ///< position uncertainty [m]
};

/// The files that the wishes name, each with what it does not say itself: the map, as an obstacle,
/// then the other obstacles and the terrain. Files are as the wishes have them. Throws
/// Error{bad_config} that lists all values that the files lack, and what site_data::completed()
/// throws.
std::vector<site_data::Source> collect_files(const SiteRequest& request);

/// Returns whether collect_files() assumes that the heights in the map are above the geoid, because
/// neither the map nor the request specifies a vertical datum. Throws the errors of
/// site_data::missing_values().
bool assumes_geoid(const SiteRequest& request);

/// All objects of the first of the files about their middle, in the frame's axes. Throws what
/// site_data::read_prior() throws.
std::vector<site_data::Object> list_things(const std::vector<site_data::Source>& files);

/// Returns the prior data of a mission: the target from the first of `files`, followed by all
/// files.
std::vector<site_data::Source> select_sources(const std::vector<site_data::Source>& files,
                                              const std::vector<std::string>& target);

/// Reads the selected objects from the first of `files`, placed on the terrain, in a frame at
/// `origin`. Throws the errors of site_data::read_prior().
site_data::Prior read_things(const std::vector<site_data::Source>& files,
                             const site_data::Selection& select,
                             const flight::GeodeticPoint& origin);

/// Throws Error{bad_config} if several objects of a file have the identifier `id`.
void require_single(const std::vector<site_data::Object>& objects, const std::string& id,
                    const std::string& file);

/// Finds the target. Throws Error{bad_config} with a list of candidates if the selection matches no
/// object, or several that are not individually named. Throws the errors of
/// site_data::read_prior().
Target find_target(const std::vector<site_data::Source>& files, const Pick& pick);

}  // namespace skycap::missions::wizard
