/// Verified legs for all routes of one vehicle from one pad, independent of the order.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "flight/route/leg_costs.h"
#include "flight/route/leg_planner.h"
#include "flight/route/route.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// Waypoints within reach of a vehicle, and verified legs between them. An index refers to the
/// waypoints kept by admit().
class RouteLegs {
 public:
  /// Keeps references to `space` and `options`.
  RouteLegs(const Vehicle& vehicle, const FreeSpace& space, const RouteOptions& options);

  /// Sets the waypoints that the survey flew, in its order.
  void take_flown(std::vector<Station> stations) { flown_ = std::move(stations); }

  /// Returns the waypoints that are free, within the gimbal limits and, if required, have a return.
  /// The others are added to unreached().
  std::vector<Station> allowed(std::vector<Station> stations);

  /// Keeps those of the allowed() waypoints that have a verified path from and to the pad within
  /// the range of a full battery. The others are added to unreached(). Must be called once.
  void admit(const std::vector<Station>& allowed);

  /// Removes waypoints whose paths exceed the battery range after give_returns() and adds them to
  /// unreached(). Returns true if any was removed, which changes the indices of the others.
  bool drop_out_of_range();

  const std::vector<Station>& stations() const { return stations_; }
  const std::vector<Unreached>& unreached() const { return unreached_; }

  /// Returns the leg from above the pad to a waypoint, or the reverse leg along the same path.
  const Leg& out(std::size_t station) const { return ends_[station].out; }
  const Leg& back(std::size_t station) const { return ends_[station].back; }

  /// Changes out() and back() of a waypoint so that every point has a verified return. Returns true
  /// if the legs changed.
  bool give_returns(std::size_t station);

  /// Returns the leg between two waypoints along `way`, or along a nearby path that has returns.
  /// Returns std::nullopt if that cannot be verified, or if `way` is empty.
  std::optional<Leg> along(std::vector<Eigen::Vector3d> way, std::size_t from,
                           std::size_t to) const;

  /// Returns the leg between two waypoints along their paths from the pad, pulled tight.
  Leg by_home(std::size_t from, std::size_t to) const;

  /// Returns the leg between two waypoints along the path flown by the survey, if the order is that
  /// of the survey. Otherwise it follows the path found by the planner or, without one, by_home().
  Leg between(std::size_t from, std::size_t to);

  /// Returns the cost of take-off and first leg, of last leg and landing, or of the stop at a
  /// waypoint.
  LegCost out_cost(std::size_t station) const;
  LegCost back_cost(std::size_t station) const;
  LegCost station_cost(std::size_t station) const;

  const Motion& motion() const { return motion_; }
  const Eigen::Vector3d& home() const { return home_; }  ///< Position above the pad.
  const LegCosts& costs() const { return costs_; }
  /// Returns the returns planner. std::nullopt if returns are not required, or before allowed() is
  /// called.
  const std::optional<WaysHome>& returns() const { return planner_.returns(); }

 private:
  struct Ends {
    std::vector<Eigen::Vector3d> way;  ///< Path from above the pad.
    Leg out, back;
    bool has_returns = false;
  };

  void refuse(const Station& station, const std::string& reason);
  std::string why_not_allowed(const Station& station) const;
  void keep_with_return(std::vector<Station>& stations);
  std::optional<Ends> ends_along(std::vector<Eigen::Vector3d> way) const;
  std::string why_out_of_range(const Station& station, const Ends& ends) const;
  std::vector<Eigen::Vector3d> from_home(const Station& to);
  bool is_free(const std::vector<Eigen::Vector3d>& way) const;
  std::vector<Eigen::Vector3d> flown(const Eigen::Vector3d& from, const Station& to) const;
  std::vector<Eigen::Vector3d> all_flown(const Station& to) const;

  Motion motion_;
  const FreeSpace& space_;
  const RouteOptions& options_;
  double clearance_;
  Eigen::Vector3d home_;
  LegPlanner planner_;
  LegCosts costs_;
  LegCost takeoff_cost_, landing_cost_;
  std::vector<Station> flown_;
  std::vector<Station> stations_;
  std::vector<Ends> ends_;
  std::vector<Unreached> unreached_;
};

}  // namespace skycap::flight
