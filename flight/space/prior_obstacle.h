/// What is in the way by a map, a model or an earlier scan, and is known only about: everything
/// within `uncertainty` of it is in the way, too. It never says that space is free.
///
/// Distances are exact to what is given, less the uncertainty; solids and columns are in the way
/// inside as well. Height models are columns: each cell is solid from its top down without end, so
/// that whatever lies under a roof or a crown is in the way.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/space/clearance.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

/// A closed or open surface with a name, such as a building. Being inside is as bad as touching it,
/// as far as it is closed (winding.h).
struct NamedSurface {
  std::string name;  ///< empty: called by the obstacle's name alone
  geometry::Mesh mesh;
};

struct PriorObstacleConfig {
  std::string name;  ///< for messages, such as "the prior tile.gml"
  std::vector<NamedSurface> surfaces;
  std::vector<Eigen::Vector3f> points;
  double point_radius = 0.0;  ///< at least the distance from any surface to the nearest point
  std::vector<Eigen::AlignedBox3d> columns;  ///< their lower ends do not count
  double uncertainty = 0.0;                  ///< bound of how far off all that may be
  bool is_ground = false;                    ///< what pads and rally points stand on

  /// Throws Error{bad_config} or Error{bad_geometry} naming what cannot be worked with.
  void validate() const;
};

/// Immutable, and shared by all who ask: trees over a city are not built twice.
class PriorObstacle final : public FreeSpace {
 public:
  /// Throws what config.validate() throws. Keeps no reference.
  explicit PriorObstacle(const PriorObstacleConfig& config);
  ~PriorObstacle() override;

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  double surface_distance(const Eigen::Vector3d& point, double up_to) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

  double uncertainty() const;
  /// Whether a climb from a pad is not judged by it near the ground: what is measured from above,
  /// points and columns, and what is said to be the ground, are the place the pad stands on.
  bool is_ground() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace skycap::flight
