#include "flight/fleet/fleet_flights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry/parallel.h"
#include "geometry/random_numbers.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Random number streams separate from those of single flights.
constexpr std::uint64_t stream_of_fleets = 4ULL << 32, stream_of_sorties = 5ULL << 32;

struct Track {
  std::size_t vehicle = 0;
  std::ptrdiff_t begin = 0;  ///< In steps.
  std::vector<Vector3d> places;
};

std::vector<Track> tracks_of(std::span<const FleetFlight> flights, const SeparationRule& rule,
                             const FlyTestOptions& options, std::size_t number) {
  geometry::RandomNumbers random(options.seed, stream_of_fleets + number);
  const double from = random.between(0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector2d wind =
      random.between(0.0, options.wind_speed) * Eigen::Vector2d(std::sin(from), std::cos(from));
  std::vector<Track> tracks;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const double late = random.between(-rule.tolerance, rule.tolerance);
    const FlightDraw draw{.seed = options.seed,
                          .number = stream_of_sorties + number * flights.size() + i,
                          .wind = wind,
                          .position_error = options.position_error,
                          .called_home = {}};
    tracks.push_back({flights[i].vehicle, std::lround((flights[i].start + late) / simulation_step),
                      track_of(flights[i].mission, draw)});
  }
  return tracks;
}

/// Returns the minimum distance while both are in the air [m].
double least_distance(const Track& one, const Track& other) {
  const auto end = [](const Track& track) {
    return track.begin + static_cast<std::ptrdiff_t>(track.places.size());
  };
  double least = std::numeric_limits<double>::infinity();
  const std::ptrdiff_t last = std::min(end(one), end(other));
  for (std::ptrdiff_t k = std::max(one.begin, other.begin); k < last; ++k) {
    const Vector3d& here = one.places[static_cast<std::size_t>(k - one.begin)];
    const Vector3d& there = other.places[static_cast<std::size_t>(k - other.begin)];
    least = std::min(least, (here - there).squaredNorm());
  }
  return std::sqrt(least);
}

double least_distance(const std::vector<Track>& tracks) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (std::size_t j = i + 1; j < tracks.size(); ++j) {
      if (tracks[i].vehicle == tracks[j].vehicle) continue;
      least = std::min(least, least_distance(tracks[i], tracks[j]));
    }
  }
  return least;
}

}  // namespace

FleetFlightTest fly_fleet(std::span<const FleetFlight> flights, const SeparationRule& rule,
                          double strays, const FlyTestOptions& options) {
  constexpr double not_flown = -1.0;
  std::vector<double> least(options.flights, not_flown);
  geometry::parallel_for(options.flights, options.threads, [&](std::size_t i) {
    if (options.stop.stop_requested()) return;
    least[i] = std::min(options.up_to, least_distance(tracks_of(flights, rule, options, i)));
  });
  std::erase(least, not_flown);
  std::ranges::sort(least);
  FleetFlightTest test{.flown = least.size(), .limit = std::max(0.0, rule.distance - strays)};
  if (least.empty()) return test;
  test.nearer =
      static_cast<std::size_t>(std::ranges::lower_bound(least, test.limit) - least.begin());
  test.least = least.front();
  test.least_median = least[least.size() / 2];
  return test;
}

}  // namespace skycap::flight
