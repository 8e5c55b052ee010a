#include "survey/photo/candidates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "geometry/parallel.h"
#include "geometry/random_numbers.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;

constexpr std::size_t directions_each = 3;

/// Returns the photo of a sample from the required direction, as close to distance d as the space
/// allows.
std::optional<geometry::View> make_photo(const Observer& observer, const PhotoSpace& space,
                                         const Vector3d& target, const Vector3d& towards) {
  constexpr int max_shortenings = 4;
  constexpr double shortening = 0.8, almost_all = 0.999;
  const double nearest = std::max(space.min_standoff, observer.rule().nearest_focus);
  double distance = observer.rule().view_distance;
  for (int i = 0; i <= max_shortenings && distance >= nearest; ++i, distance *= shortening) {
    const auto view = space.limits.make_target_view(target, towards, distance);
    if (!view || (space.is_free && !space.is_free(view->position))) continue;
    if (!observer.obstructions().is_clear(view->position, target, almost_all)) return std::nullopt;
    return view;
  }
  return std::nullopt;
}

std::array<Vector3d, directions_each> directions_at(const Vector3d& normal,
                                                    geometry::ShortRandomNumbers random) {
  constexpr double max_tilt = 0.7;
  const Vector3d first = geometry::any_orthogonal(normal), second = normal.cross(first);
  std::array<Vector3d, directions_each> directions{normal, normal, normal};
  for (std::size_t i = 1; i < directions_each; ++i) {
    const double angle = 2.0 * std::numbers::pi * random.uniform();
    const double tilt = max_tilt * random.uniform();
    directions[i] += tilt * (std::cos(angle) * first + std::sin(angle) * second);
    directions[i].normalize();
  }
  return directions;
}

/// Returns the samples in rounds. Each round contains one sample per cell.
std::vector<std::uint32_t> samples_in_rounds(const TargetSamples& samples, double cell) {
  using Cell = std::array<std::int64_t, 3>;
  std::vector<std::uint32_t> left, later, result;
  for (std::uint32_t i = 0; i < samples.size(); ++i) left.push_back(i);
  while (!left.empty()) {
    std::set<Cell> taken;
    later.clear();
    for (const std::uint32_t i : left) {
      const Vector3d at = samples.points[i].cast<double>() / cell;
      const Cell position{static_cast<std::int64_t>(std::floor(at.x())),
                          static_cast<std::int64_t>(std::floor(at.y())),
                          static_cast<std::int64_t>(std::floor(at.z()))};
      (taken.insert(position).second ? result : later).push_back(i);
    }
    left.swap(later);
  }
  return result;
}

}  // namespace

std::vector<geometry::View> candidate_photos(const Observer& observer, const PhotoSpace& space,
                                             const CandidateOptions& options) {
  const TargetSamples& samples = observer.samples();
  const std::vector<std::uint32_t> order =
      samples_in_rounds(samples, 0.35 * observer.rule().view_distance);
  constexpr std::size_t block = 256;
  std::vector<geometry::View> result;
  for (std::size_t first = 0; first < order.size() && result.size() < options.count;
       first += block) {
    const std::size_t count = std::min(block, order.size() - first);
    std::vector<std::array<std::optional<geometry::View>, directions_each>> found(count);
    geometry::parallel_for(count, options.threads, [&](std::size_t i) {
      const std::uint32_t sample = order[first + i];
      const auto directions = directions_at(samples.normals[sample].cast<double>().normalized(),
                                            geometry::ShortRandomNumbers(options.seed + sample));
      for (std::size_t k = 0; k < directions_each; ++k) {
        found[i][k] =
            make_photo(observer, space, samples.points[sample].cast<double>(), directions[k]);
      }
    });
    for (const auto& views : found) {
      for (const auto& view : views) {
        if (view && result.size() < options.count) result.push_back(*view);
      }
    }
  }
  return result;
}

std::vector<geometry::View> photos_between(const geometry::View& first,
                                           const geometry::View& second, double distance,
                                           const PhotoSpace& space) {
  constexpr int steps = 4;
  const Vector3d start = first.position + distance * first.direction;
  const Vector3d end = second.position + distance * second.direction;
  std::vector<geometry::View> result;
  for (int i = 1; i < steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const Vector3d direction = (1.0 - share) * first.direction + share * second.direction;
    constexpr double min_length = 0.1;  // Opposite directions have no direction between them.
    if (direction.norm() < min_length) continue;
    const Vector3d unit = direction.normalized();
    const geometry::View view{(1.0 - share) * start + share * end - distance * unit, unit};
    if (space.allows(view)) result.push_back(view);
  }
  return result;
}

}  // namespace skycap::survey::photo
