/// Unit directions made ready for many queries "which of them is nearest to s?".
///
/// A coarse uniform grid over the cube [-1, 1]^3 has few cells that the unit sphere touches. One
/// pass over the occupied ones excludes nearly all of them by their distance from s, and only the
/// directions in the others are looked at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

class DirectionIndex {
 public:
  struct Nearest {
    Eigen::Vector3d direction;  ///< a member of the set
    double cosine;              ///< its dot product with the direction that was asked for
  };

  /// `directions` are of unit length (to 1e-6) and at least one. O(n), about 10 ns each.
  explicit DirectionIndex(std::span<const Eigen::Vector3d> directions);

  /// The member q with the largest dot product q.s; exact, the same one for the same set and s. `s`
  /// is of unit length (to 1e-6). A few microseconds for 30,000 directions. Works in a scratch
  /// array of the index: one index serves one thread.
  Nearest nearest(const Eigen::Vector3d& s);

  /// All of the set, near ones near each other.
  std::span<const Eigen::Vector3d> members() const { return members_; }

 private:
  void look_into_cell(std::size_t cell, const Eigen::Vector3d& s, double& best,
                      std::size_t& best_member) const;

  // Members ordered by cell; cell i holds [cell_begin_[i], cell_begin_[i + 1]).
  std::vector<Eigen::Vector3d> members_;
  std::vector<std::uint32_t> cell_begin_;
  Eigen::ArrayXd cell_x_, cell_y_, cell_z_;  // centres of the occupied cells
  Eigen::ArrayXd cell_distance2_;            // scratch: from s
  double half_edge_ = 0.0;
};

}  // namespace skycap::geometry
