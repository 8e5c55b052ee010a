/// Where the surveys of a district take off from, and the flight of all its targets.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "flight/flight_options.h"
#include "missions/batch/district/prepared.h"
#include "missions/wizard/pad_search.h"

namespace skycap::missions::batch {

class PadChoice {
 public:
  /// Keeps references to all. Throws Error{bad_config} if a pad that the district gives is none.
  PadChoice(const DistrictFile& district, const flight::FlightOptions& draft,
            const flight::GeodeticPoint& origin, std::span<const PreparedTarget> targets);

  /// The pad of a target's survey: beside it, or else the nearest that the district gives.
  std::optional<Eigen::Vector3d> pad_of(std::size_t target, double top);

  /// Those that the district gives; else of the targets' own as few as leave none of these targets
  /// farther than 300 m from one: first the one nearest to the middle, then those of the targets
  /// that are farthest off.
  std::vector<Eigen::Vector3d> pads_of_flight() const;

 private:
  void take_given(const DistrictFile& district, const flight::GeodeticPoint& origin);

  std::span<const PreparedTarget> targets_;
  wizard::PadSearch search_;
  std::vector<Eigen::Vector3d> given_;
  std::vector<std::optional<Eigen::Vector3d>> own_;  ///< by target
};

}  // namespace skycap::missions::batch
