#include "missions/online/live/pose_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angle.h"
#include "geometry/points/registration.h"

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using geometry::Registration;
using geometry::RigidDirection;
using geometry::SurfacePatch;

// Maximum number of points of a scan that are combined into patches.
constexpr std::size_t max_patch_points = 100'000;
constexpr std::size_t max_patches = 1500;
constexpr std::size_t min_matches = 50;
// Deviations above this number of standard deviations are significant.
constexpr double sigmas = 5.0;

struct Patches {
  std::vector<SurfacePatch> patches;
  std::size_t level = 0;  // Index of the map.
};

/// Returns true if most patches are much flatter than wide despite noise.
bool are_flat(const std::vector<SurfacePatch>& patches, double radius) {
  constexpr double flat = 0.15;
  const auto is_flat = [&](const SurfacePatch& patch) { return patch.deviation <= flat * radius; };
  return 2 * std::ranges::count_if(patches, is_flat) >= std::ssize(patches);
}

/// Returns the patches of the scan with the smallest radius at which most are flat. Returns no
/// patches if no radius suffices.
Patches select_patches(const geometry::ScanSpan& scan, std::span<const geometry::SurfaceMap> maps) {
  for (std::size_t level = 0; level < maps.size(); ++level) {
    const double radius = maps[level].radius();
    geometry::ScanPatches all = geometry::scan_patches(scan, radius, max_patch_points, max_patches);
    const bool is_surface = 3 * all.patches.size() >= all.tried;
    if (is_surface && are_flat(all.patches, radius)) return {std::move(all.patches), level};
  }
  return {};
}

/// Returns the standard deviation that a pose's covariance permits along a direction.
double deviation_along(const RigidDirection& direction, const Registration& found,
                       const Vector3d& sensor, const PoseCovariance& covariance) {
  // For a pose error t, w about the sensor s: d . (t + w x (m - s)) + (L w) . (L turn).
  PoseCovariance::Vector along;
  along << direction.displacement, (found.middle - sensor).cross(direction.displacement) +
                                       found.size * found.size * direction.turn;
  return covariance.deviation(along);
}

/// Returns true if the errors of the surfaces and of the pose explain the motion.
bool is_explained(const Registration& found, const Vector3d& sensor,
                  const PoseCovariance& covariance, double radius) {
  // Errors that patches share due to curvature, edges and uneven noise do not average out. They
  // shift the scan more in directions that the surface constrains less.
  const double common = std::hypot(0.02 * radius, 0.2 * found.deviation);
  const double own = 1.5 * found.error / std::sqrt(static_cast<double>(found.matches));
  return std::ranges::all_of(found.directions, [&](const RigidDirection& direction) {
    if (!direction.is_observable()) return true;
    const double surfaces = std::hypot(common, own) / std::sqrt(direction.information);
    const double pose = deviation_along(direction, found, sensor, covariance);
    return std::abs(direction.amount) <= sigmas * std::hypot(surfaces, pose);
  });
}

/// Returns true if the pose's covariance permits the whole correction.
bool is_allowed(const Isometry3d& correction, const Vector3d& sensor,
                const PoseCovariance& covariance, double radius) {
  const Eigen::AngleAxisd turn(correction.linear());
  PoseCovariance::Vector error;
  error << correction * sensor - sensor, turn.angle() * turn.axis();
  return covariance.distance(error, 0.1 * radius, 0.1 * geometry::radians_per_degree) <= sigmas;
}

}  // namespace

geometry::Scan corrected(geometry::Scan scan, const Isometry3d& correction) {
  for (Eigen::Vector3f& point : scan.points) {
    point = (correction * point.cast<double>()).cast<float>();
  }
  scan.world_from_sensor = correction * scan.world_from_sensor;
  return scan;
}

PoseCheck::PoseCheck(double radius, bool registers)
    : registers_(registers),
      maps_{geometry::SurfaceMap(radius), geometry::SurfaceMap(2.0 * radius),
            geometry::SurfaceMap(4.0 * radius), geometry::SurfaceMap(8.0 * radius)} {}

void PoseCheck::remember(const geometry::ScanSpan& scan, std::span<const Eigen::Vector3f> kept) {
  constexpr std::size_t max_images = 16;
  for (geometry::SurfaceMap& map : maps_) map.add(kept, scan.sensor_position());
  last_.emplace_back(scan);
  if (last_.size() > max_images) last_.pop_front();
}

PoseFinding PoseCheck::find(const geometry::ScanSpan& scan, const PoseCovariance& covariance) {
  PoseFinding finding;
  if (last_.empty()) return finding;
  const Patches patches = select_patches(scan, maps_);
  geometry::SurfaceMap& map = maps_[patches.level];
  const double reach =
      std::min(4.0 * map.radius() + sigmas * covariance.position(), 8.0 * map.radius());
  const Registration found = geometry::register_scan(patches.patches, map, reach, min_matches);
  const Vector3d sensor = scan.sensor_position();
  finding.matches = found.matches;
  finding.error = found.first_error;
  finding.is_checked = found.matches >= min_matches;
  constexpr double much = 0.1;
  finding.seen_through = seen_through(scan, patches.patches, covariance, map);
  finding.is_wrong = finding.seen_through > much;
  if (!finding.is_checked) return finding;
  finding.shift = (found.correction * sensor - sensor).norm();
  finding.turn = Eigen::AngleAxisd(found.correction.linear()).angle();
  finding.unobservable =
      static_cast<int>(std::ranges::count_if(found.directions, [](const RigidDirection& direction) {
        return !direction.is_observable();
      }));
  // If the surface hardly constrains a motion, new surface can be matched with other surface that
  // pulls the scan along. The surface that fits at the given pose then fits less.
  const bool is_within_errors = is_explained(found, sensor, covariance, map.radius());
  const bool is_improved = found.misfit < found.first_misfit;
  finding.is_wrong = finding.is_wrong || (is_improved && !is_within_errors);
  if (registers_ && is_within_errors && !finding.is_wrong &&
      is_allowed(found.correction, sensor, covariance, map.radius())) {
    finding.correction = found.correction;
  }
  return finding;
}

double PoseCheck::seen_through(const geometry::ScanSpan& scan,
                               const std::vector<SurfacePatch>& patches,
                               const PoseCovariance& covariance,
                               const geometry::SurfaceMap& map) const {
  constexpr std::size_t max_tests = 20'000, min_tests = 50;
  std::size_t there = 0, through = 0;
  const Vector3d sensor = scan.sensor_position();
  const double along = covariance.position(), about = covariance.angle();
  const auto count_visibility = [&](const RangeImage& image, const Vector3d& point) {
    const double range = (point - sensor).norm();
    const double tolerance = 2.0 * map.radius() + 0.02 * range + sigmas * (along + about * range);
    const Visibility visibility = image.visibility(point, tolerance);
    there += visibility == Visibility::there ? 1 : 0;
    through += visibility == Visibility::through ? 1 : 0;
  };
  const RangeImage image(scan);
  const geometry::PointGrid& known = map.spread_points();
  const std::size_t stride = std::max<std::size_t>(1, known.size() / max_tests);
  for (std::size_t i = 0; i < known.size(); i += stride) {
    count_visibility(image, known.point(static_cast<std::uint32_t>(i)).cast<double>());
  }
  for (const SurfacePatch& patch : patches) {
    for (const RangeImage& earlier : last_) count_visibility(earlier, patch.mean);
  }
  if (there + through < min_tests) return 0.0;
  return static_cast<double>(through) / static_cast<double>(there + through);
}

}  // namespace skycap::missions::online
