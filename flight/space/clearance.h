/// Proof that a straight leg keeps its distance from everything that is not known to be free.
///
/// Nothing here samples: the distance of a leg is the exact minimum over all its points, from which
/// a guard against rounding is subtracted before it is compared. What counts as "not free" is
/// behind one interface: a scene known in advance (KnownSpace, here) or only what has been measured
/// so far (MeasuredSpace, measured_space.h).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/space/obstacles.h"
#include "flight/space/segment_distance.h"

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

/// The place where a leg comes nearest to something that is not free.
struct Closest {
  double distance;                         ///< zero when touching or inside
  ObstacleKind kind = ObstacleKind::none;  ///< `none`: nothing nearer than was asked for
  std::uint32_t index = 0;                 ///< triangle, point or no-fly volume; part of a prior
  Eigen::Vector3d on_leg = Eigen::Vector3d::Zero();
  Eigen::Vector3d on_obstacle = Eigen::Vector3d::Zero();
  std::uint32_t owner = 0;  ///< the prior that it is a part of
};

/// What is known to be free. Implementations are safe to query from several threads.
class FreeSpace {
 public:
  virtual ~FreeSpace() = default;

  /// The nearest thing to the leg that is not known to be free, looked for up to `up_to`:
  /// `distance` is exact where it is smaller than `up_to`, else it is `up_to`. Never above the
  /// true distance by more than rounding (1e-7 m).
  virtual Closest closest(const Segment& leg, double up_to) const = 0;

  /// Whether nothing that is not known to be free comes within `clearance` of the leg. Assumes that
  /// the leg's start is itself that free: then a solid cannot be entered without coming near its
  /// surface, and the costly test for being inside one is spared.
  virtual bool continues_free(const Segment& leg, double clearance) const = 0;

  /// A box outside of which everything is as free, or as unknown, as on its border: paths need not
  /// leave it by more than their clearance. Empty when nothing is in the way.
  virtual Eigen::AlignedBox3d extent() const = 0;

  /// What an obstacle is called in messages; empty if this space has no obstacles of its kind.
  virtual std::string name(const Closest& closest) const = 0;

  /// Distance of a point to the nearest surface, up to `up_to`: distance() without the costly test
  /// for being inside a solid. For searches that reach a place by proven legs only.
  virtual double surface_distance(const Eigen::Vector3d& point, double up_to) const {
    return distance(point, up_to);
  }

  /// closest() and continues_free() without the assumption.
  bool is_free(const Segment& leg, double clearance) const;
  double distance(const Eigen::Vector3d& point, double up_to) const;
};

/// Subtracted from every distance before it counts as proved: more than the rounding of the exact
/// formulas for legs below 1 km in a frame below 10 km.
inline constexpr double clearance_guard = 1e-6;

/// What is certified of a leg.
struct LegProof {
  bool is_proven;    ///< no point of the leg is nearer than the clearance to anything not free
  double clearance;  ///< proven lower bound of the leg's distance, at most `up_to` of prove()
  Closest closest;
};

/// Proves a leg at `clearance`, looking at most `up_to` far (more tells by how much it is better).
LegProof prove(const FreeSpace& space, const Segment& leg, double clearance,
               double up_to = std::numeric_limits<double>::infinity());

/// A scene that is known in advance.
class KnownSpace : public FreeSpace {
 public:
  /// Throws what validate(obstacles) throws. Keeps no reference.
  explicit KnownSpace(const Obstacles& obstacles);
  ~KnownSpace() override;
  KnownSpace(KnownSpace&&) noexcept;
  KnownSpace& operator=(KnownSpace&&) noexcept;

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  double surface_distance(const Eigen::Vector3d& point, double up_to) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Free is what is free in every one of several spaces, such as what was measured and what the
/// rules allow. Keeps references: the spaces must outlive it.
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
