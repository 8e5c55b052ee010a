/// The targets of a district: found in its map, and put into groups that are surveyed as one.
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
  std::vector<std::string> ids;  ///< in the order of the map
  bool are_all = false;          ///< that the map holds
  /// Of the district's frame: the middle of the targets, at the height of the lowest foot where
  /// there is a terrain, else of the highest: there the ground is the plane z = 0.
  flight::GeodeticPoint origin;
};

/// Of the first of `files`. Throws Error{bad_config} if nothing is chosen, if the map calls two of
/// those the same, or if without terrain their feet differ by more than 2 m in height; what
/// site_data::read_prior() throws.
ChosenTargets choose_targets(const DistrictFile& district,
                             const std::vector<site_data::Source>& files);

/// Numbers of objects.
using Group = std::vector<std::size_t>;

/// Puts objects that are nearer to each other than `together` into groups, nearest pairs first, as
/// long as a group is no larger than 80 m. Every object is in one; groups and their members are
/// ascending.
std::vector<Group> grouped(std::span<const site_data::Object> objects, double together);

}  // namespace skycap::missions::batch
