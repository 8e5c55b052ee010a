#include "flight/fleet/fleet_bound.h"

#include <algorithm>
#include <limits>

#include "flight/fleet/collection_bound.h"
#include "flight/route/tour.h"

namespace skycap::flight {
namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

/// Minimum times over all vehicles, equal in both directions.
class BestTimes {
 public:
  explicit BestTimes(const FleetProblem& least) : least_(least), pad_(least.count(), unknown) {
    std::vector<double> out(count(), unknown), back(count(), unknown), rest(count(), unknown);
    for (const FleetVehicle& vehicle : least.vehicles) {
      for (std::size_t i = 0; i < count(); ++i) {
        out[i] = std::min(out[i], vehicle.out[i].time);
        back[i] = std::min(back[i], vehicle.back[i].time);
        rest[i] = std::min(rest[i], vehicle.station[i].time);
      }
    }
    double least_out = unknown, least_back = unknown;
    for (std::size_t i = 0; i < count(); ++i) {
      pad_[i] = std::min(out[i], back[i]);
      least_out = std::min(least_out, out[i] - pad_[i]);
      least_back = std::min(least_back, back[i] - pad_[i]);
      longest_ = std::max(longest_, out[i] + rest[i] + back[i]);
      rests_ += rest[i];
    }
    each_ = least_out + least_back;
  }

  std::size_t count() const { return pad_.size(); }
  double longest() const { return longest_; }

  /// Returns a lower bound for `tours` closed tours from the pad through all waypoints [s].
  double bound_of(std::size_t tours) const {
    const auto stations = static_cast<std::uint32_t>(count());
    const auto nodes = static_cast<std::uint32_t>(count() + tours);
    const auto cost = [&](std::uint32_t a, std::uint32_t b) {
      if (a >= stations && b >= stations) return apart;
      if (a >= stations) return pad_[b];
      return b >= stations ? pad_[a] : between(a, b);
    };
    const double bound = plan_tour(nodes, cost).lower_bound;
    return rests_ + static_cast<double>(tours) * each_ + bound;
  }

 private:
  /// Returns the time directly or via the pad, so that several sorties of a vehicle count as one
  /// tour.
  double between(std::uint32_t a, std::uint32_t b) const {
    double time = pad_[a] + pad_[b] + each_;
    for (const FleetVehicle& vehicle : least_.vehicles) {
      time = std::min({time, vehicle.leg(a, b).time, vehicle.leg(b, a).time});
    }
    return time;
  }

  /// Cost between two pad copies, which no tour has in a row.
  static constexpr double apart = 1e6;

  const FleetProblem& least_;
  std::vector<double> pad_;  ///< Minimum of the times to and from a waypoint.
  double each_ = 0.0;        ///< Further time per tour, such as its landing.
  double rests_ = 0.0, longest_ = 0.0;
};

}  // namespace

FleetBound fleet_bound(const FleetProblem& least, double makespan) {
  if (least.count() == 0) return {};
  const BestTimes times(least);
  double shared = unknown;
  FleetBound bound;
  for (std::size_t k = 1; k <= std::min(least.vehicles.size(), times.count()); ++k) {
    const double flown = times.bound_of(k);
    if (k == 1) bound.flown = flown;
    shared = std::min(shared, flown / static_cast<double>(k));
  }
  const double collected = collection_bound(least, makespan);
  bound.makespan = std::min(makespan, std::max({times.longest(), shared, collected}));
  return bound;
}

}  // namespace skycap::flight
