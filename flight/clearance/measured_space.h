/// Free space from measurements. Only space observed as free counts as free.
///
/// Space is divided into voxels. A voxel becomes free if all of it lies in front of the
/// measurements of one sensor pose. That requires farther measurements in every pixel that its
/// bounding sphere touches, and in a border of one pixel around them. The method is exact except
/// for objects thinner than the gap between neighbouring rays, which a sensor cannot detect. A
/// voxel with a measured point remains occupied permanently.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/clearance.h"
#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"

namespace skycap::flight {

struct MeasuredSpaceConfig {
  /// Edge length of a voxel [m]. A quarter of the clearance or less is recommended.
  double voxel = 0.25;
  /// Distance between free space and a measurement in front of it, for noise and pose errors [m].
  double depth_margin = 0.1;
  /// Depth up to which a no-return pixel proves free space [m]. 0: such pixels prove nothing, which
  /// is right for sensors that miss dark, shiny or thin objects. For a sensor with a return from
  /// every object in range, use that range.
  double free_without_return = 0.0;
  /// Depth limit: farther measurements prove free space only up to here [m].
  double max_depth = 60.0;
  /// Region in which space must be measured to count as free, extended to whole voxels. Outside,
  /// everything except measured points is assumed free, and the pilot must check it. Empty
  /// (default): everywhere.
  Eigen::AlignedBox3d region;
  /// Further regions in which space must be measured to count as free. They belong to other surveys
  /// and require a region of this one. Their measurements are stored. They do not count in the
  /// volume or, in a space read from a file, as obstacles.
  std::vector<Eigen::AlignedBox3d> extra_boxes;
  /// Points below this height are discarded, because the ground is known more exactly from other
  /// data [m].
  std::optional<double> floor;

  /// Throws Error{bad_config} naming the first value outside its interval.
  void validate() const;
};

/// Ray pattern of a sensor without an image, such as a spinning laser scanner.
struct SweepRays {
  double spacing = 0.0;  ///< Maximum angle between neighbouring rays [rad], in (0, 1).
  /// Rotation axis in the scan's frame. Rows of rays form cones around it.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();
  /// Maximum distance between ray origins and the scan position, as for a revolution in flight [m].
  double origin_spread = 0.0;
  /// Rays have no row pattern, or a random one. A cell then counts only if all eight neighbours
  /// have returns, with the minimum depth of all nine. Free space is then well inside the scanned
  /// directions, with rays on all sides at most two cells away.
  bool is_scattered = false;
};

/// Free space accumulated from scans. Queries may run concurrently with each other, but not with
/// insertions.
class MeasuredSpace : public FreeSpace {
 public:
  /// Throws the same errors as MeasuredSpaceConfig::validate().
  explicit MeasuredSpace(const MeasuredSpaceConfig& config = {});
  ~MeasuredSpace() override;
  MeasuredSpace(MeasuredSpace&&) noexcept;
  MeasuredSpace& operator=(MeasuredSpace&&) noexcept;

  /// Marks all voxels entirely inside the sphere or box as free without measurement, such as at the
  /// start position. The pilot must check that space.
  void declare_free(const Eigen::Vector3d& centre, double radius);
  void declare_free(const Eigen::AlignedBox3d& box);

  /// Adds an organised scan. The result does not depend on `threads` (0: all processors). Throws
  /// Error{bad_geometry} if points lack pixels, or if a pixel is outside the camera image.
  void insert(const geometry::Scan& scan, const geometry::Camera& camera, unsigned threads = 1);

  /// Adds a scan of a sensor without an image, such as a LiDAR. Cells as wide as the ray spacing
  /// that have no return prove nothing. Throws Error{bad_config} unless 0 < spacing < 1.
  void insert(const geometry::Scan& scan, const SweepRays& rays, unsigned threads = 1);
  void insert(const geometry::Scan& scan, double ray_spacing) {
    insert(scan, SweepRays{.spacing = ray_spacing});
  }

  /// Adds only the obstacles of a scan that cannot prove space free.
  void insert_points(const geometry::Scan& scan, unsigned threads = 1);

  /// Copies the free space, but not the occupied space, of another survey in the same frame. Only
  /// blocks that intersect the region are copied. Throws Error{bad_config} if the voxel sizes
  /// differ.
  void merge_free(const MeasuredSpace& other);

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

  const MeasuredSpaceConfig& config() const;

  /// Returns a box around all stored blocks, free or occupied, and the region.
  Eigen::AlignedBox3d known_box() const;

  /// Returns the known free volume, limited to the region if one is set [m^3].
  double free_volume() const;

  /// Writes all data for read() on a machine with the same byte order. The format is: name and
  /// version, configuration, then each block of 8 x 8 x 8 voxels with its position.
  void write(std::ostream& stream) const;
  /// Throws Error{bad_file} with `name` unless the stream holds exactly the output of write().
  static MeasuredSpace read(std::istream& stream, const std::string& name);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::flight
