/// A photo camera in the terms of its data sheet, and the pinhole camera that follows from it.
///
/// Camera frame and pixels as in geometry/pose/camera.h: x right, y down, z along the optical
/// axis; pixel (0, 0) is the centre of the top-left pixel. Lengths are in metres, unlike data
/// sheets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Lens distortion of Brown and Conrady as OpenCV and COLMAP (model OPENCV, k3 zero) define it: on
/// the normalised image plane, radial k1, k2, k3 and tangential p1, p2. Without units.
struct BrownDistortion {
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;
};

enum class ShutterKind { mechanical, electronic };

/// Data sheet of a photo camera with a fixed lens.
struct PhotoCameraConfig {
  std::string name;           ///< for messages and files
  double focal_length = 0.0;  ///< true, not 35 mm equivalent [m]
  Eigen::Vector2d sensor_size =
      Eigen::Vector2d::Zero();  ///< width and height of the image area [m]
  int width = 0;                ///< [px]
  int height = 0;               ///< [px]
  /// Full horizontal field of view, if the data sheet states it [rad]; compared with the focal
  /// length.
  std::optional<double> horizontal_fov;
  double min_interval = 1.0;  ///< between two photos [s]
  ShutterKind shutter = ShutterKind::mechanical;
  double readout = 0.0;        ///< of a rolling shutter, first to last row [s]; zero: none
  double exposure = 0.001;     ///< of each pixel [s]
  double nearest_focus = 1.0;  ///< minimum distance of a sharp object [m]
  std::optional<BrownDistortion> distortion;
  /// Image kinds of the payload, as DJI's WPML spells them ("visable").
  std::vector<std::string> formats;

  /// Throws Error{bad_config} naming the first field that is out of its interval. The pixel pitches
  /// of both sides must agree within 2%: sizes of different crops of the sensor do not. Field of
  /// view and focal length must agree within 1%. Without a field of view, 20 to 30 mm at a crop
  /// factor of 1.9 or more are rejected as the 35 mm equivalent.
  void validate() const;
};

/// A validated photo camera with square pixels. A value: cheap to copy, safe to share.
class PhotoCamera {
 public:
  /// Throws what PhotoCameraConfig::validate() throws.
  explicit PhotoCamera(PhotoCameraConfig config);

  const PhotoCameraConfig& config() const { return config_; }
  int width() const { return config_.width; }
  int height() const { return config_.height; }

  /// Focal length over pixel pitch [px]. The pitch is that of the image's longer side, whose
  /// rounding in the data sheet matters less.
  double focal_length_px() const { return focal_length_px_; }
  /// The middle of the image [px].
  Eigen::Vector2d principal_point_px() const {
    return {0.5 * (config_.width - 1), 0.5 * (config_.height - 1)};
  }
  /// Full angles of view of the pinhole camera [rad].
  double horizontal_fov() const;
  double vertical_fov() const;

  /// Ground sampling distance on a surface that faces the camera at `distance` [m].
  double gsd(double distance) const { return distance / focal_length_px_; }
  /// Distance at which a surface that faces the camera has this ground sampling distance [m].
  double distance(double gsd) const { return gsd * focal_length_px_; }

  /// Pixel of a point in the camera frame, without distortion; nothing if the point is not in front
  /// of the camera, or nearer than `border` (a fraction of each side, below 0.5) to the edge of the
  /// image.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_in_camera,
                                         double border = 0.0) const;

 private:
  PhotoCameraConfig config_;
  double focal_length_px_;
};

}  // namespace skycap::geometry
