/// Downsampling to a minimum spacing. Selecting the points of a scan that are far enough from all
/// kept points is the first step of every planner.
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

/// Tests whether a grid has a point within a radius, for queries in scan order. Recently found
/// points are tested first, because consecutive queries are often close to the same point. The grid
/// may grow between queries.
class NearbyPoints {
 public:
  /// `radius` must not exceed the cell_size() of the grid.
  NearbyPoints(const PointGrid& grid, double radius)
      : grid_(grid), radius_(radius), squared_radius_(static_cast<float>(radius * radius)) {
    constexpr float far_away = 1e18F;  // The square is finite, and no query is within the radius.
    x_.fill(far_away);
    y_.fill(far_away);
    z_.fill(far_away);
  }

  /// Returns whether the grid has a point within the radius of `query`.
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
  static constexpr std::size_t count = 8;  // one vector register of floats

  const PointGrid& grid_;
  double radius_;
  float squared_radius_;
  std::array<float, count> x_, y_, z_;  // most recently found points
  std::size_t next_ = 0;
};

/// Tests whether a grid has a point within a radius, for the pixels of an image in row-major order.
/// The points found for the pixels above and to the left are tested first.
class RowNeighbours {
 public:
  /// `columns` is the image width. `radius` must not exceed the cell_size() of the grid.
  RowNeighbours(const PointGrid& grid, double radius, std::size_t columns)
      : grid_(grid),
        radius_(radius),
        squared_radius_(static_cast<float>(radius * radius)),
        found_(columns + 2, Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity())) {}

  /// Returns whether the grid has a point within the radius of `query`, which is in column
  /// `column`.
  bool any_near(const Eigen::Vector3f& query, std::size_t column) {
    Eigen::Vector3f* const above = &found_[column + 1];
    if (squared_distance(*above, query) <= squared_radius_) return true;
    for (const int side : {-1, 1}) {
      if (squared_distance(above[side], query) > squared_radius_) continue;
      *above = above[side];
      return true;
    }
    const std::uint32_t found = grid_.first_within(query, radius_);
    if (found == PointGrid::none) return false;
    *above = grid_.point(found);
    return true;
  }

  /// Records a point of column `column` that was inserted into the grid.
  void remember(const Eigen::Vector3f& point, std::size_t column) { found_[column + 1] = point; }

 private:
  const PointGrid& grid_;
  double radius_;
  float squared_radius_;
  std::vector<Eigen::Vector3f> found_;  // by column, with one more element at either end
};

/// Point set with a minimum distance between points. The kept points depend only on the order of
/// insertion, not on the grid cells.
class SpacedPoints {
 public:
  /// The default cell size is twice the spacing, so that a ball with that radius intersects eight
  /// cells. Smaller cells do not change the spacing.
  explicit SpacedPoints(double spacing) : SpacedPoints(spacing, 2.0 * spacing) {}
  SpacedPoints(double spacing, double cell_size)
      : spacing_(spacing), grid_(cell_size), nearby_(grid_, spacing) {}
  SpacedPoints(const SpacedPoints&) = delete;
  SpacedPoints& operator=(const SpacedPoints&) = delete;

  /// Keeps the point if no kept point is within the spacing. Returns whether the point was kept.
  bool keep(const Eigen::Vector3f& point) {
    if (nearby_.any_near(point)) return false;
    grid_.insert(point);
    return true;
  }

  /// Keeps the points of a scan that are far enough from all kept points. For each part in turn,
  /// `visit_part(part, visit)` calls `visit(number, column)` for its points. Columns are less than
  /// `columns`, and consecutive points of a column should be neighbours, as in an image.
  /// `on_kept(number)` is called for each kept point, in order. With several threads, parts are
  /// visited concurrently; the result does not change.
  template <typename VisitPart, typename OnKept>
  void keep_all(std::span<const Eigen::Vector3f> points, std::size_t columns, std::size_t parts,
                unsigned threads, VisitPart visit_part, OnKept on_kept);

  /// Returns the kept points in order of insertion.
  const PointGrid& grid() const { return grid_; }
  double spacing() const { return spacing_; }

 private:
  struct Candidate {
    std::uint32_t number, column;
  };
  template <typename VisitPart>
  std::vector<std::uint32_t> select_spaced(std::span<const Eigen::Vector3f> points,
                                           std::size_t columns, std::size_t parts, unsigned threads,
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
  const std::vector<std::uint32_t> kept =
      select_spaced(points, columns, parts, threads, visit_part);
  parallel_for(2, threads, [&](std::size_t task) {
    if (task == 0) {
      for (const std::uint32_t number : kept) on_kept(number);
    } else {
      for (const std::uint32_t number : kept) grid_.insert(points[number]);
    }
  });
}

// The selection depends on the order of the points. The comparison with points of earlier scans
// does not, so it runs on all threads and rejects most points. Meanwhile, one thread compares the
// remaining points of the previous parts with each other.
template <typename VisitPart>
std::vector<std::uint32_t> SpacedPoints::select_spaced(std::span<const Eigen::Vector3f> points,
                                                       std::size_t columns, std::size_t parts,
                                                       unsigned threads,
                                                       VisitPart visit_part) const {
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
