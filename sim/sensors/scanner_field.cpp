#include "sim/sensors/scanner_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/error.h"
#include "sim/scene/scene.h"
#include "sim/sensors/scan_pattern.h"

namespace skycap::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Returns the camera with the given angles of view and numbers of pixels.
DepthCameraConfig make_image(const LidarConfig& lidar, double wide, int columns, double high,
                             int rows) {
  DepthCameraConfig config;
  config.camera = {.width = columns,
                   .height = rows,
                   .horizontal_fov = wide,
                   .vertical_fov = high,
                   .min_range = lidar.min_range,
                   .max_range = lidar.max_range};
  const NoiseTable& table = lidar.errors.table;
  config.noise.sigma = table.is_on()
                           ? table.sigma(table.ranges.front(), 1.0, Scene::default_reflectance)
                           : lidar.errors.sigma;
  config.noise.direction = NoiseDirection::along_ray;
  return config;
}

/// Returns a camera with the given angles and one pixel per ray at its centre.
DepthCameraConfig ray_camera(const LidarConfig& lidar, double wide, double columns_step,
                             double high, double rows_step) {
  // The number of pixels makes the centre of the image as dense as the rays.
  const auto pixels = [](double angle, double step) {
    return std::max(1, static_cast<int>(std::lround(2.0 * std::tan(0.5 * angle) / step)));
  };
  return make_image(lidar, wide, pixels(wide, columns_step), high, pixels(high, rows_step));
}

/// Field of view of a ring.
struct Field {
  double around, around_step;  ///< Used part of a revolution, and angle between firings [rad].
  double up, up_step;  ///< Angle across the rotation, and between neighbouring lasers [rad].
};

Field make_field(const LidarConfig& lidar) {
  const auto [min_elevation, max_elevation] = elevations(lidar);
  const double step =
      (max_elevation - min_elevation) / static_cast<double>(lidar.channels.size() - 1);
  return {std::min(lidar.field_of_view, 0.5 * std::numbers::pi), azimuth_step(lidar),
          max_elevation - min_elevation + step, step};
}

/// Returns the directions of all pulses within a period, in the given optical frame.
std::vector<Vector3d> directions_in(const LidarConfig& lidar, double period,
                                    const Matrix3d& optical_from_scanner) {
  const ScanPattern pattern(lidar);
  const auto blocks = static_cast<std::uint64_t>(
      std::ceil(period / lidar.firing_period / ScanPattern::firings_in_block));
  Pulses pulses;
  std::vector<Vector3d> directions;
  for (std::uint64_t block = 0; block < blocks; ++block) {
    pattern.aim(block, pulses);
    for (std::size_t slot = 0; slot < pattern.slots(); ++slot) {
      if (pulses.is_emitted[slot] == 0) continue;
      const Vector3d direction(pulses.direction[0][slot], pulses.direction[1][slot],
                               pulses.direction[2][slot]);
      directions.emplace_back(optical_from_scanner * direction);
    }
  }
  return directions;
}

/// Returns azimuth and elevation around the x axis [rad] of the forward directions.
std::vector<Vector2d> compute_angles(const std::vector<Vector3d>& directions) {
  std::vector<Vector2d> angles;
  for (const Vector3d& d : directions) {
    if (d.z() <= 0.0) continue;
    angles.emplace_back(std::atan2(d.y(), d.z()), std::asin(std::clamp(d.x(), -1.0, 1.0)));
  }
  return angles;
}

/// Returns the fraction of cells in a rectangle of the image plane that contain a ray. Cells have
/// the given width in azimuth and elevation around the x axis.
double filled_share(const std::vector<Vector2d>& angles, const Vector2d& half_slopes,
                    double width) {
  // In each direction.
  const auto cells = static_cast<int>(std::ceil(0.5 * std::numbers::pi / width));
  const int across = 2 * cells;
  std::vector<char> is_filled(static_cast<std::size_t>(across) * across, 0);
  for (const Vector2d& angle : angles) {
    const int column = cells + static_cast<int>(std::floor(angle.x() / width));
    const int row = cells + static_cast<int>(std::floor(angle.y() / width));
    is_filled[static_cast<std::size_t>(row) * across + column] = 1;
  }
  // Sines and cosines of the cell edges in both directions.
  std::vector<double> sines, cosines;
  for (int edge = 0; edge <= across; ++edge) {
    const double angle = (edge - cells) * width;
    sines.push_back(std::sin(angle));
    cosines.push_back(std::cos(angle));
  }
  std::size_t all = 0, filled = 0;
  const auto is_within = [&](int row, int column) {
    const Vector3d d(sines[row], cosines[row] * sines[column], cosines[row] * cosines[column]);
    return d.z() > 0.0 && std::abs(d.x()) <= half_slopes.x() * d.z() &&
           std::abs(d.y()) <= half_slopes.y() * d.z();
  };
  for (int row = 0; row < across; ++row) {
    for (int column = 0; column < across; ++column) {
      if (!is_within(row, column) || !is_within(row + 1, column) || !is_within(row, column + 1) ||
          !is_within(row + 1, column + 1)) {
        continue;
      }
      ++all;
      filled +=
          static_cast<std::size_t>(is_filled[static_cast<std::size_t>(row) * across + column]);
    }
  }
  return all == 0 ? 0.0 : static_cast<double>(filled) / static_cast<double>(all);
}

}  // namespace

ScannerKind find_scanner_kind(const LidarConfig& lidar) {
  if (!lidar.prisms.empty()) return ScannerKind::rosette;
  if (lidar.rotation_rate == 0.0) {
    throw Error(ErrorKind::bad_config,
                "a survey requires a spinning scanner or one with prisms, such as ouster_os1_128 "
                "or livox_avia");
  }
  const auto [min_elevation, max_elevation] = elevations(lidar);
  constexpr double min_spread = 0.01;
  return max_elevation - min_elevation < min_spread ? ScannerKind::line : ScannerKind::ring;
}

Elevations elevations(const LidarConfig& lidar) {
  const auto [min_elevation, max_elevation] =
      std::ranges::minmax_element(lidar.channels, {}, &Channel::elevation);
  return {min_elevation->elevation, max_elevation->elevation};
}

double azimuth_step(const LidarConfig& lidar) {
  return 2.0 * std::numbers::pi * std::abs(lidar.rotation_rate) * lidar.firing_period;
}

DepthCameraConfig forward_camera(const LidarConfig& lidar) {
  switch (find_scanner_kind(lidar)) {
    case ScannerKind::line:
      throw Error(ErrorKind::bad_config,
                  "a single-line LiDAR requires flight.vehicle; set it, or use a scanner with "
                  "several lasers, such as ouster_os1_128");
    case ScannerKind::rosette: {
      Matrix3d optical_from_scanner;  // x right, y down, z forward, from x forward, y left, z up.
      optical_from_scanner << 0, -1, 0, 0, 0, -1, 1, 0, 0;
      return rosette_camera(lidar, rosette_field(lidar, rosette_period, optical_from_scanner));
    }
    case ScannerKind::ring:
      break;
  }
  const Field field = make_field(lidar);
  return ray_camera(lidar, field.around, field.around_step, field.up, field.up_step);
}

DepthCameraConfig side_camera(const LidarConfig& lidar, std::size_t turns) {
  const Field field = make_field(lidar);
  // The centre of the image is perpendicular to the axis. The lasers may not be symmetric around
  // it. The width covers only angles with lasers on both sides.
  const auto [min_elevation, max_elevation] = elevations(lidar);
  const double wide =
      2.0 * std::max(std::min(-min_elevation, max_elevation), field.up_step) + field.up_step;
  const double denser = std::sqrt(static_cast<double>(turns));  // In each direction.
  return ray_camera(lidar, wide, field.up_step / denser, field.around, field.around_step / denser);
}

DepthCameraConfig line_camera(const LidarConfig& lidar, double period, double swept) {
  const double around = std::min(lidar.field_of_view, 0.5 * std::numbers::pi);
  const double lines = std::max(1.0, std::round(period * std::abs(lidar.rotation_rate)));
  return ray_camera(lidar, 2.0 * std::atan(0.5 * swept), swept / lines, around,
                    azimuth_step(lidar));
}

RosetteField rosette_field(const LidarConfig& lidar, double period,
                           const Matrix3d& optical_from_scanner) {
  const std::vector<Vector3d> directions = directions_in(lidar, period, optical_from_scanner);
  RosetteField field{Vector2d::Zero(), 0, 0.0};
  for (const Vector3d& d : directions) {
    field.half_slopes = field.half_slopes.cwiseMax(d.head<2>().cwiseAbs() / d.z());
  }
  field.half_slopes /= std::numbers::sqrt2;  // Largest rectangle within an ellipse.
  for (const Vector3d& d : directions) {
    const Vector2d slopes = d.head<2>().cwiseAbs() / d.z();
    field.rays += (slopes.array() <= field.half_slopes.array()).all() ? 1 : 0;
  }
  constexpr double finest = 0.003, coarsest = 0.2, step = 1.15, enough = 0.995;
  const std::vector<Vector2d> angles = compute_angles(directions);
  field.gap = finest;
  while (field.gap < coarsest && filled_share(angles, field.half_slopes, field.gap) < enough) {
    field.gap *= step;
  }
  return field;
}

DepthCameraConfig rosette_camera(const LidarConfig& lidar, const RosetteField& field) {
  const double pixel = std::sqrt(4.0 * field.half_slopes.prod() / static_cast<double>(field.rays));
  const auto pixels = [&](double half_slope) {
    return std::max(1, static_cast<int>(std::lround(2.0 * half_slope / pixel)));
  };
  return make_image(lidar, 2.0 * std::atan(field.half_slopes.x()), pixels(field.half_slopes.x()),
                    2.0 * std::atan(field.half_slopes.y()), pixels(field.half_slopes.y()));
}

double ray_spacing(const LidarConfig& lidar) {
  std::vector<double> lasers;
  for (const Channel& channel : lidar.channels) lasers.push_back(channel.elevation);
  std::ranges::sort(lasers);
  double spacing = azimuth_step(lidar);
  for (std::size_t i = 1; i < lasers.size(); ++i) {
    spacing = std::max(spacing, lasers[i] - lasers[i - 1]);
  }
  return spacing;
}

double range_noise(const LidarConfig& lidar, double range) {
  const auto& errors = lidar.errors;
  if (errors.table.is_on()) {
    return errors.table.sigma(range, 1.0, Scene::default_reflectance);
  }
  return std::hypot(errors.sigma, errors.sigma_per_metre * range,
                    errors.sigma_per_square_metre * range * range);
}

}  // namespace skycap::sim
