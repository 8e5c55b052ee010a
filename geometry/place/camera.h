/// Pinhole depth camera: which points it can see, and along which rays it measures.
///
/// Camera frame: x right, y down, z along the optical axis, in metres. Pixel (0, 0) is the centre
/// of the top-left pixel; pixels need not be square. Source of the projection: Hartley & Zisserman,
/// Multiple View Geometry, 2nd ed., Eq. (6.1), written "HZ (6.1)" in the code.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace skycap::geometry {

/// What a mission file says of a camera. Defaults: the depth camera of the SEE++ experiments, an
/// Intel RealSense D435 with the field of view of its colour image (paper §IV-A).
struct CameraConfig {
  int width = 848;                          ///< [px]
  int height = 480;                         ///< [px]
  double horizontal_fov = 1.2112584975906;  ///< full angle [rad], in (0, pi); 69.4 degrees
  double vertical_fov = 0.7417649320975;    ///< full angle [rad], in (0, pi); 42.5 degrees
  double min_range = 0.0;                   ///< nearest measurable depth along z
  double max_range = 1e4;                   ///< farthest measurable depth along z

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

/// A validated camera. A value: cheap to copy, never half-built, safe to share across threads.
class Camera {
 public:
  /// Throws what CameraConfig::validate() throws.
  explicit Camera(const CameraConfig& config);

  const CameraConfig& config() const { return config_; }
  int width() const { return config_.width; }
  int height() const { return config_.height; }
  const Eigen::Vector2d& focal_length_px() const { return focal_length_px_; }
  const Eigen::Vector2d& principal_point_px() const { return principal_point_px_; }

  /// Pixel coordinates of a point, HZ (6.1); nothing if it is outside the frustum, whose sides
  /// are the outer edges of the outermost pixels. NaN points are outside.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_in_camera) const;

  /// Direction, in the camera frame and with z = 1, of the ray through `pixel`: a point at depth
  /// `t` is `t * ray(pixel)`. Inverse of project().
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d slope = (pixel - principal_point_px_).cwiseQuotient(focal_length_px_);
    return {slope.x(), slope.y(), 1.0};
  }

 private:
  CameraConfig config_;
  Eigen::Vector2d focal_length_px_;
  Eigen::Vector2d principal_point_px_;
};

/// The distance at which the pixels, spread over the whole viewing pyramid of that height, have the
/// volumetric density `density` [points per m^3] (SEE++ §IV-B):
/// d = (3 wx wy / (4 rho tan(theta_x/2) tan(theta_y/2)))^(1/3).
double view_distance(const Camera& camera, double density);

}  // namespace skycap::geometry
