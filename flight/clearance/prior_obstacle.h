/// Obstacle from a map, a model or an earlier scan. All space within `uncertainty` of it counts as
/// occupied. It never marks space as free.
///
/// Distances are exact with respect to the data, minus the uncertainty. The interior of solids and
/// columns is occupied as well. Height models become columns: each cell is solid from its top
/// downwards without limit, which includes the space under roofs and tree crowns.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/clearance.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

/// Named surface, such as a building. The interior of a closed part counts as occupied (winding.h).
struct NamedSurface {
  std::string name;  ///< Empty: messages use only the name of the obstacle.
  geometry::Mesh mesh;
};

struct PriorObstacleConfig {
  std::string name;  ///< Name for messages, such as "the prior tile.gml".
  std::vector<NamedSurface> surfaces;
  std::vector<Eigen::Vector3f> points;
  /// At least the maximum distance from a surface to its closest point [m].
  double point_radius = 0.0;
  std::vector<Eigen::AlignedBox3d> columns;  ///< Solid columns. Their lower ends are ignored.
  double uncertainty = 0.0;                  ///< Maximum position error of all parts [m].
  bool is_ground = false;                    ///< True if pads and rally points stand on it.

  /// Throws Error{bad_config} or Error{bad_geometry} naming the invalid part.
  void validate() const;
};

/// Immutable and shared, so that the search trees of a city are built only once.
class PriorObstacle final : public FreeSpace {
 public:
  /// Throws the same errors as config.validate(). Keeps no reference.
  explicit PriorObstacle(const PriorObstacleConfig& config);
  ~PriorObstacle() override;

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  double surface_distance(const Eigen::Vector3d& point, double up_to) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

  double uncertainty() const;
  /// Returns true if a climb from a pad ignores this obstacle near the ground. That holds for
  /// points and columns, which are measured from above, and for declared ground: the pad stands on
  /// them.
  bool is_ground() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace skycap::flight
