/// Check of a scan's pose against earlier scans.
///
/// Two tests detect a wrong pose. First, where the scan and the kept cloud show the same surface,
/// registration (geometry/points/registration.h) gives the motion between them. The pose is wrong
/// if its standard deviation and the errors of both surfaces do not explain this motion. In
/// addition, the surface that both show at the given pose must fit better after the motion. Second,
/// the scan must not see through a large fraction of the earlier measurements, nor earlier scans
/// through its points. The second test detects errors that are too large for the surfaces to
/// overlap.
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

/// Result of the check of a scan's pose.
struct PoseFinding {
  std::size_t matches = 0;  ///< Surface patches visible in both the scan and the kept cloud.
  /// Median distance between matching patches along the normal, for the given pose [m].
  double error = 0.0;
  double shift = 0.0;         ///< Translation of the sensor that aligns scan and cloud [m].
  double turn = 0.0;          ///< Rotation that aligns scan and cloud [rad].
  double seen_through = 0.0;  ///< Fraction of expected surface points that were seen through.
  /// Number of degrees of freedom, of six, that the common surface does not constrain.
  int unobservable = 0;
  bool is_checked = false;  ///< True if the overlap is sufficient for a check.
  bool is_wrong = false;    ///< True if the scan is rejected.
  /// Applied correction: transform from given to corrected coordinates, in the world frame.
  std::optional<Eigen::Isometry3d> correction;
};

/// Returns the scan transformed by `correction`. The result is deterministic to the last bit.
geometry::Scan corrected(geometry::Scan scan, const Eigen::Isometry3d& correction);

class PoseCheck {
 public:
  /// Compares surfaces in patches of `radius` [m], or of two, four or eight times this radius where
  /// noise does not permit smaller patches. With `registers`, poses are corrected if their
  /// covariance explains the correction.
  PoseCheck(double radius, bool registers);

  PoseFinding find(const geometry::ScanSpan& scan, const PoseCovariance& covariance);

  /// Adds an accepted scan and `kept`, the points of it that were kept.
  void remember(const geometry::ScanSpan& scan, std::span<const Eigen::Vector3f> kept);

 private:
  double seen_through(const geometry::ScanSpan& scan,
                      const std::vector<geometry::SurfacePatch>& patches,
                      const PoseCovariance& covariance, const geometry::SurfaceMap& map) const;

  bool registers_;
  std::array<geometry::SurfaceMap, 4> maps_;  ///< Surface maps in order of increasing patch radius.
  std::deque<RangeImage> last_;               ///< Range images of the most recent scans.
};

}  // namespace skycap::missions::online
