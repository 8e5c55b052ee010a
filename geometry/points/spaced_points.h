/// Clouds at a least spacing: which points of a scan have room beside those kept before is the
/// first thing every planner asks.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geometry/parallel.h"
#include "geometry/points/point_grid.h"

namespace skycap::geometry {

/// Asks a grid whether it has a point within a radius, for queries in the order of a scan: what was
/// near to one is often near to the next, and is tried first. The grid may grow meanwhile.
class NearbyPoints {
 public:
  /// For queries of a radius up to the grid's cell_size().
  NearbyPoints(const PointGrid& grid, double radius)
      : grid_(grid), radius_(radius), squared_radius_(static_cast<float>(radius * radius)) {
    constexpr float far_away = 1e18F;  // its square is finite, and no query reaches it
    x_.fill(far_away);
    y_.fill(far_away);
    z_.fill(far_away);
  }

  /// Whether the grid has a point within the radius of `query`.
  bool any_near(const Eigen::Vector3f& query) {
    int near = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float x = query.x() - x_[i], y = query.y() - y_[i], z = query.z() - z_[i];
      near |= x * x + y * y + z * z <= squared_radius_ ? 1 : 0;
    }
    if (near != 0) return true;
    const std::uint32_t found = grid_.first_within(query, radius_);
    if (found == PointGrid::none) return false;
    const Eigen::Vector3f point = grid_.point(found);
    x_[next_] = point.x();
    y_[next_] = point.y();
    z_[next_] = point.z();
    next_ = (next_ + 1) % count;
    return true;
  }

 private:
  static constexpr std::size_t count = 8;  // a vector of floats

  const PointGrid& grid_;
  double radius_;
  float squared_radius_;
  std::array<float, count> x_, y_, z_;  // the last points found
  std::size_t next_ = 0;
};

/// The same for the pixels of an image, row by row: what was near to the pixel above or to the one
/// on the left is mostly near to this one, too.
class RowNeighbours {
 public:
  /// For images of so many columns, and a radius up to the grid's cell_size().
  RowNeighbours(const PointGrid& grid, double radius, std::size_t columns)
      : grid_(grid),
        radius_(radius),
        squared_radius_(static_cast<float>(radius * radius)),
        found_(columns + 2, Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity())) {}

  /// Whether the grid has a point within the radius of `query`, which is of that column.
  bool any_near(const Eigen::Vector3f& query, std::size_t column) {
    Eigen::Vector3f* const above = &found_[column + 1];
    if (squared_distance(*above, query) <= squared_radius_) return true;
    for (const int beside : {-1, 1}) {
      if (squared_distance(above[beside], query) > squared_radius_) continue;
      *above = above[beside];
      return true;
    }
    const std::uint32_t found = grid_.first_within(query, radius_);
    if (found == PointGrid::none) return false;
    *above = grid_.point(found);
    return true;
  }

  /// A point that is now in the grid, of that column.
  void remember(const Eigen::Vector3f& point, std::size_t column) { found_[column + 1] = point; }

 private:
  const PointGrid& grid_;
  double radius_;
  float squared_radius_;
  std::vector<Eigen::Vector3f> found_;  // by column; one more before them and one behind
};

/// Points of which none is nearer to an earlier one than a spacing. What is kept depends on the
/// order of the points alone, not on the cells of the grid.
class SpacedPoints {
 public:
  /// Cells twice as wide as the spacing by default: a ball of that radius then reaches eight of
  /// them. Points nearer together than the spacing do not exist, however small the cells.
  explicit SpacedPoints(double spacing) : SpacedPoints(spacing, 2.0 * spacing) {}
  SpacedPoints(double spacing, double cell_size)
      : spacing_(spacing), grid_(cell_size), nearby_(grid_, spacing) {}
  SpacedPoints(const SpacedPoints&) = delete;
  SpacedPoints& operator=(const SpacedPoints&) = delete;

  /// Keeps the point if none that was kept is within the spacing; says whether it did.
  bool keep(const Eigen::Vector3f& point) {
    if (nearby_.any_near(point)) return false;
    grid_.insert(point);
    return true;
  }

  /// The same for all points of a scan, in the order in which `visit_part(part, visit)`, for one
  /// part of it after the other, calls `visit(number, column)`; columns are less than `columns`,
  /// and points that follow each other in one are neighbours (an image's, say). `on_kept(number)`
  /// is told of those that are kept, in that order. With several threads parts are visited at the
  /// same time, which changes nothing of what is kept.
  template <typename VisitPart, typename OnKept>
  void keep_all(std::span<const Eigen::Vector3f> points, std::size_t columns, std::size_t parts,
                unsigned threads, VisitPart visit_part, OnKept on_kept);

  /// The points that were kept, in that order.
  const PointGrid& grid() const { return grid_; }
  double spacing() const { return spacing_; }

 private:
  struct Candidate {
    std::uint32_t number, column;
  };
  template <typename VisitPart>
  std::vector<std::uint32_t> with_room(std::span<const Eigen::Vector3f> points, std::size_t columns,
                                       std::size_t parts, unsigned threads,
                                       VisitPart visit_part) const;

  double spacing_;
  PointGrid grid_;
  NearbyPoints nearby_;
};

template <typename VisitPart, typename OnKept>
void SpacedPoints::keep_all(std::span<const Eigen::Vector3f> points, std::size_t columns,
                            std::size_t parts, unsigned threads, VisitPart visit_part,
                            OnKept on_kept) {
  if (thread_count(threads) == 1 || grid_.size() == 0) {
    RowNeighbours near(grid_, spacing_, columns);
    for (std::size_t part = 0; part < parts; ++part) {
      visit_part(part, [&](std::uint32_t number, std::size_t column) {
        if (near.any_near(points[number], column)) return;
        grid_.insert(points[number]);
        near.remember(points[number], column);
        on_kept(number);
      });
    }
    return;
  }
  const std::vector<std::uint32_t> kept = with_room(points, columns, parts, threads, visit_part);
  parallel_for(2, threads, [&](std::size_t task) {
    if (task == 0) {
      for (const std::uint32_t number : kept) on_kept(number);
    } else {
      for (const std::uint32_t number : kept) grid_.insert(points[number]);
    }
  });
}

// Which points have room depends on their order, but whether one is too near to an earlier scan's
// does not: that is found out on all threads and turns most away, while those of the parts before
// that it left are compared with each other.
template <typename VisitPart>
std::vector<std::uint32_t> SpacedPoints::with_room(std::span<const Eigen::Vector3f> points,
                                                   std::size_t columns, std::size_t parts,
                                                   unsigned threads, VisitPart visit_part) const {
  constexpr std::size_t parts_at_once = 8;
  PointGrid fresh(grid_.cell_size());
  RowNeighbours near_fresh(fresh, spacing_, columns);
  std::vector<std::uint32_t> kept;
  const auto compare = [&](const std::vector<Candidate>& candidates) {
    for (const auto& [number, column] : candidates) {
      if (near_fresh.any_near(points[number], column)) continue;
      fresh.insert(points[number]);
      near_fresh.remember(points[number], column);
      kept.push_back(number);
    }
  };
  std::vector<std::vector<Candidate>> before, now;
  for (std::size_t first = 0; first < parts || !before.empty(); first += parts_at_once) {
    now.resize(first < parts ? std::min(parts_at_once, parts - first) : 0);
    parallel_for(now.size() + 1, threads, [&](std::size_t task) {
      if (task == 0) {
        std::ranges::for_each(before, compare);
        return;
      }
      RowNeighbours near_earlier(grid_, spacing_, columns);
      std::vector<Candidate> candidates;
      visit_part(first + task - 1, [&](std::uint32_t number, std::size_t column) {
        if (near_earlier.any_near(points[number], column)) return;
        candidates.push_back({number, static_cast<std::uint32_t>(column)});
      });
      now[task - 1] = std::move(candidates);
    });
    before.swap(now);
  }
  return kept;
}

}  // namespace skycap::geometry
