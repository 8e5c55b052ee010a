/// Measured surface as a set of small planes, in which noise averages out, for comparison with new
/// scans.
///
/// A patch is the best-fitting plane of the points of a neighbourhood (principal_axes.h), if they
/// are sufficiently flat.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_grid.h"
#include "geometry/points/scan.h"
#include "geometry/points/spaced_points.h"

namespace skycap::geometry {

struct SurfacePatch {
  Eigen::Vector3d mean;    ///< world frame [m]
  Eigen::Vector3d normal;  ///< unit vector towards the sensor
  double deviation;        ///< standard deviation of the points across the plane [m]
};

/// Fits a plane to points that were measured from `sensor`. Points farther than two standard
/// deviations from a first plane are excluded. Returns nullopt if fewer than eight points remain,
/// if they are collinear, or if their spread across the plane exceeds half of that along it.
std::optional<SurfacePatch> fit_patch(std::span<const Eigen::Vector3f> points,
                                      const Eigen::Vector3d& sensor);

/// Patches of a growing cloud.
class SurfaceMap {
 public:
  /// A patch is the plane of the points within `radius` [m] of a point that were measured from the
  /// same side. A point spacing of a quarter of the radius is sufficient.
  explicit SurfaceMap(double radius);

  double radius() const { return radius_; }

  /// Adds points that were measured from `sensor`.
  void add(std::span<const Eigen::Vector3f> points, const Eigen::Vector3d& sensor);

  /// Returns points of the cloud with a spacing of half the radius.
  const PointGrid& spread_points() const { return seeds_.grid(); }

  /// Returns the patch around a spread point, or nullopt if the surface is not flat there. The
  /// patch is computed on first use.
  const std::optional<SurfacePatch>& patch_at(std::uint32_t spread_point);

  /// Returns the nearest patch of the map within `reach` of the mean of `patch`, or null. Normals
  /// may differ by up to 60 degrees. Not thread-safe, because patches are computed on first use.
  const SurfacePatch* nearest(const SurfacePatch& patch, double reach);

 private:
  struct Seed {
    std::uint32_t sensor;
    bool is_made = false;
    std::optional<SurfacePatch> patch;
  };
  std::optional<SurfacePatch> fit(const std::vector<Neighbour>& points,
                                  const Eigen::Vector3d& sensor) const;

  double radius_;
  SpacedPoints points_;
  SpacedPoints seeds_;
  std::vector<std::uint32_t> sensor_indices_;
  std::vector<Eigen::Vector3d> sensors_;
  std::vector<Seed> patches_;        // by seed index
  std::vector<std::uint32_t> made_;  // seeds whose patches were computed since the last add()
  std::vector<Neighbour> found_;     // scratch array
};

/// Patches of a scan.
struct ScanPatches {
  std::vector<SurfacePatch> patches;
  std::size_t tried = 0;  ///< number of evaluated positions, flat or not
};

/// Returns the patches with radius `radius` [m] at up to `max_patches` positions, computed from
/// about `max_points` points. Positions and points are distributed evenly over the scan.
ScanPatches scan_patches(const ScanSpan& scan, double radius, std::size_t max_points,
                         std::size_t max_patches);

}  // namespace skycap::geometry
