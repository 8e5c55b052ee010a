/// Selects the targets of a district in its map and groups those surveyed together.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "flight/export/geodesy.h"
#include "missions/batch/district/district_file.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/source.h"

namespace skycap::missions::batch {

struct ChosenTargets {
  std::vector<std::string> ids;  ///< identifiers in map order
  bool are_all = false;          ///< whether these are all objects of the map
  /// Origin of the district frame at the centre of the targets. With terrain, its height is the
  /// minimum base height of the targets, otherwise the maximum. The ground there is the plane z =
  /// 0.
  flight::GeodeticPoint origin;
};

/// Selects targets from the first of `files`. Throws Error{bad_config} if no target is selected or
/// two selected objects have the same identifier. Also throws it if base heights differ by more
/// than 2 m and the district has no terrain. Throws the errors of site_data::read_prior().
ChosenTargets choose_targets(const DistrictFile& district,
                             const std::vector<site_data::Source>& files);

/// Indices of objects.
using Group = std::vector<std::size_t>;

/// Groups objects closer to each other than `together` [m], closest pairs first. A group is not
/// extended beyond a size of 80 m. Every object is in exactly one group. Groups and their members
/// are in ascending order.
std::vector<Group> grouped(std::span<const site_data::Object> objects, double together);

}  // namespace skycap::missions::batch
