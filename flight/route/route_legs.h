/// The certified legs that a vehicle's routes from one pad are made of, whatever their order.
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

/// Stations that a vehicle can serve, and ways to them. Stations are named by their place among
/// those that admit() has kept.
class RouteLegs {
 public:
  /// `space` and `options` must outlive this object.
  RouteLegs(const Vehicle& vehicle, const FreeSpace& space, const RouteOptions& options);

  /// What the survey flew: its stations, in its order.
  void take_flown(std::vector<Station> stations) { flown_ = std::move(stations); }

  /// The stations that are free themselves, that the gimbal can look from and, if returns are asked
  /// for, that the vehicle can be called home from. The others go to unreached().
  std::vector<Station> allowed(std::vector<Station> stations);

  /// Keeps, of stations that are allowed(), those with a way from and to the pad that can be proven
  /// and that a full battery holds; once. The others go to unreached().
  void admit(const std::vector<Station>& allowed);

  /// Has those go to unreached() whose ways have become longer than a full battery holds, by
  /// give_returns(); whether there are any. Stations have other places then.
  bool drop_out_of_range();

  const std::vector<Station>& stations() const { return stations_; }
  const std::vector<Unreached>& unreached() const { return unreached_; }

  /// From above the pad to a station, and back by the same way.
  const Leg& out(std::size_t station) const { return ends_[station].out; }
  const Leg& back(std::size_t station) const { return ends_[station].back; }

  /// Has out() and back() lead where every point has a proven way home; whether that changed them.
  bool give_returns(std::size_t station);

  /// From one station to another along a way, or along one near it that has returns; nothing if
  /// that cannot be proven, or if the way is empty.
  std::optional<Leg> along(std::vector<Eigen::Vector3d> way, std::size_t from,
                           std::size_t to) const;

  /// From one station to another along the ways of both from the pad, pulled tight.
  Leg by_home(std::size_t from, std::size_t to) const;

  /// As the survey flew it, if the order is the survey's and it did; or else as found; or else by
  /// home.
  Leg between(std::size_t from, std::size_t to);

  /// What a sortie takes beside its legs between stations: take-off included, landing included.
  LegCost out_cost(std::size_t station) const;
  LegCost back_cost(std::size_t station) const;
  LegCost station_cost(std::size_t station) const;

  const Motion& motion() const { return motion_; }
  const Eigen::Vector3d& home() const { return home_; }  ///< above the pad
  const LegCosts& costs() const { return costs_; }
  /// Nothing if returns are not asked for, or before allowed().
  const std::optional<WaysHome>& returns() const { return planner_.returns(); }

 private:
  struct Ends {
    std::vector<Eigen::Vector3d> way;  ///< from above the pad
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
