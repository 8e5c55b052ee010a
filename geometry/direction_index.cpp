#include "geometry/direction_index.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

// About 1.5 pi R^2 of the R^3 cells touch the sphere. A query passes over all of these, and over
// the members of the few that can hold the answer: this R balances the two.
int cells_per_edge(std::size_t count) {
  return std::clamp(static_cast<int>(std::sqrt(static_cast<double>(count) / 47.0)), 2, 32);
}

}  // namespace

DirectionIndex::DirectionIndex(std::span<const Vector3d> directions) {
  assert(!directions.empty());
  const int edge = cells_per_edge(directions.size());
  half_edge_ = 1.0 / edge;
  const auto slot = [edge](double coordinate) {
    return std::clamp(static_cast<int>((coordinate + 1.0) * 0.5 * edge), 0, edge - 1);
  };

  std::vector<std::uint16_t> cell_of(directions.size());  // edge^3 <= 2^15
  std::vector<std::uint32_t> place(static_cast<std::size_t>(edge * edge * edge), 0);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Vector3d& q = directions[i];
    assert(std::abs(q.squaredNorm() - 1.0) < 2e-6);
    cell_of[i] =
        static_cast<std::uint16_t>((slot(q.z()) * edge + slot(q.y())) * edge + slot(q.x()));
    ++place[cell_of[i]];
  }

  std::vector<Vector3d> centres;
  std::uint32_t begin = 0;
  for (std::size_t cell = 0; cell < place.size(); ++cell) {
    const std::uint32_t members = place[cell];
    if (members == 0) continue;
    const int index = static_cast<int>(cell);
    const Eigen::Array3d position(index % edge, index / edge % edge, index / (edge * edge));
    centres.emplace_back((2.0 * position + 1.0) * half_edge_ - 1.0);
    cell_begin_.push_back(begin);
    place[cell] = begin;
    begin += members;
  }
  cell_begin_.push_back(begin);

  x_.resize(directions.size());
  y_.resize(directions.size());
  z_.resize(directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const std::uint32_t to = place[cell_of[i]]++;
    x_[to] = directions[i].x();
    y_[to] = directions[i].y();
    z_[to] = directions[i].z();
  }

  const auto cells = static_cast<Eigen::Index>(centres.size());
  const Eigen::Map<const Eigen::Matrix3Xd> matrix(centres.front().data(), 3, cells);
  cell_x_ = matrix.row(0).array();
  cell_y_ = matrix.row(1).array();
  cell_z_ = matrix.row(2).array();
  cell_cosine_.resize(cells);
}

void DirectionIndex::look_into_cell(std::size_t cell, const Vector3d& s, double& best,
                                    std::size_t& best_member) const {
  for (std::size_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
    const double cosine = x_[i] * s.x() + y_[i] * s.y() + z_[i] * s.z();
    if (cosine > best) {
      best = cosine;
      best_member = i;
    }
  }
}

DirectionIndex::Nearest DirectionIndex::nearest(const Vector3d& s) {
  cell_cosine_ = cell_x_ * s.x() + cell_y_ * s.y() + cell_z_ * s.z();
  Eigen::Index likely = 0;
  cell_cosine_.maxCoeff(&likely);

  double best = -std::numeric_limits<double>::infinity();
  std::size_t best_member = 0;
  look_into_cell(static_cast<std::size_t>(likely), s, best, best_member);
  // Directions may stand out of their cell by the rounding of the slots, hence the small surplus.
  const double reach = half_edge_ * s.lpNorm<1>() * (1.0 + 1e-5);
  for (Eigen::Index cell = 0; cell < cell_cosine_.size(); ++cell) {
    if (cell_cosine_[cell] + reach < best || cell == likely) continue;
    look_into_cell(static_cast<std::size_t>(cell), s, best, best_member);
  }
  return {{x_[best_member], y_[best_member], z_[best_member]}, best};
}

}  // namespace skycap::geometry
