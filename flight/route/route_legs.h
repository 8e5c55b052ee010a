/// Verified legs for all routes of one vehicle from one pad, independent of the order.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/motion/motion.h"
#include "flight/route/leg_costs.h"
#include "flight/route/leg_planner.h"
#include "flight/route/route.h"

namespace skycap::flight {

/// Waypoints within reach of a vehicle, and verified legs between them. An index refers to the
/// waypoints kept by admit().
class RouteLegs {
 public:
  /// Keeps references to `space` and `options`.
  RouteLegs(const Vehicle& vehicle, const FreeSpace& space, const RouteOptions& options);

  /// Sets the waypoints that the survey flew, in its order.
  void set_executed_capture_points(std::vector<CapturePoint> capture_points) {
    executed_ = std::move(capture_points);
  }

  /// Returns the waypoints that are free, within the gimbal limits and, if required, have a return.
  /// The others are added to unreached().
  std::vector<CapturePoint> allowed(std::vector<CapturePoint> capture_points);

  /// Keeps those of the allowed() waypoints that have a verified path from and to the pad within
  /// the range of a full battery. The others are added to unreached(). Must be called once.
  void admit(const std::vector<CapturePoint>& allowed);

  /// Removes waypoints whose paths exceed the battery range after reroute_for_returns() and adds
  /// them to unreached(). Returns true if any was removed, which changes the indices of the others.
  bool drop_out_of_range();

  const std::vector<CapturePoint>& capture_points() const { return capture_points_; }
  const std::vector<Unreached>& unreached() const { return unreached_; }

  /// Returns the leg from above the pad to a waypoint, or the reverse leg along the same path.
  const Leg& out(std::size_t capture_point) const { return ends_[capture_point].out; }
  const Leg& back(std::size_t capture_point) const { return ends_[capture_point].back; }

  /// Changes out() and back() of a waypoint so that every point has a verified return. Returns true
  /// if the legs changed.
  bool reroute_for_returns(std::size_t capture_point);

  /// Returns the leg between two waypoints along `approach_path`, or along a nearby path that has
  /// returns. Returns std::nullopt if that cannot be verified, or if `approach_path` is empty.
  std::optional<Leg> along(std::vector<Eigen::Vector3d> approach_path, std::size_t from,
                           std::size_t to) const;

  /// Returns the leg between two waypoints along their paths from the pad, pulled tight.
  Leg via_home(std::size_t from, std::size_t to) const;

  /// Returns the leg between two waypoints along the path flown by the survey, if the order is that
  /// of the survey. Otherwise it follows the path found by the planner or, without one, via_home().
  Leg between(std::size_t from, std::size_t to);

  /// Returns the cost of take-off and first leg, of last leg and landing, or of the stop at a
  /// waypoint.
  LegCost out_cost(std::size_t capture_point) const;
  LegCost back_cost(std::size_t capture_point) const;
  LegCost capture_cost(std::size_t capture_point) const;

  const Motion& motion() const { return motion_; }
  const Eigen::Vector3d& home() const { return home_; }  ///< Position above the pad.
  const LegCosts& costs() const { return costs_; }
  /// Returns the returns planner. std::nullopt if returns are not required, or before allowed() is
  /// called.
  const std::optional<ReturnPaths>& returns() const { return planner_.returns(); }

 private:
  struct Ends {
    std::vector<Eigen::Vector3d> approach_path;  ///< Path from above the pad.
    Leg out, back;
    bool has_returns = false;
  };

  void reject(const CapturePoint& capture_point, const std::string& reason,
              const std::string& remedy);
  std::string rejection_reason(const CapturePoint& capture_point) const;
  void keep_with_return(std::vector<CapturePoint>& capture_points);
  std::optional<Ends> ends_along(std::vector<Eigen::Vector3d> approach_path) const;
  std::string range_error(const CapturePoint& capture_point, const Ends& ends) const;
  std::vector<Eigen::Vector3d> path_from_home(const CapturePoint& to);
  bool is_free(const std::vector<Eigen::Vector3d>& approach_path) const;
  std::vector<Eigen::Vector3d> executed_path(const Eigen::Vector3d& from,
                                             const CapturePoint& to) const;
  std::vector<Eigen::Vector3d> whole_executed_path(const CapturePoint& to) const;

  Motion motion_;
  const FreeSpace& space_;
  const RouteOptions& options_;
  double clearance_;
  Eigen::Vector3d home_;
  LegPlanner planner_;
  LegCosts costs_;
  LegCost takeoff_cost_, landing_cost_;
  std::vector<CapturePoint> executed_;
  std::vector<CapturePoint> capture_points_;
  std::vector<Ends> ends_;
  std::vector<Unreached> unreached_;
};

}  // namespace skycap::flight
