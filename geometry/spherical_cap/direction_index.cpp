#include "geometry/spherical_cap/direction_index.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

constexpr double slot_tolerance = 1e-5;  // maximum distance of a direction outside its cell

// About 1.5 pi R^2 of the R^3 cells intersect the sphere. A query reads all of these cells and the
// members of the few that can contain the result. This R balances both costs.
int cells_per_edge(std::size_t count) {
  return std::clamp(static_cast<int>(std::sqrt(static_cast<double>(count) / 47.0)), 2, 32);
}

}  // namespace

DirectionIndex::DirectionIndex(std::span<const Vector3d> directions) {
  assert(!directions.empty());
  const int edge = cells_per_edge(directions.size());
  half_edge_ = 1.0 / edge;
  // Slightly less than edge / 2, so that a coordinate rounded up from 1 stays in the last slot.
  const double scale = 0.5 * edge * (1.0 - slot_tolerance);
  std::vector<std::uint16_t> cell_indices(directions.size());  // edge^3 <= 2^15
  std::vector<std::uint32_t> next_index(static_cast<std::size_t>(edge * edge * edge), 0);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Vector3d& q = directions[i];
    assert(std::abs(q.squaredNorm() - 1.0) < 2e-6);
    const int x = static_cast<int>((q.x() + 1.0) * scale);
    const int y = static_cast<int>((q.y() + 1.0) * scale);
    const int z = static_cast<int>((q.z() + 1.0) * scale);
    cell_indices[i] = static_cast<std::uint16_t>((z * edge + y) * edge + x);
    ++next_index[cell_indices[i]];
  }

  std::vector<Vector3d> centres;
  std::uint32_t begin = 0;
  for (std::size_t cell = 0; cell < next_index.size(); ++cell) {
    const std::uint32_t members = next_index[cell];
    if (members == 0) continue;
    const int index = static_cast<int>(cell);
    const Eigen::Array3i slots(index % edge, index / edge % edge, index / (edge * edge));
    centres.emplace_back((2.0 * slots.cast<double>() + 1.0) * half_edge_ - 1.0);
    cell_begin_.push_back(begin);
    next_index[cell] = begin;
    begin += members;
  }
  cell_begin_.push_back(begin);

  members_.resize(directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    members_[next_index[cell_indices[i]]++] = directions[i];
  }

  const auto cells = static_cast<Eigen::Index>(centres.size());
  const Eigen::Map<const Eigen::Matrix3Xd> matrix(centres.front().data(), 3, cells);
  cell_x_ = matrix.row(0).array();
  cell_y_ = matrix.row(1).array();
  cell_z_ = matrix.row(2).array();
  cell_distance2_.resize(cells);
}

void DirectionIndex::search_cell(std::size_t cell, const Vector3d& s, double& best,
                                 std::size_t& best_member) const {
  for (std::size_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
    const double cosine = members_[i].dot(s);
    if (cosine > best) {
      best = cosine;
      best_member = i;
    }
  }
}

DirectionIndex::Nearest DirectionIndex::nearest(const Vector3d& s) {
  assert(std::abs(s.squaredNorm() - 1.0) < 2e-6);
  // Squared distance of s from each box, and the box nearest to s.
  const double half = half_edge_ + slot_tolerance;
  cell_distance2_ = ((cell_x_ - s.x()).abs() - half).max(0.0).square() +
                    ((cell_y_ - s.y()).abs() - half).max(0.0).square() +
                    ((cell_z_ - s.z()).abs() - half).max(0.0).square();
  Eigen::Index likely = 0;
  cell_distance2_.minCoeff(&likely);

  double best = -std::numeric_limits<double>::infinity();
  std::size_t best_member = 0;
  search_cell(static_cast<std::size_t>(likely), s, best, best_member);
  for (Eigen::Index cell = 0; cell < cell_distance2_.size(); ++cell) {
    // |s - q|^2 = 2 - 2 s.q for unit vectors; 1e-5 covers rounding errors.
    if (cell_distance2_[cell] > 2.0 - 2.0 * best + 1e-5 || cell == likely) continue;
    search_cell(static_cast<std::size_t>(cell), s, best, best_member);
  }
  return {members_[best_member], best};
}

}  // namespace skycap::geometry
