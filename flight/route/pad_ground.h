/// The ground of pads and rally points: how steep and how even it is, and whether it lies where the
/// pad is said to be. Heights of mission files count from where the vehicle stands.
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

/// What stands no higher than this beside a pad is the ground that it is on [m].
inline constexpr double pad_roughness = 0.3;

/// Who says how the ground of a pad lies.
enum class GroundSource { measured, declared, terrain, scene };

/// The plane that fits the ground round a pad best.
struct PadGround {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< the pad
  double slope = 0.0;                               ///< of that plane [rad]
  double unevenness = 0.0;  ///< of the ground about it, root mean square [m]
  double rise = 0.0;        ///< of it above the pad, at the pad [m]
  GroundSource source = GroundSource::measured;
};

/// "as measured", "as declared", "by the terrain", "in the scene".
const char* name_of(GroundSource source);

/// Fits the ground to places of it. Nothing if they are fewer than six, or so few, uneven or on a
/// line that the slope is not known to 2 degrees (its standard error).
std::optional<PadGround> pad_ground(const Eigen::Vector3d& pad,
                                    std::span<const Eigen::Vector3d> places, GroundSource source);

/// Where to ask for heights of the ground within `radius` of a pad: its middle and two rings.
std::vector<Eigen::Vector2d> places_on(const Eigen::Vector3d& pad, double radius);

/// What a pad's ground may be.
struct PadLimits {
  double steepest = std::numbers::pi / 18.0;  ///< slope at which the vehicle may stand [rad]
  double height_error = 0.0;  ///< how far off priors may have the ground, beside pad_roughness [m]
};

/// Why the vehicle must not stand there; empty if it may.
std::string why_unfit(const PadGround& ground, const PadLimits& limits);

/// Throws Error{bad_config} if one of the grounds is unfit.
void check_grounds(std::span<const PadGround> grounds, const PadLimits& limits);

/// The ground of a pad as scans measure it: means over cells, so that noise averages out.
class PadScan {
 public:
  PadScan(const Eigen::Vector3d& pad, double radius);

  /// Keeps what lies within the radius, and no farther above or below the pad than a slope of 45
  /// degrees and a metre explain.
  void take_in(std::span<const Eigen::Vector3f> points);

  /// Nothing as pad_ground().
  std::optional<PadGround> ground() const;

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
