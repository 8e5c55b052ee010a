/// Verification that a straight leg keeps its clearance from all space that is not known to be
/// free.
///
/// No sampling is involved. The distance of a leg is the exact minimum over all its points, minus a
/// guard for rounding. The interface FreeSpace defines what is free: a known scene (KnownSpace,
/// here) or measured space (MeasuredSpace, measured_space.h).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/obstacles.h"
#include "flight/clearance/segment_distance.h"

namespace skycap::flight {

enum class ObstacleKind {
  none,
  mesh,
  point,
  no_fly,
  fence,
  ground,
  prior,
  unknown_space,
  occupied_space
};

/// Closest approach of a leg to an obstacle.
struct Closest {
  double distance;                         ///< Distance [m]. 0 for contact or penetration.
  ObstacleKind kind = ObstacleKind::none;  ///< `none`: no obstacle within the search distance.
  /// Index of the triangle, point or no-fly volume, or of the part of a prior.
  std::uint32_t index = 0;
  Eigen::Vector3d on_leg = Eigen::Vector3d::Zero();
  Eigen::Vector3d on_obstacle = Eigen::Vector3d::Zero();
  std::uint32_t owner = 0;  ///< Index of the prior that contains the part.
};

/// Free space. Implementations must be thread-safe for queries.
class FreeSpace {
 public:
  virtual ~FreeSpace() = default;

  /// Returns the obstacle closest to the leg within `up_to` [m]. `distance` is exact below `up_to`
  /// and equals `up_to` otherwise. It exceeds the true distance by no more than rounding (1e-7 m).
  virtual Closest closest(const Segment& leg, double up_to) const = 0;

  /// Returns true if the leg keeps `clearance` [m] from all obstacles. Assumes that the start of
  /// the leg keeps it: then entering a solid requires passing its surface, and the expensive inside
  /// test is unnecessary.
  virtual bool continues_free(const Segment& leg, double clearance) const = 0;

  /// Returns a box outside of which the state of space equals that on its border. Paths need not
  /// leave it by more than their clearance. Empty without obstacles.
  virtual Eigen::AlignedBox3d extent() const = 0;

  /// Returns the name of an obstacle for messages. Empty if this space has no obstacles of that
  /// kind.
  virtual std::string name(const Closest& closest) const = 0;

  /// Returns the distance from a point to the closest surface, at most `up_to` [m]. Unlike
  /// distance(), it omits the expensive inside test. Intended for searches that reach positions
  /// only along verified legs.
  virtual double surface_distance(const Eigen::Vector3d& point, double up_to) const {
    return distance(point, up_to);
  }

  /// Returns the result of continues_free() or closest() without assumptions about the start.
  bool is_free(const Segment& leg, double clearance) const;
  double distance(const Eigen::Vector3d& point, double up_to) const;
};

/// Subtracted from each distance before comparison [m]. Exceeds the rounding error of the exact
/// formulas for legs below 1 km in a frame below 10 km.
inline constexpr double clearance_guard = 1e-6;

/// Result of the verification of a leg.
struct LegVerification {
  bool is_verified;  ///< True if every point of the leg keeps the clearance.
  /// Verified lower bound on the distance between the leg and the nearest obstacle [m], at most
  /// `up_to` of verify().
  double clearance;
  Closest closest;
};

/// Verifies a leg at `clearance` [m]. The search extends to `up_to` [m]; a larger value also
/// determines the surplus.
LegVerification verify(const FreeSpace& space, const Segment& leg, double clearance,
                       double up_to = std::numeric_limits<double>::infinity());

/// Space around a scene that is known in advance.
class KnownSpace : public FreeSpace {
 public:
  /// Throws the same errors as validate(obstacles). Keeps no reference.
  explicit KnownSpace(const Obstacles& obstacles);
  ~KnownSpace() override;
  KnownSpace(KnownSpace&&) noexcept;
  KnownSpace& operator=(KnownSpace&&) noexcept;

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  double surface_distance(const Eigen::Vector3d& point, double up_to) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

  /// Returns the winding number of the mesh at a point: 0 outside and 1 inside a closed solid of
  /// any orientation. Values between occur near the holes of an open mesh (winding.h). A point
  /// counts as inside above 0.5. Returns 0 if the mesh is not solid.
  double winding_number(const Eigen::Vector3d& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Intersection of several free spaces, such as measured space and the airspace rules. Keeps
/// references to the spaces.
class JointSpace : public FreeSpace {
 public:
  explicit JointSpace(std::vector<const FreeSpace*> spaces) : spaces_(std::move(spaces)) {}

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  double surface_distance(const Eigen::Vector3d& point, double up_to) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

 private:
  std::vector<const FreeSpace*> spaces_;
};

}  // namespace skycap::flight
