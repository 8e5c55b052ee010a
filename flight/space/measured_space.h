/// Free space as far as it has been measured: what no measured ray has proven to be free is not
/// free.
///
/// Space is cut into voxels. A voxel becomes free when, from one sensor position, *all* of it lies
/// in front of what was measured: every pixel that its bounding ball touches, and a rim of one
/// pixel around them, saw something farther away. That is exact up to what a sensor cannot see at
/// all: things slimmer than the gap between two neighbouring rays. A voxel that holds a measured
/// point is occupied, for good.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/space/clearance.h"
#include "geometry/place/camera.h"
#include "geometry/points/scan.h"

namespace skycap::flight {

struct MeasuredSpaceConfig {
  double voxel = 0.25;        ///< edge of a voxel [m]; a quarter of the clearance or less is fine
  double depth_margin = 0.1;  ///< free space ends this far in front of a measurement: noise, pose
  /// Depth up to which a pixel without a return proves free space. Zero: such pixels prove nothing;
  /// right for sensors that may miss dark, shiny or thin things. For a sensor that returns all that
  /// is in range, that range.
  double free_without_return = 0.0;
  double max_depth = 60.0;  ///< measurements farther away prove free space up to here only
  /// Where space has to be measured to be free. Outside of it somebody else vouches for the
  /// airspace: there everything is free but measured points. Grows to whole voxels. Empty (as by
  /// default): everywhere.
  Eigen::AlignedBox3d region;
  /// Further boxes where space has to be measured to be free: regions of others, with a region of
  /// its own only. What is measured there is kept for them, but is neither in the volume nor, when
  /// it was read from a file, in the way.
  std::vector<Eigen::AlignedBox3d> beside;
  /// Points below this height, if it is given, are not kept: they are of the ground, which is known
  /// from elsewhere and exactly, not to a voxel.
  std::optional<double> floor;

  /// Throws Error{bad_config} naming the first value that is out of its interval.
  void validate() const;
};

/// How a sensor without an image, such as a spinning laser scanner, shoots around itself.
struct SweepRays {
  double spacing = 0.0;  ///< neighbouring rays are at most so far apart [rad], in (0, 1)
  /// Of the turn, in the scan's frame: rows of rays are cones about it.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();
  /// Rays may begin this far from the scan's own place, as those of a turn in flight do [m].
  double origin_spread = 0.0;
  /// Rays fall as in a pattern without rows, or as at random: a cell says something only if those
  /// around it do, too, and then what is nearest in all nine. So what is free is well inside of
  /// where the sensor looked, and every place in it has rays on all sides, two cells away at most.
  bool is_scattered = false;
};

/// Grows by insertion. Queries may run in parallel with each other, not with insertions.
class MeasuredSpace : public FreeSpace {
 public:
  /// Throws what MeasuredSpaceConfig::validate() throws.
  explicit MeasuredSpace(const MeasuredSpaceConfig& config = {});
  ~MeasuredSpace() override;
  MeasuredSpace(MeasuredSpace&&) noexcept;
  MeasuredSpace& operator=(MeasuredSpace&&) noexcept;

  /// What somebody vouches for, such as the place where the vehicle starts: all voxels wholly
  /// inside become free.
  void declare_free(const Eigen::Vector3d& centre, double radius);
  void declare_free(const Eigen::AlignedBox3d& box);

  /// Takes in an organised scan. Throws Error{bad_geometry} if the scan has points but no pixels,
  /// or a pixel that the camera does not have. What is known then does not depend on `threads`
  /// (zero: all processors).
  void insert(const geometry::Scan& scan, const geometry::Camera& camera, unsigned threads = 1);

  /// Takes in a scan of a sensor that looks around itself and has no image, such as a LiDAR:
  /// directions in which a cell as wide as its rays are apart got no return prove nothing. Throws
  /// Error{bad_config} unless 0 < spacing < 1.
  void insert(const geometry::Scan& scan, const SweepRays& rays, unsigned threads = 1);
  void insert(const geometry::Scan& scan, double ray_spacing) {
    insert(scan, SweepRays{.spacing = ray_spacing});
  }

  /// Takes in what is in the way, of a scan that proves nothing free.
  void insert_points(const geometry::Scan& scan, unsigned threads = 1);

  /// Takes over what another survey of the same frame has measured to be free, in blocks that meet
  /// the region; not what it has measured to be occupied. Throws Error{bad_config} if its voxels
  /// are of another size.
  void take_free(const MeasuredSpace& other);

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

  const MeasuredSpaceConfig& config() const;

  /// A box around all that is kept of places, free or not, and the region.
  Eigen::AlignedBox3d known_box() const;

  /// Volume known to be free [m^3], of the region if there is one.
  double free_volume() const;

  /// Writes all that is known, for read() on a machine of the same byte order. A name and version
  /// come first, then the configuration, then each block of 8 x 8 x 8 voxels by its place.
  void write(std::ostream& stream) const;
  /// Throws Error{bad_file} naming `name` unless it holds exactly what write() wrote.
  static MeasuredSpace read(std::istream& stream, const std::string& name);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::flight
