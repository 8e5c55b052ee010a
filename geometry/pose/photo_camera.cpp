#include "geometry/pose/photo_camera.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/requirement.h"

namespace skycap::geometry {
namespace {

constexpr double per_mm = 1e3;

void require_sides(const PhotoCameraConfig& config) {
  constexpr int max_pixels = 1 << 17;
  require(config.width > 0 && config.width <= max_pixels, "image_size", config.width,
          "between 1 and 131072 pixels");
  require(config.height > 0 && config.height <= max_pixels, "image_size", config.height,
          "between 1 and 131072 pixels");
  for (const double side : config.sensor_size) {
    require(side > 1e-4 && side < 1.0, "sensor_size", per_mm * side, "between 0.1 and 1000 mm");
  }
  require(config.focal_length > 1e-4 && config.focal_length < 10.0, "focal_length",
          per_mm * config.focal_length, "between 0.1 and 10000 mm");
}

/// Returns a number with up to `digits` significant digits.
std::string text(double value, int digits = 6) {
  std::array<char, 40> characters{};
  std::to_chars(characters.begin(), characters.end() - 1, value, std::chars_format::general,
                digits);
  return characters.data();
}

std::string size_text(const Eigen::Vector2d& metres) {
  return text(per_mm * metres.x()) + " x " + text(per_mm * metres.y()) + " mm";
}

/// Throws Error if sensor size and image size refer to different crops.
void require_square_pixels(const PhotoCameraConfig& config) {
  const double across = config.sensor_size.x() / config.width;
  const double down = config.sensor_size.y() / config.height;
  if (std::abs(across - down) <= 0.02 * std::min(across, down)) return;
  throw Error(ErrorKind::bad_config,
              "sensor_size (" + size_text(config.sensor_size) + ") and image_size (" +
                  std::to_string(config.width) + " x " + std::to_string(config.height) +
                  " px) must have the same aspect ratio within 2%: the pixel pitches are " +
                  text(1e6 * across, 4) + " and " + text(1e6 * down, 4) +
                  " um; set the sensor size to the size of the crop that the image uses");
}

/// Throws Error if the field of view contradicts the focal length. Without a field of view, throws
/// Error if the focal length is evidently the 35 mm equivalent.
void require_true_focal_length(const PhotoCameraConfig& config) {
  const double follows = 2.0 * std::atan(0.5 * config.sensor_size.x() / config.focal_length);
  const std::string focal = "focal_length (" + text(per_mm * config.focal_length) + " mm)";
  const std::string degrees = text(follows * degrees_per_radian, 4) + " degrees";
  if (const auto& fov = config.horizontal_fov) {
    const std::string fov_deg = text(*fov * degrees_per_radian);
    require(*fov > 0.0 && *fov < std::numbers::pi, "horizontal_fov_deg", *fov * degrees_per_radian,
            "between 0 and 180 degrees (exclusive)");
    if (std::abs(follows - *fov) <= 0.01 * follows) return;
    const double agreeing = 0.5 * config.sensor_size.x() / std::tan(0.5 * *fov);
    throw Error(ErrorKind::bad_config,
                focal + " and horizontal_fov_deg (" + fov_deg +
                    ") must agree within 1%: the focal length gives " + degrees +
                    ", the field of view gives " + text(per_mm * agreeing, 4) +
                    " mm; set the true focal length, not the 35 mm equivalent");
  }
  constexpr double full_frame_diagonal = 0.0432666;  // Diagonal of 36 x 24 mm [m].
  const double crop = full_frame_diagonal / config.sensor_size.norm();
  const double focal_mm = per_mm * config.focal_length;
  if (crop < 1.9 || focal_mm < 20.0 || focal_mm > 30.0) return;
  throw Error(ErrorKind::bad_config,
              focal + " appears to be the 35 mm equivalent: on a sensor of " +
                  size_text(config.sensor_size) + " it gives " + degrees +
                  "; set the true focal length (about " + text(focal_mm / crop, 3) +
                  " mm), or set horizontal_fov_deg to confirm it");
}

}  // namespace

void PhotoCameraConfig::validate() const {
  require_sides(*this);
  require_square_pixels(*this);
  require_true_focal_length(*this);
  require(min_interval > 0.0 && min_interval <= 3600.0, "min_interval", min_interval,
          "more than 0 and at most 3600 s");
  require(readout >= 0.0 && readout <= 10.0, "readout", readout, "between 0 and 10 s");
  require(exposure > 0.0 && exposure <= 10.0, "exposure", exposure, "more than 0 and at most 10 s");
  require(nearest_focus >= 0.0 && nearest_focus <= 1e4, "nearest_focus", nearest_focus,
          "between 0 and 10000 m");
}

PhotoCamera::PhotoCamera(PhotoCameraConfig config) : config_(std::move(config)) {
  config_.validate();
  const bool is_wide = config_.width >= config_.height;
  const double pitch =
      is_wide ? config_.sensor_size.x() / config_.width : config_.sensor_size.y() / config_.height;
  focal_length_px_ = config_.focal_length / pitch;
}

double PhotoCamera::horizontal_fov() const {
  return 2.0 * std::atan(0.5 * config_.width / focal_length_px_);
}

double PhotoCamera::vertical_fov() const {
  return 2.0 * std::atan(0.5 * config_.height / focal_length_px_);
}

std::optional<Eigen::Vector2d> PhotoCamera::project(const Eigen::Vector3d& point_in_camera,
                                                    double border) const {
  if (!(point_in_camera.z() > 0.0)) return std::nullopt;  // Also rejects NaN.
  const Eigen::Vector2d from_middle =
      point_in_camera.head<2>() * (focal_length_px_ / point_in_camera.z());
  const double kept = 0.5 - border;
  if (!(std::abs(from_middle.x()) <= kept * config_.width &&
        std::abs(from_middle.y()) <= kept * config_.height)) {
    return std::nullopt;
  }
  return Eigen::Vector2d(from_middle + principal_point_px());
}

}  // namespace skycap::geometry
