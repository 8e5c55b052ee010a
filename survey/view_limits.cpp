#include "survey/view_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "geometry/error.h"

namespace skycap::survey {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Tolerance of rounding errors in the sine and cosine of a pitch.
constexpr double angle_tolerance = 1e-6;

void require_limit(bool holds, const std::string& what) {
  if (!holds) throw Error(ErrorKind::bad_config, what);
}

}  // namespace

void ViewLimits::validate() const {
  require_limit(
      min_standoff >= 0.0 && std::isfinite(min_standoff),
      "stand_off is " + std::to_string(min_standoff) + "; it must be zero or more metres");
  require_limit(
      !min_height || !max_height || *min_height < *max_height,
      "max_height must be greater than the minimum height; otherwise no airspace remains");
  require_limit(
      min_pitch < max_pitch && std::abs(min_pitch) < 1.5708 && std::abs(max_pitch) < 1.5708,
      "max_pitch must be above the minimum pitch; both must be between -pi/2 and pi/2");
  require_limit(geofence.empty() || geofence.size() >= 3,
                "geofence has " + std::to_string(geofence.size()) +
                    " corners; at least three corners are required");
  for (const geometry::Prism& prism : no_fly) {
    require_limit(prism.footprint.size() >= 3, "a no_fly volume has " +
                                                   std::to_string(prism.footprint.size()) +
                                                   " corners; at least three corners are required");
    require_limit(prism.floor < prism.ceiling,
                  "the floor of a no_fly volume must be below its ceiling");
  }
}

bool ViewLimits::allow(const geometry::View& view) const {
  const double height = view.position.z();
  if ((min_height && height < *min_height) || (max_height && height > *max_height)) {
    return false;
  }
  const double pitch = std::asin(std::clamp(view.direction.z(), -1.0, 1.0));
  if (pitch < min_pitch - angle_tolerance || pitch > max_pitch + angle_tolerance) return false;
  if (min_height_at && height < min_height_at(view.position.head<2>())) return false;
  if (!geofence.empty() && !geometry::contains(geofence, view.position.head<2>())) return false;
  return std::ranges::none_of(no_fly, [&](const geometry::Prism& prism) {
    return geometry::contains(prism, view.position);
  });
}

std::optional<geometry::View> ViewLimits::turned_view(const Vector3d& target,
                                                      const Vector3d& towards_view, double distance,
                                                      const std::optional<double>& min) const {
  // Elevation of the view as seen from the target; equal to the downward pitch of the view.
  double min_elevation = -max_pitch, max_elevation = -min_pitch;
  // Margin inside the limits, so that rounding errors do not violate them.
  const double margin = 1e-6 * distance;
  if (min) {
    const double sine = (*min + margin - target.z()) / distance;
    if (sine > 1.0) return std::nullopt;
    min_elevation = std::max(min_elevation, std::asin(std::max(sine, -1.0)));
  }
  if (max_height) {
    const double sine = (*max_height - margin - target.z()) / distance;
    if (sine < -1.0) return std::nullopt;
    max_elevation = std::min(max_elevation, std::asin(std::min(sine, 1.0)));
  }
  if (min_elevation > max_elevation) return std::nullopt;

  const double target_elevation = std::asin(std::clamp(towards_view.z(), -1.0, 1.0));
  const double elevation = std::clamp(target_elevation, min_elevation, max_elevation);
  Vector3d towards = towards_view;
  if (elevation != target_elevation) {
    const Vector2d level = towards_view.head<2>();
    const Vector2d azimuth =
        level.norm() > 1e-9 ? Vector2d(level.normalized()) : Vector2d(1.0, 0.0);
    towards << std::cos(elevation) * azimuth, std::sin(elevation);
  }
  return geometry::View{target + distance * towards, -towards};
}

std::optional<geometry::View> ViewLimits::make_target_view(const Vector3d& target,
                                                           const Vector3d& towards_view,
                                                           double distance) const {
  std::optional<geometry::View> view = turned_view(target, towards_view, distance, min_height);
  // Raising a view over a slope changes the ground below it. A few iterations are sufficient.
  constexpr int max_raises = 4;
  for (int i = 0; min_height_at && view && i < max_raises; ++i) {
    const double min = min_height_at(view->position.head<2>());
    if (view->position.z() >= min) break;
    view = turned_view(target, towards_view, distance, min);
  }
  return view && allow(*view) ? view : std::nullopt;
}

}  // namespace skycap::survey
