#include "survey/fixed_views/view_set.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "geometry/error.h"
#include "geometry/random_numbers.h"
#include "geometry/requirement.h"

namespace skycap::survey::fixed_views {
namespace {

using Eigen::Vector3d;
using geometry::View;

constexpr double pi = std::numbers::pi;

Vector3d direction_at(double z, double azimuth) {
  const double level = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {level * std::cos(azimuth), level * std::sin(azimuth), z};
}

/// Draws a rotation, uniform over all rotations (Shoemake, Graphics Gems III, 1992).
Eigen::Quaterniond draw_rotation(geometry::RandomNumbers& random) {
  const double u = random.uniform();
  const double a = 2.0 * pi * random.uniform(), b = 2.0 * pi * random.uniform();
  const double small = std::sqrt(1.0 - u), large = std::sqrt(u);
  return {large * std::cos(b), small * std::sin(a), small * std::cos(a), large * std::sin(b)};
}

std::vector<Vector3d> make_lattice(std::size_t count, const SphereBand& band,
                                   geometry::RandomNumbers& random) {
  const double golden_angle = pi * (3.0 - std::sqrt(5.0));
  const double first = 2.0 * pi * random.uniform();
  std::vector<Vector3d> directions;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    directions.push_back(direction_at(band.max_z - (band.max_z - band.min_z) * share,
                                      first + golden_angle * static_cast<double>(i)));
  }
  if (!band.is_whole()) return directions;
  const Eigen::Matrix3d rotation = draw_rotation(random).toRotationMatrix();
  for (Vector3d& direction : directions) direction = (rotation * direction).normalized();
  return directions;
}

std::vector<Vector3d> make_rings(std::size_t count, const SphereBand& band, std::size_t rings,
                                 geometry::RandomNumbers& random) {
  const double first = 2.0 * pi * random.uniform();
  std::vector<Vector3d> directions;
  for (std::size_t ring = 0; ring < rings; ++ring) {
    const double share = (static_cast<double>(ring) + 0.5) / static_cast<double>(rings);
    const std::size_t views = (ring + 1) * count / rings - ring * count / rings;
    for (std::size_t i = 0; i < views; ++i) {
      const double turn = static_cast<double>(i) / static_cast<double>(views);
      directions.push_back(
          direction_at(band.max_z - (band.max_z - band.min_z) * share, first + 2.0 * pi * turn));
    }
  }
  return directions;
}

/// Moves a view of the centre outwards until it is admissible.
std::optional<View> find_admissible(const FixedViewsConfig& config, const Vector3d& direction) {
  constexpr int steps = 20;  // of a twentieth of the radius
  for (int step = 0; step <= steps; ++step) {
    const double distance = config.radius * (1.0 + static_cast<double>(step) / steps);
    const View view{config.centre + distance * direction, -direction};
    if (config.limits.allow(view) && (!config.admits || config.admits(view))) return view;
  }
  return std::nullopt;
}

/// Cost of the tour's edge between two entries of `order`; zero beyond the end. Entry 0 is the
/// start.
class TourEdges {
 public:
  TourEdges(const Vector3d& start, std::span<const Vector3d> positions)
      : start_(start), positions_(positions) {}

  double operator()(const std::vector<std::size_t>& tour, std::size_t a, std::size_t b) const {
    if (a >= tour.size() || b >= tour.size()) return 0.0;
    return distance(tour[a], tour[b]);
  }
  double distance(std::size_t a, std::size_t b) const { return (at(a) - at(b)).norm(); }

 private:
  const Vector3d& at(std::size_t node) const { return node == 0 ? start_ : positions_[node - 1]; }

  const Vector3d& start_;
  std::span<const Vector3d> positions_;
};

constexpr double min_gain = 1e-9;  // prevents endless cycles caused by rounding errors [m]

/// Reverses one section of the tour if this shortens it.
bool improve_by_reversal(const TourEdges& edge, std::vector<std::size_t>& tour) {
  for (std::size_t i = 1; i + 1 < tour.size(); ++i) {
    for (std::size_t j = i + 1; j < tour.size(); ++j) {
      const double change =
          edge(tour, i - 1, j) + edge(tour, i, j + 1) - edge(tour, i - 1, i) - edge(tour, j, j + 1);
      if (change >= -min_gain) continue;
      std::reverse(tour.begin() + static_cast<std::ptrdiff_t>(i),
                   tour.begin() + static_cast<std::ptrdiff_t>(j) + 1);
      return true;
    }
  }
  return false;
}

/// Moves one chain of up to three entries elsewhere, in either direction, if this shortens the
/// tour.
bool improve_by_move(const TourEdges& edge, std::vector<std::size_t>& tour) {
  for (std::size_t length = 1; length <= 3; ++length) {
    for (std::size_t i = 1; i + length <= tour.size(); ++i) {
      const std::size_t end = i + length;  // behind the chain
      const double removed = edge(tour, i - 1, i) + edge(tour, end - 1, end) -
                             (end < tour.size() ? edge(tour, i - 1, end) : 0.0);
      std::vector<std::size_t> chain(tour.begin() + static_cast<std::ptrdiff_t>(i),
                                     tour.begin() + static_cast<std::ptrdiff_t>(end));
      std::vector<std::size_t> rest = tour;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i),
                 rest.begin() + static_cast<std::ptrdiff_t>(end));
      for (std::size_t after = 0; after < rest.size(); ++after) {
        for (const bool is_reversed : {false, true}) {
          const std::size_t front = is_reversed ? chain.back() : chain.front();
          const std::size_t back = is_reversed ? chain.front() : chain.back();
          double added = edge.distance(rest[after], front);
          if (after + 1 < rest.size()) {
            added += edge.distance(back, rest[after + 1]) - edge(rest, after, after + 1);
          }
          if (added - removed >= -min_gain) continue;
          if (is_reversed) std::ranges::reverse(chain);
          rest.insert(rest.begin() + static_cast<std::ptrdiff_t>(after) + 1, chain.begin(),
                      chain.end());
          tour = std::move(rest);
          return true;
        }
      }
    }
  }
  return false;
}

}  // namespace

void FixedViewsConfig::validate() const {
  require(settings.views >= 1, "uniform.views", static_cast<double>(settings.views), "at least 1");
  require(settings.rings >= 1, "uniform.rings", static_cast<double>(settings.rings), "at least 1");
  require(std::isfinite(spacing) && spacing >= 0.0, "spacing", spacing,
          "zero or a positive number of metres");
  require(std::isfinite(radius) && radius > 0.0, "sphere_radius", radius,
          "a positive number of metres");
}

SphereBand compute_band(const ViewLimits& limits, const Vector3d& centre, double radius) {
  // A view of the centre from the height z of the unit sphere has the pitch -asin(z).
  SphereBand band{-std::sin(limits.max_pitch), -std::sin(limits.min_pitch)};
  if (limits.min_height) {
    band.min_z = std::max(band.min_z, (*limits.min_height - centre.z()) / radius);
  }
  if (limits.max_height) {
    band.max_z = std::min(band.max_z, (*limits.max_height - centre.z()) / radius);
  }
  band.min_z = std::max(band.min_z, -1.0);
  band.max_z = std::min(band.max_z, 1.0);
  if (band.min_z > band.max_z) {
    throw Error(ErrorKind::bad_config,
                "no part of the sphere of views complies with the height and pitch limits; lower "
                "limits.ground_clearance or raise volumetric.sphere_radius");
  }
  return band;
}

std::vector<Vector3d> make_directions(ViewSet set, std::size_t count, const SphereBand& band,
                                      std::size_t rings, std::uint64_t seed) {
  geometry::RandomNumbers random(seed);
  if (set == ViewSet::fibonacci) return make_lattice(count, band, random);
  if (set == ViewSet::rings) return make_rings(count, band, rings, random);
  std::vector<Vector3d> directions;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = random.between(band.min_z, band.max_z);
    directions.push_back(direction_at(z, 2.0 * pi * random.uniform()));
  }
  return directions;
}

std::vector<View> make_view_set(const FixedViewsConfig& config) {
  constexpr std::size_t max_factor = 40;
  const std::size_t wanted = config.settings.views - 1;
  const SphereBand band = compute_band(config.limits, config.centre, config.radius);
  std::vector<View> views;
  for (std::size_t count = wanted; wanted > 0 && count <= max_factor * wanted;
       count += wanted - views.size()) {
    views.clear();
    for (const Vector3d& direction :
         make_directions(config.settings.set, count, band, config.settings.rings, config.seed)) {
      if (const auto view = find_admissible(config, direction)) views.push_back(*view);
    }
    if (views.size() >= wanted) break;
  }
  // Surplus views are removed evenly, because directions are in order of height.
  while (views.size() > wanted) {
    const std::size_t surplus = views.size() - wanted;
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(views.size() / (surplus + 1)));
  }
  return views;
}

std::vector<std::size_t> compute_tour(const Vector3d& start, std::span<const Vector3d> positions) {
  const TourEdges edge(start, positions);
  std::vector<std::size_t> tour(positions.size() + 1);  // node 0 is the start
  std::iota(tour.begin(), tour.end(), std::size_t{0});
  for (std::size_t i = 0; i + 2 < tour.size(); ++i) {
    const auto nearest =
        std::ranges::min_element(tour.begin() + static_cast<std::ptrdiff_t>(i) + 1, tour.end(), {},
                                 [&](std::size_t node) { return edge.distance(tour[i], node); });
    std::swap(tour[i + 1], *nearest);
  }
  while (improve_by_reversal(edge, tour) || improve_by_move(edge, tour)) {
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 1; i < tour.size(); ++i) order.push_back(tour[i] - 1);
  return order;
}

std::vector<std::size_t> compute_spread(const Vector3d& start,
                                        std::span<const Vector3d> positions) {
  std::vector<double> distances;
  for (const Vector3d& position : positions) distances.push_back((position - start).norm());
  std::vector<std::size_t> order;
  while (order.size() < positions.size()) {
    const auto next =
        static_cast<std::size_t>(std::ranges::max_element(distances) - distances.begin());
    order.push_back(next);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      distances[i] = std::min(distances[i], (positions[i] - positions[next]).norm());
    }
    for (const std::size_t taken : order) distances[taken] = -1.0;
  }
  return order;
}

double path_length(const Vector3d& start, std::span<const Vector3d> positions,
                   std::span<const std::size_t> order) {
  double length = 0.0;
  const Vector3d* from = &start;
  for (const std::size_t i : order) {
    length += (positions[i] - *from).norm();
    from = &positions[i];
  }
  return length;
}

}  // namespace skycap::survey::fixed_views
