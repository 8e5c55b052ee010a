/// Where the carrier of a sensor can get to in the true scene: the places that are connected with
/// the start of a survey through space that a ball of some radius fits through. Sealed rooms are
/// not, nor are rooms whose doors are too narrow.
///
/// Method: an octree over the scene. A cell is open if every place in it is at least the radius
/// away from every triangle, by the exact distance of the cell's centre less its half diagonal;
/// cells that are not are divided down to cell(). Open cells that share a face are connected; what
/// is connected with the start is reached. So nothing is ever reached through a wall or a passage
/// narrower than twice the radius; a passage counts for sure if a ball of the radius and 1.74 cells
/// more fits through, and in between as the cells happen to lie. Everything outside of the scene's
/// box is open.
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

/// Immutable; safe to query from any number of threads.
class ReachableSpace {
 public:
  struct Config {
    double radius = 0.0;                   ///< that has to fit through; zero: any gap that is found
    std::optional<double> least_height;    ///< of ways: no way leads below this z
    std::optional<double> most_height;     ///< nor above this
    std::optional<Eigen::Vector3d> start;  ///< nothing: outside of the scene
    unsigned threads = 0;                  ///< zero: all processors; does not change the result
  };

  /// Whether the carrier gets straight from a place that is reached to a place near by. Must be
  /// safe to call from several threads.
  using Joins = std::function<bool(const Eigen::Vector3d& place, const Eigen::Vector3d& reached)>;

  /// Of a surface within a box; keeps no reference to it. `joins` is asked about the start only.
  ReachableSpace(const geometry::MeshDistance& surface, const Eigen::AlignedBox3d& box,
                 const Config& config, const Joins& joins);

  /// Whether a way leads to `place`: it is in a cell that is reached, or in one that is neither
  /// open nor closed as a whole and `joins` the nearest place of a reached cell, two cells away at
  /// most. Heights bound ways, not the place itself.
  bool leads_to(const Eigen::Vector3d& place, const Joins& joins) const;

  /// Whether anything is reached at all: not if the start is enclosed more tightly than cells tell.
  bool is_empty() const { return is_empty_; }

  /// The side of the finest cells: an eighth of the radius, or a 300th of the scene's longest side
  /// if that is more.
  double cell() const { return cell_; }

  /// How many cells there are of any size, for tests and benchmarks.
  std::size_t size() const { return nodes_.size(); }

  /// All of it for a file, for read() on a machine of the same byte order.
  std::string bytes() const;
  /// What bytes() gave; nothing if it is anything else.
  static std::optional<ReachableSpace> read(std::string_view bytes);

 private:
  ReachableSpace() = default;
  static bool is_leaf(std::uint32_t node);
  bool is_whole() const;
  using Place = std::array<std::int32_t, 3>;  // in finest cells from the domain's corner
  struct Cell {
    std::uint32_t node = 0;
    Place corner{};
    std::int32_t size = 0;  // [finest cells]
  };

  void lay_out(Eigen::AlignedBox3d box, const Config& config);
  void grow(const geometry::MeshDistance& surface, const Config& config);
  std::vector<std::uint32_t> states_of(std::span<const Cell> cells,
                                       const geometry::MeshDistance& surface,
                                       const Config& config) const;
  std::uint32_t merged(std::uint32_t node, std::vector<std::uint32_t>& nodes) const;
  void reach(const Cell& cell, std::vector<Cell>& pending);
  void reach_outside(std::vector<Cell>& pending);
  void flood(std::vector<Cell> pending);

  Place place_of(const Eigen::Vector3d& point) const;
  bool is_inside(const Place& place) const;
  Eigen::AlignedBox3d box_of(const Cell& cell) const;
  Eigen::Vector3d nearest(const Cell& cell, const Eigen::Vector3d& place) const;
  // The leaf that holds `place`, or the cell of that size which does if there are finer ones.
  Cell cell_at(const Place& place, std::int32_t least_size) const;
  // The leaves of a cell that touch one of its faces.
  template <class Visit>
  void visit_face(const Cell& cell, std::size_t axis, bool is_upper, const Visit& visit) const;
  // Leaves around a place, nearest first, until `visit` says that it is enough; whether it did.
  template <class Visit>
  bool visit_near(const Eigen::Vector3d& point, const Visit& visit) const;

  double cell_ = 0.0;
  std::int32_t width_ = 1;                            // of the domain, a cube [finest cells]
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // its least corner
  bool is_floored_ = false;                           // its base is the least height
  bool is_outside_reached_ = false;
  bool is_empty_ = true;
  std::vector<std::uint32_t> nodes_;  // state of a leaf, or the first of eight children
};

}  // namespace skycap::missions::evaluation
