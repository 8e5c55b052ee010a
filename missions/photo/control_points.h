/// Surveyed ground control points, and the planned photos in which each is visible.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "survey/photo/photo_plan.h"

namespace skycap::missions::photo {

struct ControlPoint {
  std::string name;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Position in the mission frame [m].
};

inline constexpr const char* control_table_name = "control_points.csv";

/// Minimum number of photos for a reliable measurement of a control point.
inline constexpr std::size_t min_control_photos = 3;

/// Reads the points of a CSV file with the header `name,x,y,z` (mission frame [m]) or
/// `name,latitude,longitude,height` (degrees, height above the ellipsoid [m]). Throws
/// Error{bad_file} with the line number for invalid lines and duplicate names. Throws
/// Error{bad_file} for geodetic points without a site.
std::vector<ControlPoint> read_control_points(const std::string& text,
                                              const std::optional<flight::Site>& site);

/// Position of a point in a photo.
struct ControlObservation {
  std::uint32_t photo = 0;  ///< Index of the photo in the plan.
  Eigen::Vector2d pixel =
      Eigen::Vector2d::Zero();  ///< Pixel coordinates from the top-left corner of the image [px].
  double distance = 0.0;        ///< Distance from the camera [m].
};

/// Returns true if an obstacle is between two points. `to` is on the surface.
using Blocked = std::function<bool(const Eigen::Vector3d& from, const Eigen::Vector3d& to)>;

/// Returns the photos in which a point is visible, in the order of the plan. The point must project
/// into the image without a border of 1.5% on each side. Its distance must be at most twice the
/// view distance, and the line of sight must be free. Pixel coordinates include the distortion of
/// the camera.
std::vector<ControlObservation> find_observations(const ControlPoint& point,
                                                  const survey::photo::PhotoPlan& plan,
                                                  const Blocked& is_blocked);

/// Returns a CSV table with the columns point, photo, pixel_x, pixel_y, distance_m and gsd_m. The
/// photos of each point are sorted by distance.
std::string control_table(const std::vector<ControlPoint>& points,
                          const survey::photo::PhotoPlan& plan, const Blocked& is_blocked);

/// Returns a warning, without the word "Warning", for each point that is visible in fewer than
/// min_control_photos photos.
std::vector<std::string> control_warnings(const std::vector<ControlPoint>& points,
                                          const survey::photo::PhotoPlan& plan,
                                          const Blocked& is_blocked);

}  // namespace skycap::missions::photo
