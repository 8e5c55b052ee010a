/// Ground control points of a surveyor, and the planned photos that see each.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "survey/photo/photo_plan.h"

namespace skycap::missions::photos {

struct ControlPoint {
  std::string name;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< mission frame
};

/// Fewer photos than this do not measure a control point reliably.
inline constexpr std::size_t min_control_photos = 3;

/// Points of a CSV file with the header `name,x,y,z` (mission frame [m]) or
/// `name,latitude,longitude,height` (degrees, above the ellipsoid [m]). Throws Error{bad_file} with
/// the line that is wrong, for a name that is listed twice, and for geodetic points without a site.
std::vector<ControlPoint> read_control_points(const std::string& text,
                                              const std::optional<flight::Site>& site);

/// Where a photo shows a point.
struct ControlObservation {
  std::uint32_t photo = 0;                          ///< index in the plan
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< from the image's top left corner [px]
  double distance = 0.0;                            ///< from the camera [m]
};

/// Whether something is between two points; the second is on the surface.
using Blocked = std::function<bool(const Eigen::Vector3d& from, const Eigen::Vector3d& to)>;

/// The photos that show a point, in the order of the plan: in the image less a border of 1.5% on
/// each side, at most twice the view distance away, and not hidden. Pixels include the distortion
/// of the camera.
std::vector<ControlObservation> find_observations(const ControlPoint& point,
                                                  const survey::photo::PhotoPlan& plan,
                                                  const Blocked& is_blocked);

/// CSV: point, photo, pixel_x, pixel_y, distance_m, gsd_m; nearest photos first within a point.
std::string control_table(const std::vector<ControlPoint>& points,
                          const survey::photo::PhotoPlan& plan, const Blocked& is_blocked);

/// A line for each point that fewer than min_control_photos show, for the user.
std::vector<std::string> control_warnings(const std::vector<ControlPoint>& points,
                                          const survey::photo::PhotoPlan& plan,
                                          const Blocked& is_blocked);

}  // namespace skycap::missions::photos
