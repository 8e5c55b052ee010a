#include "geometry/points/spatial_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>

#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>

namespace skycap::geometry {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;

/// Property map with which CGAL's trees store indices instead of points.
struct IndexToPointMap {
  using value_type = Kernel::Point_3;
  using reference = value_type;
  using key_type = std::uint32_t;
  using category = boost::readable_property_map_tag;

  const PointGrid* points;

  friend reference get(const IndexToPointMap& map, key_type index) {
    const Eigen::Vector3f p = map.points->point(index);
    return {p.x(), p.y(), p.z()};
  }
};

using Traits =
    CGAL::Search_traits_adapter<std::uint32_t, IndexToPointMap, CGAL::Search_traits_3<Kernel>>;
using Tree = CGAL::Kd_tree<Traits>;
using NearestSearch = CGAL::Orthogonal_k_neighbor_search<Traits>;
using Ball = CGAL::Fuzzy_sphere<Traits>;

}  // namespace

/// Trees over consecutive ranges of points, each at least twice as large as the next one. The last
/// few points, which do not justify a tree, are compared one by one.
struct SpatialIndex::Forest {
  static constexpr std::size_t smallest_tree = 256;

  struct RangeTree {
    std::size_t first, last;
    std::unique_ptr<Tree> tree;
  };

  void bring_up_to_date(const PointGrid& points) {
    std::size_t first = trees.empty() ? 0 : trees.back().last;
    if (points.size() - first < smallest_tree) return;
    while (!trees.empty() && 2 * (points.size() - first) > trees.back().last - trees.back().first) {
      first = trees.back().first;
      trees.pop_back();
    }
    std::vector<std::uint32_t> indices(points.size() - first);
    std::iota(indices.begin(), indices.end(), static_cast<std::uint32_t>(first));
    // The tree stores the address of the grid, so an index cannot be moved.
    auto tree = std::make_unique<Tree>(indices.begin(), indices.end(), Tree::Splitter(),
                                       Traits(IndexToPointMap{&points}));
    tree->build();
    trees.push_back({first, points.size(), std::move(tree)});
  }

  /// Calls `visit` with all points within `radius`, and possibly some slightly farther ones.
  template <typename Visit>
  void visit_ball(const PointGrid& points, const Eigen::Vector3f& query, double radius,
                  Visit visit) {
    const double reach = radius * (1.0 + 1e-5) + 1e-6 * query.cwiseAbs().maxCoeff();
    const Kernel::Point_3 centre(query.x(), query.y(), query.z());
    std::vector<std::uint32_t> found;
    for (const RangeTree& range : trees) {
      range.tree->search(std::back_inserter(found),
                         Ball(centre, reach, 0.0, Traits(IndexToPointMap{&points})));
    }
    for (const std::uint32_t index : found) visit(index);
    for (std::size_t i = trees.empty() ? 0 : trees.back().last; i < points.size(); ++i) {
      visit(static_cast<std::uint32_t>(i));
    }
  }

  std::vector<RangeTree> trees;
  std::mutex mutex;
};

SpatialIndex::SpatialIndex(double typical_radius)
    : grid_(typical_radius), forest_(std::make_unique<Forest>()) {}
SpatialIndex::~SpatialIndex() = default;

std::uint32_t SpatialIndex::insert(const Eigen::Vector3f& point) {
  grid_.insert(point);
  return static_cast<std::uint32_t>(size() - 1);
}

// The grid is used for balls of a few bricks, and for small clouds by comparing all points.
bool SpatialIndex::suits_grid(double radius) const {
  return radius <= 16.0 * grid_.cell_size() || size() <= 1U << 14;
}

bool SpatialIndex::any_within(const Eigen::Vector3f& query, double radius) const {
  if (radius <= grid_.cell_size()) return grid_.any_within(query, radius);
  return !within(query, radius).empty();
}

std::size_t SpatialIndex::count_within(const Eigen::Vector3f& query, double radius) const {
  if (radius <= grid_.cell_size()) return grid_.count_within(query, radius, size() + 1);
  return within(query, radius).size();
}

std::vector<std::uint32_t> SpatialIndex::within(const Eigen::Vector3f& query, double radius) const {
  std::vector<std::uint32_t> indices;
  if (suits_grid(radius)) {
    std::vector<Neighbour> found;
    grid_.find_within(query, radius, found);
    indices.reserve(found.size());
    for (const Neighbour& neighbour : found) indices.push_back(neighbour.index);
  } else {
    const std::lock_guard lock(forest_->mutex);
    forest_->bring_up_to_date(grid_);
    const auto squared_radius = static_cast<float>(radius * radius);
    forest_->visit_ball(grid_, query, radius, [&](std::uint32_t index) {
      if (squared_distance(query, point(index)) <= squared_radius) indices.push_back(index);
    });
  }
  std::sort(indices.begin(), indices.end());
  return indices;
}

std::vector<Neighbour> SpatialIndex::nearest(const Eigen::Vector3f& query,
                                             std::size_t count) const {
  count = std::min(count, size());
  std::vector<Neighbour> found;
  if (count == 0) return found;
  // Near the cloud: tests balls of one, two and three cells. A ball with enough points contains the
  // result.
  for (const double radius : {1.0, 2.0, 3.0}) {
    found.clear();
    grid_.find_within(query, radius * grid_.cell_size(), found);
    if (found.size() < count) continue;
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count),
                      found.end());
    found.resize(count);
    return found;
  }

  // Far from the cloud: the forest returns the distance of the last neighbour, then all points
  // within that distance.
  const std::lock_guard lock(forest_->mutex);
  forest_->bring_up_to_date(grid_);
  const Kernel::Point_3 centre(query.x(), query.y(), query.z());
  std::vector<Neighbour> candidates;
  const auto add = [&](std::uint32_t index) {
    candidates.push_back({squared_distance(query, point(index)), index});
  };
  for (const Forest::RangeTree& range : forest_->trees) {
    const NearestSearch search(*range.tree, centre, static_cast<unsigned>(count), 0.0, true,
                               NearestSearch::Distance(IndexToPointMap{&grid_}));
    for (const auto& [index, distance] : search) add(index);
  }
  const std::size_t in_trees = forest_->trees.empty() ? 0 : forest_->trees.back().last;
  for (std::size_t i = in_trees; i < size(); ++i) add(static_cast<std::uint32_t>(i));
  std::nth_element(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count - 1),
                   candidates.end());
  const double last = std::sqrt(static_cast<double>(candidates[count - 1].squared_distance));
  candidates.clear();
  forest_->visit_ball(grid_, query, last, add);
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count),
                    candidates.end());
  candidates.resize(count);
  return candidates;
}

}  // namespace skycap::geometry
