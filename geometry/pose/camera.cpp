#include "geometry/pose/camera.h"

#include <cmath>
#include <numbers>

#include "geometry/requirement.h"

namespace skycap::geometry {
namespace {

bool is_angle_of_view(double angle) { return angle > 0.0 && angle < std::numbers::pi; }

}  // namespace

void CameraConfig::validate() const {
  constexpr int max_pixels = 1 << 15;
  require(width > 0 && width <= max_pixels, "width", width, "between 1 and 32768 pixels");
  require(height > 0 && height <= max_pixels, "height", height, "between 1 and 32768 pixels");
  require(static_cast<double>(width) * height <= 1e8, "width", width,
          "such that width times height is at most 100 million pixels");
  require(is_angle_of_view(horizontal_fov), "horizontal_fov", horizontal_fov,
          "between 0 and pi radians (exclusive)");
  require(is_angle_of_view(vertical_fov), "vertical_fov", vertical_fov,
          "between 0 and pi radians (exclusive)");
  require(min_range >= 0.0 && std::isfinite(min_range), "min_range", min_range, "zero or more");
  require(max_range > min_range && std::isfinite(max_range), "max_range", max_range,
          "finite and greater than min_range");
}

Camera::Camera(const CameraConfig& config) : config_(config) {
  config.validate();
  focal_length_px_ = {0.5 * config.width / std::tan(0.5 * config.horizontal_fov),
                      0.5 * config.height / std::tan(0.5 * config.vertical_fov)};
  principal_point_px_ = {0.5 * (config.width - 1), 0.5 * (config.height - 1)};
}

std::optional<Eigen::Vector2d> Camera::project(const Eigen::Vector3d& point_in_camera) const {
  const double depth = point_in_camera.z();
  if (!(depth > 0.0 && depth >= config_.min_range && depth <= config_.max_range)) {
    return std::nullopt;  // also for NaN
  }
  // HZ (6.1), translated by the principal point.
  const Eigen::Vector2d pixel =
      point_in_camera.head<2>().cwiseProduct(focal_length_px_) / depth + principal_point_px_;
  const bool inside = pixel.x() >= -0.5 && pixel.x() < config_.width - 0.5 && pixel.y() >= -0.5 &&
                      pixel.y() < config_.height - 0.5;
  return inside ? std::optional(pixel) : std::nullopt;
}

double view_distance(const Camera& camera, double density) {
  const CameraConfig& config = camera.config();
  const double pixels = static_cast<double>(config.width) * config.height;
  return std::cbrt(3.0 * pixels /
                   (4.0 * density * std::tan(0.5 * config.horizontal_fov) *
                    std::tan(0.5 * config.vertical_fov)));
}

}  // namespace skycap::geometry
