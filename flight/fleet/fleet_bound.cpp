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
  explicit BestTimes(const FleetProblem& lower_bound)
      : lower_bound_(lower_bound), pad_(lower_bound.count(), unknown) {
    std::vector<double> out(count(), unknown), back(count(), unknown), rest(count(), unknown);
    for (const FleetVehicle& vehicle : lower_bound.vehicles) {
      for (std::size_t i = 0; i < count(); ++i) {
        out[i] = std::min(out[i], vehicle.out[i].time);
        back[i] = std::min(back[i], vehicle.back[i].time);
        rest[i] = std::min(rest[i], vehicle.capture_point[i].time);
      }
    }
    double min_out = unknown, min_back = unknown;
    for (std::size_t i = 0; i < count(); ++i) {
      pad_[i] = std::min(out[i], back[i]);
      min_out = std::min(min_out, out[i] - pad_[i]);
      min_back = std::min(min_back, back[i] - pad_[i]);
      longest_ = std::max(longest_, out[i] + rest[i] + back[i]);
      rests_ += rest[i];
    }
    each_ = min_out + min_back;
  }

  std::size_t count() const { return pad_.size(); }
  double longest() const { return longest_; }

  /// Returns a lower bound for `tours` closed tours from the pad through all waypoints [s].
  double compute_bound(std::size_t tours) const {
    const auto capture_points = static_cast<std::uint32_t>(count());
    const auto nodes = static_cast<std::uint32_t>(count() + tours);
    const auto cost = [&](std::uint32_t a, std::uint32_t b) {
      if (a >= capture_points && b >= capture_points) return apart;
      if (a >= capture_points) return pad_[b];
      return b >= capture_points ? pad_[a] : between(a, b);
    };
    const double bound = plan_tour(nodes, cost).lower_bound;
    return rests_ + static_cast<double>(tours) * each_ + bound;
  }

 private:
  /// Returns the time directly or via the pad, so that several sorties of a vehicle count as one
  /// tour.
  double between(std::uint32_t a, std::uint32_t b) const {
    double time = pad_[a] + pad_[b] + each_;
    for (const FleetVehicle& vehicle : lower_bound_.vehicles) {
      time = std::min({time, vehicle.leg(a, b).time, vehicle.leg(b, a).time});
    }
    return time;
  }

  /// Cost between two pad copies, which no tour has in a row.
  static constexpr double apart = 1e6;

  const FleetProblem& lower_bound_;
  std::vector<double> pad_;  ///< Minimum of the times to and from a waypoint.
  double each_ = 0.0;        ///< Further time per tour, such as its landing.
  double rests_ = 0.0, longest_ = 0.0;
};

}  // namespace

FleetBound fleet_bound(const FleetProblem& lower_bound, double makespan) {
  if (lower_bound.count() == 0) return {};
  const BestTimes times(lower_bound);
  double shared = unknown;
  FleetBound bound;
  for (std::size_t k = 1; k <= std::min(lower_bound.vehicles.size(), times.count()); ++k) {
    const double total_flight_time = times.compute_bound(k);
    if (k == 1) bound.total_flight_time = total_flight_time;
    shared = std::min(shared, total_flight_time / static_cast<double>(k));
  }
  const double collected = collection_bound(lower_bound, makespan);
  bound.makespan = std::min(makespan, std::max({times.longest(), shared, collected}));
  return bound;
}

}  // namespace skycap::flight
