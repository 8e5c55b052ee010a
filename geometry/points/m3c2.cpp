#include "geometry/points/m3c2.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/points/point_grid.h"
#include "geometry/points/principal_axes.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

PointGrid make_grid(std::span<const Vector3f> points, double cell_size) {
  PointGrid grid(cell_size);
  for (const Vector3f& point : points) grid.insert(point);
  return grid;
}

/// Division of a cylinder into segments, each of which fits into a ball.
struct Segments {
  explicit Segments(const M3c2Options& options)
      : radius(options.cylinder_diameter / 2.0),
        half_length(options.max_distance),
        count(std::max(1.0, std::ceil(half_length / radius))),
        half_segment(half_length / count),
        // A margin for the single precision of the query.
        ball_radius(1.001 * std::hypot(radius, half_segment)) {}

  double radius, half_length, count, half_segment, ball_radius;
};

struct Projections {
  std::size_t points = 0;
  double mean = 0.0, deviation = 0.0;
};

/// Returns the statistics of the projections of the points of a cylinder onto its axis.
Projections project(const PointGrid& grid, const Vector3d& core, const Vector3d& axis,
                    const Segments& segments, std::vector<Vector3f>& found,
                    std::vector<double>& along) {
  along.clear();
  for (double segment = 0.0; segment < segments.count; ++segment) {
    const double middle = (2.0 * segment + 1.0 - segments.count) * segments.half_segment;
    found.clear();
    grid.find_points_within((core + middle * axis).cast<float>(), segments.ball_radius, found);
    for (const Vector3f& point : found) {
      const Vector3d offset = point.cast<double>() - core;
      const double height = offset.dot(axis);
      const double steps =
          std::floor((height + segments.half_length) / (2.0 * segments.half_segment));
      const bool is_last = segment + 1.0 == segments.count && height == segments.half_length;
      if (steps != segment && !is_last) continue;
      if ((offset - height * axis).squaredNorm() > segments.radius * segments.radius) continue;
      along.push_back(height);
    }
  }
  Projections result{along.size()};
  if (along.empty()) return result;
  for (const double height : along) result.mean += height;
  const auto count = static_cast<double>(along.size());
  result.mean /= count;
  double squares = 0.0;
  for (const double height : along) squares += (height - result.mean) * (height - result.mean);
  if (along.size() > 1) result.deviation = std::sqrt(squares / (count - 1.0));
  return result;
}

}  // namespace

void M3c2Options::validate() const {
  const auto require = [](bool holds, const std::string& what, double value) {
    if (!holds) {
      throw Error(ErrorKind::bad_config, what + " is " + std::to_string(value) +
                                             " m; it must be positive and at most 1000 m");
    }
  };
  const auto is_length = [](double value) { return value > 0.0 && value <= 1000.0; };
  require(is_length(normal_scale), "normal_scale", normal_scale);
  require(is_length(cylinder_diameter), "cylinder_diameter", cylinder_diameter);
  require(is_length(max_distance), "max_distance", max_distance);
  constexpr double max_diameters = 500.0;
  if (max_distance > max_diameters * cylinder_diameter) {
    throw Error(ErrorKind::bad_config,
                "max_distance (" + std::to_string(max_distance) +
                    " m) is more than 500 times the " + "cylinder diameter (" +
                    std::to_string(cylinder_diameter) + " m); lower it or raise the diameter");
  }
  require(registration_error >= 0.0 && registration_error <= 1000.0, "registration_error",
          registration_error);
}

std::vector<M3c2Distance> m3c2_distances(std::span<const Vector3f> cores,
                                         std::span<const Vector3f> first,
                                         std::span<const Vector3f> second, const Vector3d& centre,
                                         const M3c2Options& options, unsigned threads) {
  options.validate();
  const Segments segments(options);
  const PointGrid cloud1 = make_grid(first, segments.ball_radius),
                  cloud2 = make_grid(second, segments.ball_radius),
                  neighbours = make_grid(first, options.normal_scale / 2.0);
  std::vector<M3c2Distance> distances(cores.size());
  constexpr std::size_t block = 64, min_neighbours = 3;
  parallel_for((cores.size() + block - 1) / block, threads, [&](std::size_t number) {
    std::vector<Vector3f> found;
    std::vector<double> along;
    const std::size_t end = std::min(cores.size(), (number + 1) * block);
    for (std::size_t i = number * block; i < end; ++i) {
      found.clear();
      neighbours.find_points_within(cores[i], options.normal_scale / 2.0, found);
      if (found.size() < min_neighbours) continue;
      M3c2Distance& result = distances[i];
      const Vector3d core = cores[i].cast<double>();
      const Vector3d normal = principal_axes(found).axes.col(0);
      result.normal = normal.dot(core - centre) < 0.0 ? -normal : normal;
      const Projections one = project(cloud1, core, result.normal, segments, found, along);
      const Projections two = project(cloud2, core, result.normal, segments, found, along);
      result.points1 = one.points;
      result.points2 = two.points;
      if (std::min(one.points, two.points) < std::max<std::size_t>(options.min_points, 1)) continue;
      result.deviation1 = one.deviation;
      result.deviation2 = two.deviation;
      result.distance = two.mean - one.mean;
      const double variance = one.deviation * one.deviation / static_cast<double>(one.points) +
                              two.deviation * two.deviation / static_cast<double>(two.points);
      constexpr double confidence_95 = 1.96;
      result.level_of_detection =
          confidence_95 * (std::sqrt(variance) + options.registration_error);
    }
  });
  return distances;
}

}  // namespace skycap::geometry
