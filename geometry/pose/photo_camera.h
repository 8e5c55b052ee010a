/// Photo camera as described by its data sheet, and the corresponding pinhole camera.
///
/// The camera frame and pixel coordinates are those of geometry/pose/camera.h: x right, y down, z
/// along the optical axis; pixel (0, 0) is the centre of the top-left pixel. Lengths are in metres,
/// although data sheets use millimetres.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Lens distortion after Brown and Conrady on the normalised image plane: radial k1, k2, k3 and
/// tangential p1, p2, dimensionless. Definition as in OpenCV and COLMAP (model OPENCV, with k3 =
/// 0).
struct BrownDistortion {
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;
};

enum class ShutterKind { mechanical, electronic };

/// Data sheet values of a photo camera with a fixed lens.
struct PhotoCameraConfig {
  std::string name;           ///< Name for messages and files.
  double focal_length = 0.0;  ///< Actual focal length, not the 35 mm equivalent [m].
  Eigen::Vector2d sensor_size =
      Eigen::Vector2d::Zero();  ///< Width and height of the image area [m].
  int width = 0;                ///< [px]
  int height = 0;               ///< [px]
  /// Full horizontal field of view, if specified in the data sheet [rad]. It must agree with the
  /// focal length.
  std::optional<double> horizontal_fov;
  double min_interval = 1.0;  ///< Minimum time between two photos [s].
  ShutterKind shutter = ShutterKind::mechanical;
  double readout = 0.0;  ///< Readout time of a rolling shutter from first to last row [s]. Zero: no
                         ///< rolling shutter.
  double exposure = 0.001;     ///< Exposure time of each pixel [s].
  double nearest_focus = 1.0;  ///< Minimum distance of objects in focus [m].
  std::optional<BrownDistortion> distortion;
  /// Image types of the payload, as spelled in DJI's WPML ("visable").
  std::vector<std::string> formats;

  /// Throws Error{bad_config} with the name of the first field outside its interval. The pixel
  /// pitches of both sides must agree within 2%. Larger differences indicate that sensor size and
  /// image size refer to different crops. Field of view and focal length must agree within 1%.
  /// Without a field of view, focal lengths of 20 to 30 mm are rejected as 35 mm equivalents if the
  /// crop factor is 1.9 or more.
  void validate() const;
};

/// Validated photo camera with square pixels. Value type: cheap to copy, and safe to share between
/// threads.
class PhotoCamera {
 public:
  /// Throws the same errors as PhotoCameraConfig::validate().
  explicit PhotoCamera(PhotoCameraConfig config);

  const PhotoCameraConfig& config() const { return config_; }
  int width() const { return config_.width; }
  int height() const { return config_.height; }

  /// Returns the focal length divided by the pixel pitch [px]. The pitch of the longer image side
  /// is used, because rounding in the data sheet affects it less.
  double focal_length_px() const { return focal_length_px_; }
  /// Returns the centre of the image [px].
  Eigen::Vector2d principal_point_px() const {
    return {0.5 * (config_.width - 1), 0.5 * (config_.height - 1)};
  }
  /// Returns the full horizontal field of view of the pinhole camera [rad].
  double horizontal_fov() const;
  double vertical_fov() const;

  /// Returns the ground sampling distance on a surface that faces the camera at `distance` [m].
  double gsd(double distance) const { return distance / focal_length_px_; }
  /// Returns the distance at which a surface that faces the camera has this ground sampling
  /// distance [m].
  double distance(double gsd) const { return gsd * focal_length_px_; }

  /// Projects a point in the camera frame to a pixel, without distortion. Returns nullopt if the
  /// point is not in front of the camera, or if it projects outside the image or into its border.
  /// `border` is the width of the border as a fraction of each side, below 0.5.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_in_camera,
                                         double border = 0.0) const;

 private:
  PhotoCameraConfig config_;
  double focal_length_px_;
};

}  // namespace skycap::geometry
