#include "flight/paths/path.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <string>

#include "flight/clearance/cell_map.h"
#include "geometry/error.h"
#include "geometry/points/hash_grid.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Approximate number of cells along the straight line on the coarsest grid.
constexpr double coarse_cells = 12.0;
/// Length ratio to the straight line below which a path is not improved on other grids.
constexpr double good_enough = 1.005;
/// Length ratio that a path on a further grid must achieve.
constexpr double worth_searching = 0.99;
/// Expansion budget of each grid in the first round, and its growth factor per round.
constexpr std::size_t first_round_budget = 4000;
constexpr std::size_t round_growth = 4;

/// Distances at the vertices of one grid. A vertex stores a lower bound, which is replaced by the
/// exact distance only if the bound is insufficient.
class GridDistances {
 public:
  GridDistances(const FreeSpace& space, double cell, double clearance)
      : space_(&space), cell_(cell), needed_(clearance + clearance_guard) {}

  double cell() const { return cell_; }
  Vector3d position(const Cell& cell) const { return cell.cast<double>() * cell_; }

  /// Returns the known distance of a vertex, which suffices to decide whether it is free.
  double distance(const Cell& cell) {
    Known& known = known_.insert(cell_key(cell)).value;
    if (known.is_exact || known.bound >= needed_) return known.bound;
    known = {space_->surface_distance(position(cell), needed_ + 6.0 * cell_), true};
    return known.bound;
  }

  /// Updates a vertex with the `distance` at a position `step` away (1-Lipschitz).
  void update(const Cell& cell, double distance, double step) {
    Known& known = known_.insert(cell_key(cell)).value;
    if (!known.is_exact) known.bound = std::max(known.bound, distance - step);
  }

  bool is_free(const Cell& cell) { return distance(cell) >= needed_; }

 private:
  struct Known {
    double bound = -1.0;
    bool is_exact = false;
  };
  const FreeSpace* space_;
  double cell_;
  double needed_;
  geometry::HashGrid<Known> known_;
};

/// One run of Lazy Theta* on one grid. Vertex 0 is the start and vertex 1 the goal, which need not
/// be on the grid.
class Search {
 public:
  Search(const FreeSpace& space, double clearance, GridDistances& grid, const AlignedBox3d& region,
         const Vector3d& from, const Vector3d& to)
      : space_(space), clearance_(clearance), grid_(grid), region_(region) {
    vertices_.push_back({from, Cell::Zero(), 0.0, 0});
    vertices_.push_back({to, Cell::Zero(), unreached, 0});
    for (int axis = 0; axis < 3; ++axis) {
      start_cell_[axis] = static_cast<int>(std::floor(from[axis] / grid.cell()));
      goal_cell_[axis] = static_cast<int>(std::floor(to[axis] / grid.cell()));
    }
  }

  /// Returns the path, empty if none is shorter than `limit`. Decrements `expansions_left`.
  std::vector<Vector3d> run(double limit, std::size_t& expansions_left) {
    limit_ = limit;
    push(0);
    while (!open_.empty() && expansions_left > 0) {
      const std::uint32_t current = open_.top().vertex;
      const double queued_length = open_.top().length;
      open_.pop();
      Vertex& vertex = vertices_[current];
      if (vertex.is_closed || queued_length != vertex.length) continue;  // Outdated entry.
      if (!settle(current)) continue;
      if (current == 1) return trace();
      --expansions_left;
      expand(current);
    }
    return {};
  }

 private:
  static constexpr double unreached = std::numeric_limits<double>::infinity();

  struct Vertex {
    Vector3d position;
    Cell cell;
    double length;  ///< Length of the best known path from the start [m].
    std::uint32_t parent;
    bool is_closed = false;
  };
  struct Entry {
    double estimate;  ///< Estimated length of the complete path via the vertex [m].
    double length;
    std::uint32_t vertex;
    // Smallest estimate first, then the longest path from the start.
    bool operator<(const Entry& other) const {
      if (estimate != other.estimate) return estimate > other.estimate;
      if (length != other.length) return length < other.length;
      return vertex > other.vertex;
    }
  };

  void push(std::uint32_t v) {
    const double estimate =
        vertices_[v].length + (vertices_[1].position - vertices_[v].position).norm();
    if (estimate < limit_) open_.push({estimate, vertices_[v].length, v});
  }

  bool is_leg_free(std::uint32_t from, std::uint32_t to) const {
    return space_.continues_free({vertices_[from].position, vertices_[to].position}, clearance_);
  }

  /// SetVertex of Lazy Theta*: the leg from the parent was assumed free. If it is not, the best
  /// settled neighbour becomes the parent. Returns false if no such neighbour exists.
  bool settle(std::uint32_t v) {
    if (v == 0 || is_leg_free(vertices_[v].parent, v)) {
      vertices_[v].is_closed = true;
      return true;
    }
    std::vector<Entry> candidates;
    for_each_neighbour(v, [&](std::uint32_t n) {
      if (!vertices_[n].is_closed) return;
      const double length =
          vertices_[n].length + (vertices_[v].position - vertices_[n].position).norm();
      candidates.push_back({length, length, n});
    });
    std::sort(candidates.begin(), candidates.end(),
              [](const Entry& a, const Entry& b) { return b < a; });
    vertices_[v].length = unreached;
    for (const Entry& candidate : candidates) {
      if (!is_leg_free(candidate.vertex, v)) continue;
      vertices_[v].length = candidate.length;
      vertices_[v].parent = candidate.vertex;
      vertices_[v].is_closed = true;
      return true;
    }
    return false;
  }

  void expand(std::uint32_t v) {
    if (v > 1) update_neighbours(v);
    for_each_neighbour(v, [&](std::uint32_t n) {
      if (vertices_[n].is_closed) return;
      const std::uint32_t parent = vertices_[v].parent;
      const double length =
          vertices_[parent].length + (vertices_[n].position - vertices_[parent].position).norm();
      if (!(length < vertices_[n].length)) return;
      vertices_[n].length = length;
      vertices_[n].parent = parent;
      push(n);
    });
  }

  void update_neighbours(std::uint32_t v) {
    const Cell cell = vertices_[v].cell;
    const double distance = grid_.distance(cell);
    for_each_offset([&](const Cell& offset) {
      grid_.update(cell + offset, distance, offset.cast<double>().norm() * grid_.cell());
    });
  }

  template <typename Visit>
  static void for_each_offset(Visit visit) {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (x != 0 || y != 0 || z != 0) visit(Cell(x, y, z));
        }
      }
    }
  }

  /// Visits the free grid vertices around a vertex, and the goal if it is near. The neighbours of
  /// start and goal are the corners of their cells.
  template <typename Visit>
  void for_each_neighbour(std::uint32_t v, Visit visit) {
    const auto visit_cell = [&](const Cell& cell) {
      if (!region_.contains(grid_.position(cell)) || !grid_.is_free(cell)) return;
      visit(vertex_at(cell));
    };
    if (v <= 1) {
      const Cell low = v == 0 ? start_cell_ : goal_cell_;
      for (int corner = 0; corner < 8; ++corner) {
        visit_cell(low + Cell(corner & 1, corner >> 1 & 1, corner >> 2 & 1));
      }
      return;
    }
    const Cell cell = vertices_[v].cell;
    for_each_offset([&](const Cell& offset) { visit_cell(cell + offset); });
    const auto is_cell_corner = [&](const Cell& low) {
      const Eigen::Array3i offset = (cell - low).array();
      return (offset >= 0).all() && (offset <= 1).all();
    };
    if (is_cell_corner(goal_cell_)) visit(1);
    if (is_cell_corner(start_cell_)) visit(0);
  }

  std::uint32_t vertex_at(const Cell& cell) {
    const auto fresh = static_cast<std::uint32_t>(vertices_.size());
    const std::uint32_t v = index_.insert(cell_key(cell), fresh).value;
    if (v == fresh) vertices_.push_back({grid_.position(cell), cell, unreached, 0});
    return v;
  }

  std::vector<Vector3d> trace() const {
    std::vector<Vector3d> points;
    std::uint32_t v = 1;
    for (; v != 0; v = vertices_[v].parent) points.push_back(vertices_[v].position);
    points.push_back(vertices_[0].position);
    std::reverse(points.begin(), points.end());
    return points;
  }

  const FreeSpace& space_;
  double clearance_;
  GridDistances& grid_;
  AlignedBox3d region_;
  Cell start_cell_, goal_cell_;
  double limit_ = unreached;
  std::vector<Vertex> vertices_;
  geometry::HashGrid<std::uint32_t> index_;
  std::priority_queue<Entry> open_;
};

}  // namespace

void PathOptions::validate() const {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorKind::bad_config, what);
  };
  require(finest_cell >= 0.0 && std::isfinite(finest_cell),
          "path.finest_cell is " + std::to_string(finest_cell) + " m; it must be zero or more");
  require(max_expansions > 0, "path.max_expansions is 0; it must be at least 1");
  require(worthwhile_saving >= 0.0 && worthwhile_saving < 1.0,
          "path.worthwhile_saving is " + std::to_string(worthwhile_saving) +
              "; it must be at least 0 and below 1");
}

double length(const std::vector<Vector3d>& points) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

struct PathFinder::Impl {
  const FreeSpace& space;
  double clearance;
  PathOptions options;
  std::map<int, GridDistances> grids;  ///< Keyed by the binary exponent of the cell size.

  GridDistances& grid(int exponent) {
    return grids.try_emplace(exponent, space, std::exp2(exponent), clearance).first->second;
  }
  AlignedBox3d region(const Vector3d& from, const Vector3d& to, double cell) const;
  struct Exponents {
    int finest, coarsest;
  };
  Exponents exponents(double straight) const;
  /// `path.points` contains the two ends until a path is found.
  bool search_grid(int exponent, std::size_t& budget, Path& path);
  void search_grids(Path& path);
};

/// Returns the search region. Space beyond the obstacles' box is free, so a shortest path leaves it
/// by no more than the clearance. Two more cells provide space for the grid.
AlignedBox3d PathFinder::Impl::region(const Vector3d& from, const Vector3d& to, double cell) const {
  AlignedBox3d box = space.extent();
  const double grown = clearance + 2.0 * cell;
  if (!box.isEmpty()) {
    box.min() -= Vector3d::Constant(grown);
    box.max() += Vector3d::Constant(grown);
  }
  for (const Vector3d& end : {from, to}) {
    box.extend(Vector3d(end - Vector3d::Constant(2.0 * cell)));
    box.extend(Vector3d(end + Vector3d::Constant(2.0 * cell)));
  }
  return box;
}

/// Returns the binary exponents of the finest and the coarsest cell sizes.
PathFinder::Impl::Exponents PathFinder::Impl::exponents(double straight) const {
  const double finest = options.finest_cell > 0.0
                            ? options.finest_cell
                            : std::max({0.25 * clearance, straight / 400.0, 1e-3});
  const int last = static_cast<int>(std::floor(std::log2(finest)));
  return {last, std::max(last, static_cast<int>(std::floor(std::log2(straight / coarse_cells))))};
}

/// Searches one grid and keeps a shorter path. Returns true if the grid is exhausted or a path was
/// found, so that a repeated search is useless.
bool PathFinder::Impl::search_grid(int exponent, std::size_t& budget, Path& path) {
  const bool has_path = path.status == PathStatus::found;
  const Vector3d from = path.points.front(), to = path.points.back();
  GridDistances& distances = grid(exponent);
  Search search(space, clearance, distances, region(from, to, distances.cell()), from, to);
  const double limit =
      has_path ? worth_searching * path.length : std::numeric_limits<double>::infinity();
  const std::size_t before = budget;
  std::vector<Vector3d> points = search.run(limit, budget);
  path.expansions += before - budget;
  if (points.empty()) return budget > 0;
  points = pull_tight(space, clearance, std::move(points), options.worthwhile_saving);
  const double pulled = length(points);
  if (!has_path || pulled < path.length) {
    path.points = std::move(points);
    path.length = pulled;
    path.status = PathStatus::found;
  }
  return true;
}

// All grids receive the same budget, which grows per round. The first path comes from the grid that
// finds one with the least effort, and it is the upper bound. Finer grids then search for passages
// that this grid cannot resolve.
void PathFinder::Impl::search_grids(Path& path) {
  const double straight = (path.points.back() - path.points.front()).norm();
  const auto [last, first] = exponents(straight);
  std::vector<bool> is_exhausted(static_cast<std::size_t>(first - last + 1), false);
  int found_on = last;
  for (std::size_t round_budget = std::min(first_round_budget, options.max_expansions);
       path.status != PathStatus::found; round_budget *= round_growth) {
    for (int exponent = first; exponent >= last && path.status != PathStatus::found; --exponent) {
      const auto slot = static_cast<std::size_t>(exponent - last);
      if (is_exhausted[slot]) continue;
      std::size_t budget = round_budget;
      is_exhausted[slot] = search_grid(exponent, budget, path);
      found_on = exponent;
    }
    const bool all_exhausted =
        std::all_of(is_exhausted.begin(), is_exhausted.end(), [](bool is) { return is; });
    if (all_exhausted || round_budget * round_growth > options.max_expansions) break;
  }
  if (path.status != PathStatus::found) return;
  std::size_t budget = options.max_improving_expansions;
  for (int exponent = found_on - 1; exponent >= last && budget > 0; --exponent) {
    if (path.length <= good_enough * straight) return;
    search_grid(exponent, budget, path);
  }
}

PathFinder::PathFinder(const FreeSpace& space, double clearance, const PathOptions& options)
    : impl_(new Impl{space, clearance, options, {}}) {
  options.validate();
  if (!(clearance >= 0.0) || !std::isfinite(clearance)) {
    throw Error(ErrorKind::bad_config, "the clearance is " + std::to_string(clearance) +
                                           " m; it must be a finite number, zero or more");
  }
}

PathFinder::~PathFinder() = default;
PathFinder::PathFinder(PathFinder&&) noexcept = default;
PathFinder& PathFinder::operator=(PathFinder&&) noexcept = default;

Path PathFinder::find(const Vector3d& from, const Vector3d& to) {
  Path path;
  if (!impl_->space.is_free({from, from}, impl_->clearance)) {
    path.status = PathStatus::start_not_free;
    return path;
  }
  if (!impl_->space.is_free({to, to}, impl_->clearance)) {
    path.status = PathStatus::goal_not_free;
    return path;
  }
  path.points = {from, to};
  path.status = PathStatus::unreachable;
  if (impl_->space.continues_free({from, to}, impl_->clearance)) {
    path.status = PathStatus::found;
    path.length = (to - from).norm();
  } else {
    impl_->search_grids(path);
  }
  if (path.status != PathStatus::found) path.points.clear();
  return path;
}

void PathFinder::forget() { impl_->grids.clear(); }

double PathFinder::clearance() const { return impl_->clearance; }

}  // namespace skycap::flight
