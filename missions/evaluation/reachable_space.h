/// Positions that a sensor platform can reach in the ground-truth scene. They are connected with
/// the start of a survey through space that a sphere of a given radius fits through. Closed rooms,
/// and rooms with narrower doors, are unreachable.
///
/// Method: an octree over the scene. A cell is open if every position in it is at least the radius
/// away from every triangle. The test uses the exact distance of the cell's centre minus half the
/// cell's diagonal, so it is conservative. Other cells are subdivided down to cell(). Open cells
/// that share a face are connected; cells connected with the start are reached. Walls and passages
/// narrower than twice the radius are therefore never passed. A passage is guaranteed to be found
/// if a sphere with the radius plus 1.74 cells fits through. Between these limits, the result
/// depends on the grid alignment. All space outside the scene's box is open.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/surfaces/mesh_distance.h"

namespace skycap::missions::evaluation {

/// Immutable after construction; may be queried concurrently.
class ReachableSpace {
 public:
  struct Config {
    double radius = 0.0;  ///< radius of the sphere [m]; zero: every gap that is resolved is passed
    std::optional<double> min_height;      ///< minimum z of paths [m]
    std::optional<double> max_height;      ///< maximum z of paths [m]
    std::optional<Eigen::Vector3d> start;  ///< empty: outside the scene
    unsigned threads = 0;                  ///< zero: one per processor; does not affect the result
  };

  /// Returns whether the platform can move straight from a reached position to a nearby position.
  /// Called concurrently from several threads.
  using Joins =
      std::function<bool(const Eigen::Vector3d& location, const Eigen::Vector3d& reached)>;

  /// Computes the reachable space of a surface within a box. No reference to `surface` is stored.
  /// `joins` is called only for the start.
  ReachableSpace(const geometry::MeshDistance& surface, const Eigen::AlignedBox3d& box,
                 const Config& config, const Joins& joins);

  /// Returns whether a path leads to `location`. This is the case if its cell is reached, or if its
  /// cell is closed and `joins` it with a reached cell at most two cells away. Height limits apply
  /// to paths but not to `location`.
  bool leads_to(const Eigen::Vector3d& location, const Joins& joins) const;

  /// Returns whether no cell is reached, because the start is enclosed more tightly than cells
  /// resolve.
  bool is_empty() const { return is_empty_; }

  /// Returns the size of the finest cells [m]: an eighth of the radius, or 1/300 of the scene's
  /// longest side if that is larger.
  double cell() const { return cell_; }

  /// Returns the number of nodes, for tests and benchmarks.
  std::size_t size() const { return nodes_.size(); }

  /// Serialises the object. The format depends on the machine's byte order.
  std::string bytes() const;
  /// Restores an object from bytes(). Returns nullopt if the data is invalid.
  static std::optional<ReachableSpace> read(std::string_view bytes);

 private:
  ReachableSpace() = default;
  static bool is_leaf(std::uint32_t node);
  bool is_whole() const;
  using GridPoint = std::array<std::int32_t, 3>;  // in finest cells from the corner of the domain
  struct Cell {
    std::uint32_t node = 0;
    GridPoint corner{};
    std::int32_t size = 0;  // in finest cells
  };

  void lay_out(Eigen::AlignedBox3d box, const Config& config);
  void grow(const geometry::MeshDistance& surface, const Config& config);
  std::vector<std::uint32_t> compute_states(std::span<const Cell> cells,
                                            const geometry::MeshDistance& surface,
                                            const Config& config) const;
  std::uint32_t merged(std::uint32_t node, std::vector<std::uint32_t>& nodes) const;
  void reach(const Cell& cell, std::vector<Cell>& pending);
  void reach_outside(std::vector<Cell>& pending);
  void flood(std::vector<Cell> pending);

  GridPoint grid_point(const Eigen::Vector3d& point) const;
  bool is_inside(const GridPoint& location) const;
  Eigen::AlignedBox3d cell_box(const Cell& cell) const;
  Eigen::Vector3d nearest(const Cell& cell, const Eigen::Vector3d& location) const;
  // Returns the leaf that contains `location`, or the inner cell of `min_size` if the leaf is
  // smaller.
  Cell cell_at(const GridPoint& location, std::int32_t min_size) const;
  // Visits the leaves of a cell that touch one of its faces.
  template <class Visit>
  void visit_face(const Cell& cell, std::size_t axis, bool is_upper, const Visit& visit) const;
  // Visits leaves around a position, nearest first, until `visit` returns true. Returns whether it
  // did.
  template <class Visit>
  bool visit_near(const Eigen::Vector3d& point, const Visit& visit) const;

  double cell_ = 0.0;
  std::int32_t width_ = 1;                            // side of the cubic domain, in finest cells
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // minimum corner of the domain [m]
  bool is_floored_ = false;                           // whether its base is the minimum height
  bool is_outside_reached_ = false;
  bool is_empty_ = true;
  std::vector<std::uint32_t> nodes_;  // state of a leaf, or index of the first of eight children
};

}  // namespace skycap::missions::evaluation
