/// Pinhole depth camera: projection of points and measurement rays.
///
/// Camera frame: x right, y down, z along the optical axis [m]. Pixel (0, 0) is the centre of the
/// top-left pixel. Pixels need not be square. Source of the projection: Hartley & Zisserman,
/// Multiple View Geometry, 2nd ed., Eq. (6.1), cited as "HZ (6.1)" in the code.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace skycap::geometry {

/// Camera settings of a mission file. The defaults describe the depth camera of the SEE++
/// experiments: an Intel RealSense D435 with the field of view of its colour image (paper §IV-A).
struct CameraConfig {
  int width = 848;                          ///< [px]
  int height = 480;                         ///< [px]
  double horizontal_fov = 1.2112584975906;  ///< full angle [rad], in (0, pi); default: 69.4 degrees
  double vertical_fov = 0.7417649320975;    ///< full angle [rad], in (0, pi); default: 42.5 degrees
  double min_range = 0.0;                   ///< minimum measurable depth along z [m]
  double max_range = 1e4;                   ///< maximum measurable depth along z [m]

  /// Throws Error{bad_config} that names the first field outside its interval.
  void validate() const;
};

/// Validated camera. An immutable value type: cheap to copy and safe to share between threads.
class Camera {
 public:
  /// Throws the errors of CameraConfig::validate().
  explicit Camera(const CameraConfig& config);

  const CameraConfig& config() const { return config_; }
  int width() const { return config_.width; }
  int height() const { return config_.height; }
  const Eigen::Vector2d& focal_length_px() const { return focal_length_px_; }
  const Eigen::Vector2d& principal_point_px() const { return principal_point_px_; }

  /// Returns the pixel coordinates of a point by HZ (6.1), or nullopt if the point is outside the
  /// frustum. The sides of the frustum are the outer edges of the outermost pixels. NaN points are
  /// outside.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_in_camera) const;

  /// Returns the direction of the ray through `pixel` in the camera frame, scaled to z = 1. A point
  /// at depth `t` is `t * ray(pixel)`. Inverse of project().
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d slope = (pixel - principal_point_px_).cwiseQuotient(focal_length_px_);
    return {slope.x(), slope.y(), 1.0};
  }

 private:
  CameraConfig config_;
  Eigen::Vector2d focal_length_px_;
  Eigen::Vector2d principal_point_px_;
};

/// Returns the view distance [m] at which the pixels have the volumetric density `density` [points
/// per m^3] (SEE++ §IV-B). The pixels are distributed over the viewing pyramid whose height is the
/// view distance d: d = (3 wx wy / (4 rho tan(theta_x/2) tan(theta_y/2)))^(1/3).
double view_distance(const Camera& camera, double density);

}  // namespace skycap::geometry
