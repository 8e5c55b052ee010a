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
constexpr std::uint64_t fleet_stream = 4ULL << 32, sortie_stream = 5ULL << 32;

struct Track {
  std::size_t vehicle = 0;
  std::ptrdiff_t begin = 0;  ///< In steps.
  std::vector<Vector3d> positions;
};

std::vector<Track> compute_tracks(std::span<const FleetFlight> flights, const SeparationRule& rule,
                                  const FlyTestOptions& options, std::size_t number) {
  geometry::RandomNumbers random(options.seed, fleet_stream + number);
  const double from = random.between(0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector2d wind =
      random.between(0.0, options.wind_speed) * Eigen::Vector2d(std::sin(from), std::cos(from));
  std::vector<Track> tracks;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const double late = random.between(-rule.tolerance, rule.tolerance);
    const FlightDraw draw{.seed = options.seed,
                          .number = sortie_stream + number * flights.size() + i,
                          .wind = wind,
                          .position_error = options.position_error,
                          .return_time = {}};
    tracks.push_back({flights[i].vehicle, std::lround((flights[i].start + late) / simulation_step),
                      compute_track(flights[i].mission, draw)});
  }
  return tracks;
}

/// Returns the minimum distance while both are in the air [m].
double min_distance(const Track& one, const Track& other) {
  const auto end = [](const Track& track) {
    return track.begin + static_cast<std::ptrdiff_t>(track.positions.size());
  };
  double min_separation = std::numeric_limits<double>::infinity();
  const std::ptrdiff_t last = std::min(end(one), end(other));
  for (std::ptrdiff_t k = std::max(one.begin, other.begin); k < last; ++k) {
    const Vector3d& here = one.positions[static_cast<std::size_t>(k - one.begin)];
    const Vector3d& there = other.positions[static_cast<std::size_t>(k - other.begin)];
    min_separation = std::min(min_separation, (here - there).squaredNorm());
  }
  return std::sqrt(min_separation);
}

double min_distance(const std::vector<Track>& tracks) {
  double min_separation = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (std::size_t j = i + 1; j < tracks.size(); ++j) {
      if (tracks[i].vehicle == tracks[j].vehicle) continue;
      min_separation = std::min(min_separation, min_distance(tracks[i], tracks[j]));
    }
  }
  return min_separation;
}

}  // namespace

FleetFlightTest fly_fleet(std::span<const FleetFlight> flights, const SeparationRule& rule,
                          double strays, const FlyTestOptions& options) {
  constexpr double not_simulated = -1.0;
  std::vector<double> min_separation(options.flights, not_simulated);
  geometry::parallel_for(options.flights, options.threads, [&](std::size_t i) {
    if (options.stop.stop_requested()) return;
    min_separation[i] =
        std::min(options.up_to, min_distance(compute_tracks(flights, rule, options, i)));
  });
  std::erase(min_separation, not_simulated);
  std::ranges::sort(min_separation);
  FleetFlightTest test{.simulated = min_separation.size(),
                       .limit = std::max(0.0, rule.distance - strays)};
  if (min_separation.empty()) return test;
  test.nearer = static_cast<std::size_t>(std::ranges::lower_bound(min_separation, test.limit) -
                                         min_separation.begin());
  test.min_separation = min_separation.front();
  test.median_min_separation = min_separation[min_separation.size() / 2];
  return test;
}

}  // namespace skycap::flight
