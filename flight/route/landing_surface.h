/// Ground of pads and rally points: slope, unevenness, and height relative to the configured pad.
/// The pad height matters because it is the altitude reference of mission files.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::flight {

/// Maximum height of objects near a pad that count as part of its ground [m].
inline constexpr double pad_roughness = 0.3;

/// Source of the ground data of a pad.
enum class GroundSource { measured, declared, terrain, scene };

/// Least-squares plane through the ground around a pad.
struct LandingSurface {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Position of the pad.
  double slope = 0.0;                                  ///< Slope of the plane [rad].
  double unevenness = 0.0;  ///< Root-mean-square distance of the ground from the plane [m].
  double rise = 0.0;        ///< Height of the plane above the pad, at the pad [m].
  GroundSource source = GroundSource::measured;
};

/// Returns "as measured", "as declared", "by the terrain" or "in the scene".
const char* to_string(GroundSource source);

/// Fits the ground plane to `positions`, which are points on the ground. Returns std::nullopt for
/// fewer than six points, or if the standard error of the slope exceeds 2 degrees.
std::optional<LandingSurface> pad_ground(const Eigen::Vector3d& pad,
                                         std::span<const Eigen::Vector3d> positions,
                                         GroundSource source);

/// Returns sample positions within `radius` of a pad [m]: its centre and two rings.
std::vector<Eigen::Vector2d> landing_points(const Eigen::Vector3d& pad, double radius);

/// Limits for the ground of a pad.
struct PadLimits {
  double max_slope = std::numbers::pi / 18.0;  ///< Maximum slope under the vehicle [rad].
  double height_error = 0.0;  ///< Height error of prior data, added to pad_roughness [m].
};

/// Returns the reason why the ground is unsuitable for landing, or an empty string.
std::string unfit_reason(const LandingSurface& ground, const PadLimits& limits);

/// Throws Error{bad_config} if one of the grounds is unsuitable.
void check_landing_surfaces(std::span<const LandingSurface> landing_surfaces,
                            const PadLimits& limits);

/// Ground of a pad from scans. Points are averaged over cells to reduce noise.
class PadScan {
 public:
  PadScan(const Eigen::Vector3d& pad, double radius);

  /// Adds the points within `radius` of the pad. Points more than `radius` + 1 m above or below the
  /// pad are ignored: that covers a slope of 45 degrees and 1 m of height error.
  void add_points(std::span<const Eigen::Vector3f> points);

  /// Returns the ground, or std::nullopt under the conditions of pad_ground().
  std::optional<LandingSurface> ground() const;

 private:
  static constexpr std::size_t cells_across = 8;
  struct Cell {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t count = 0;
  };

  Eigen::Vector3d pad_;
  double radius_;
  std::array<Cell, cells_across * cells_across> cells_;
};

}  // namespace skycap::flight
