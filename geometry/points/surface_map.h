/// What was measured as a surface to be compared with: small planes in which noise averages out.
///
/// A patch is the plane that fits the points of a neighbourhood best (principal_axes.h), if they
/// are flat enough for one.
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
  Eigen::Vector3d mean;    ///< world frame, as all here
  Eigen::Vector3d normal;  ///< unit, towards where it was measured from
  double deviation;        ///< standard deviation of its points across the plane
};

/// The plane of points that were measured from `sensor`; of what lies within two standard
/// deviations of a first one. Nothing if they are fewer than eight, lie along a line, or spread
/// across the plane by more than half as far as along it.
std::optional<SurfacePatch> fit_patch(std::span<const Eigen::Vector3f> points,
                                      const Eigen::Vector3d& sensor);

/// The patches of a growing cloud.
class SurfaceMap {
 public:
  /// A patch is the plane of the points within `radius` of a point, measured from the same side;
  /// points a quarter of it apart are enough.
  explicit SurfaceMap(double radius);

  double radius() const { return radius_; }

  /// Adds points that were measured from `sensor`.
  void add(std::span<const Eigen::Vector3f> points, const Eigen::Vector3d& sensor);

  /// Points of the cloud, half a radius apart.
  const PointGrid& spread_points() const { return seeds_.grid(); }

  /// The patch round one of them, if the surface is flat there; made when it is first asked for.
  const std::optional<SurfacePatch>& patch_at(std::uint32_t spread_point);

  /// The nearest patch of the map, of those within `reach` of the patch's mean that face about the
  /// same way (60 degrees). Not for several threads at once: patches are made on the way.
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
  std::vector<std::uint32_t> sensor_of_point_;
  std::vector<Eigen::Vector3d> sensors_;
  std::vector<Seed> patches_;        // by number of the seed
  std::vector<std::uint32_t> made_;  // seeds with patches since the last add()
  std::vector<Neighbour> found_;     // scratch
};

/// A scan as patches.
struct ScanPatches {
  std::vector<SurfacePatch> patches;
  std::size_t tried = 0;  ///< places, flat or not
};

/// The patches of radius `radius` at up to `most_patches` places, of about `most_points` points;
/// both are spread evenly over the scan.
ScanPatches scan_patches(const ScanSpan& scan, double radius, std::size_t most_points,
                         std::size_t most_patches);

}  // namespace skycap::geometry
