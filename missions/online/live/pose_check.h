/// Whether a scan was taken from where its pose says, by what earlier scans measured.
///
/// Two things give a wrong pose away. Where the scan and the kept cloud show the same surface, the
/// motion that would bring one onto the other (geometry/points/registration.h) is more than the
/// pose's sigma and the errors of both surfaces explain. And of what was measured before much is
/// missing where the scan saw through it, or the other way round: that finds jumps which are too
/// large for surfaces to meet again.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/scan.h"
#include "geometry/points/surface_map.h"
#include "missions/online/live/pose_covariance.h"
#include "missions/online/live/range_image.h"

namespace skycap::missions::online {

/// What was found of a scan's pose.
struct PoseFinding {
  std::size_t matches = 0;    ///< places that both scan and kept cloud show
  double error = 0.0;         ///< median distance there across the surface, as given [m]
  double shift = 0.0;         ///< of the sensor, that would make them fit [m]
  double turn = 0.0;          ///< [rad]
  double seen_through = 0.0;  ///< share of what should be seen that was seen through
  int unobservable = 0;       ///< ways to move, of six, which the common surface does not show
  bool is_checked = false;    ///< there is enough in common
  bool is_wrong = false;      ///< the scan is set aside
  std::optional<Eigen::Isometry3d> correction;  ///< applied: true from given, in the world
};

/// The scan as from a corrected pose, to the last bit whenever it is done.
geometry::Scan corrected(geometry::Scan scan, const Eigen::Isometry3d& correction);

class PoseCheck {
 public:
  /// Surfaces are compared in pieces of `radius`, or of two, four or eight times that where noise
  /// leaves no surface in smaller ones. With `registers` poses are corrected, if the correction is
  /// what their covariance explains.
  PoseCheck(double radius, bool registers);

  PoseFinding find(const geometry::ScanSpan& scan, const PoseCovariance& covariance);

  /// Remembers a scan that is used, and the points that were kept of it.
  void remember(const geometry::ScanSpan& scan, std::span<const Eigen::Vector3f> kept);

 private:
  double seen_through(const geometry::ScanSpan& scan,
                      const std::vector<geometry::SurfacePatch>& patches,
                      const PoseCovariance& covariance, const geometry::SurfaceMap& map) const;

  bool registers_;
  std::array<geometry::SurfaceMap, 4> maps_;  ///< from fine to coarse
  std::deque<RangeImage> last_;               ///< of the last scans
};

}  // namespace skycap::missions::online
