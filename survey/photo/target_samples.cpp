#include "survey/photo/target_samples.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/parallel.h"
#include "geometry/pose/pose.h"
#include "geometry/random_numbers.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;

constexpr int directions = 64;
constexpr int min_free = 7;  // At least 10% of 64.

/// Returns directions in the upper hemisphere, evenly distributed on a Fibonacci spiral.
std::array<Vector3d, directions> hemisphere() {
  std::array<Vector3d, directions> result;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < directions; ++i) {
    const double z = (i + 0.5) / directions;
    const double level = std::sqrt(1.0 - z * z);
    result[static_cast<std::size_t>(i)] = {level * std::cos(golden * i),
                                           level * std::sin(golden * i), z};
  }
  return result;
}

class Exposure {
 public:
  Exposure(const geometry::SightLines& obstructions, const SampleOptions& options)
      : obstructions_(obstructions), options_(options), hemisphere_(hemisphere()) {}

  /// Returns the number of free directions on the side of a surface towards `normal`.
  int free_directions(const Vector3d& point, const Vector3d& normal) const {
    const Vector3d first = geometry::any_orthogonal(normal), second = normal.cross(first);
    const double ground = options_.ground ? options_.ground(point.head<2>()) : 0.0;
    int free = 0;
    for (const Vector3d& local : hemisphere_) {
      const Vector3d direction = local.x() * first + local.y() * second + local.z() * normal;
      double length = options_.free_length;
      if (options_.ground && direction.z() < 0.0) {
        const double to_ground = (point.z() - ground) / -direction.z();
        if (to_ground < length && to_ground <= options_.min_standoff) continue;
        length = std::min(length, to_ground);
      }
      // Start off the surface, so that it does not obstruct itself.
      const Vector3d from = point + 1e-4 * normal;
      free += obstructions_.first_hit(from, direction, length) ? 0 : 1;
    }
    return free;
  }

 private:
  const geometry::SightLines& obstructions_;
  const SampleOptions& options_;
  std::array<Vector3d, directions> hemisphere_;
};

}  // namespace

TargetSamples sample_target(const geometry::Mesh& target, const geometry::SightLines& obstructions,
                            const SampleOptions& options) {
  geometry::SurfaceSamples drawn = geometry::sample_surface(target, options.count, options.seed);
  const std::size_t count = drawn.points.size();
  std::vector<char> is_exposed(count, 0);
  const Exposure exposure(obstructions, options);
  constexpr std::size_t block = 64;
  geometry::parallel_for((count + block - 1) / block, options.threads, [&](std::size_t number) {
    for (std::size_t i = number * block; i < std::min(count, (number + 1) * block); ++i) {
      const Vector3d point = drawn.points[i].cast<double>();
      if (options.ground && point.z() < options.ground(point.head<2>())) continue;
      const Vector3d normal = drawn.normals[i].cast<double>().normalized();
      const int outside = exposure.free_directions(point, normal);
      const int inside = exposure.free_directions(point, -normal);
      if (inside > outside) drawn.normals[i] = -drawn.normals[i];
      is_exposed[i] = std::max(inside, outside) >= min_free ? 1 : 0;
    }
  });
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (is_exposed[i] != 0) order.push_back(i);
  }
  geometry::RandomNumbers random(options.seed, 1);
  for (std::size_t i = order.size(); i > 1; --i) {
    std::swap(order[i - 1], order[random() % i]);
  }
  TargetSamples samples;
  for (const std::uint32_t i : order) {
    samples.points.push_back(drawn.points[i]);
    samples.normals.push_back(drawn.normals[i]);
    samples.triangles.push_back(drawn.triangles[i]);
  }
  samples.area_each = count > 0 ? surface_area(target) / static_cast<double>(count) : 0.0;
  samples.inner = count - order.size();
  return samples;
}

}  // namespace skycap::survey::photo
