/// Ways to stations and between them, before anything about returns, times and energy is known.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "flight/paths/path.h"
#include "flight/route/route.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

class StationWays {
 public:
  /// From above the pad, `home`. `space` must outlive this object.
  StationWays(const FreeSpace& space, const Eigen::Vector3d& home, const RouteOptions& options);

  /// What the survey flew: its stations, in its order.
  void take_flown(std::vector<Station> stations) { flown_ = std::move(stations); }

  /// From above the pad to a station: as flown where the order is the survey's and that is still
  /// free, or else the shortest found, or else by a passage too narrow for that search's grid, or
  /// else along all that the survey flew before it came there. Empty if there is none.
  std::vector<Eigen::Vector3d> from_home(const Station& to);

  /// As the survey flew from one place to a station; empty if it did not, or if the order is not
  /// the survey's.
  std::vector<Eigen::Vector3d> flown(const Eigen::Vector3d& from, const Station& to) const;

  /// The shortest found; empty if there is none.
  std::vector<Eigen::Vector3d> found(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

 private:
  bool is_free(const std::vector<Eigen::Vector3d>& way) const;
  std::vector<Eigen::Vector3d> all_flown(const Station& to) const;

  const FreeSpace& space_;
  Eigen::Vector3d home_;
  double clearance_, worthwhile_saving_;
  bool keeps_order_;
  PathFinder finder_;
  std::vector<Station> flown_;
};

}  // namespace skycap::flight
