#include "missions/site_data/missing_terrain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "geometry/pose/prism.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::AlignedBox2d;
using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double finest = 0.25;  ///< Minimum spacing of the lattice [m].
constexpr double max_cells = 2000.0;
constexpr float none = -std::numeric_limits<float>::infinity();

/// Tolerance for ground at a lattice point, so that rounding does not exclude points on borders
/// [m].
constexpr double near = 1e-6;

AlignedBox2d compute_extent(const std::vector<flight::PriorObstacleConfig>& terrain) {
  AlignedBox2d extent;
  for (const flight::PriorObstacleConfig& part : terrain) {
    for (const flight::NamedSurface& surface : part.surfaces) {
      for (const Vector3d& vertex : surface.mesh.vertices) extent.extend(vertex.head<2>());
    }
    for (const AlignedBox3d& column : part.columns) {
      extent.extend(column.min().head<2>());
      extent.extend(column.max().head<2>());
    }
  }
  return extent;
}

/// Maximum known ground height at each point of a lattice over the terrain.
class Lattice {
 public:
  explicit Lattice(const std::vector<flight::PriorObstacleConfig>& terrain)
      : box_(compute_extent(terrain)) {
    const Vector2d size = box_.sizes();
    const double cell = std::max(finest, size.maxCoeff() / max_cells);
    cells_ = {std::max(1, static_cast<int>(std::ceil(size.x() / cell))),
              std::max(1, static_cast<int>(std::ceil(size.y() / cell)))};
    step_ = {std::max(near, size.x() / cells_[0]), std::max(near, size.y() / cells_[1])};
    heights_.assign(
        (static_cast<std::size_t>(cells_[0]) + 1) * (static_cast<std::size_t>(cells_[1]) + 1),
        none);
    for (const flight::PriorObstacleConfig& part : terrain) add(part);
  }

  int columns() const { return cells_[0]; }
  int rows() const { return cells_[1]; }
  const AlignedBox2d& box() const { return box_; }
  double cell_area() const { return step_.prod(); }
  Vector2d point(int column, int row) const {
    return box_.min() + Vector2d(column * step_.x(), row * step_.y());
  }
  /// Returns the heights at the corners of a cell.
  std::array<float, 4> corners(int column, int row) const {
    return {height(column, row), height(column + 1, row), height(column, row + 1),
            height(column + 1, row + 1)};
  }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * (static_cast<std::size_t>(cells_[0]) + 1) +
           static_cast<std::size_t>(column);
  }
  float height(int column, int row) const { return heights_[index(column, row)]; }

  void add(const flight::PriorObstacleConfig& part) {
    for (const flight::NamedSurface& surface : part.surfaces) {
      for (const auto& [a, b, c] : surface.mesh.triangles) {
        const auto& vertices = surface.mesh.vertices;
        add_triangle({vertices[a], vertices[b], vertices[c]});
      }
    }
    for (const AlignedBox3d& column : part.columns) {
      raise({column.min().head<2>(), column.max().head<2>()}, column.max().z(),
            [](const Vector2d&) { return true; });
    }
  }

  /// Adds a triangle with the height of its highest corner. Its slope within a cell is not
  /// relevant.
  void add_triangle(const flight::Triangle& triangle) {
    AlignedBox3d box;
    for (const Vector3d& corner : triangle) box.extend(corner);
    std::array<Vector2d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = triangle[i].head<2>();
    if (geometry::turn(corners[0], corners[1], corners[2]) < 0.0) std::swap(corners[1], corners[2]);
    raise({box.min().head<2>(), box.max().head<2>()}, box.max().z(), [&](const Vector2d& point) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vector2d &a = corners[i], &b = corners[(i + 1) % 3];
        if (geometry::turn(a, b, point) < -near * (b - a).norm()) return false;
      }
      return true;
    });
  }

  template <typename IsThere>
  void raise(const AlignedBox2d& box, double z, const IsThere& is_there) {
    const auto range = [&](int axis) {
      const double low = (box.min()[axis] - near - box_.min()[axis]) / step_[axis],
                   high = (box.max()[axis] + near - box_.min()[axis]) / step_[axis];
      const int cells = cells_[static_cast<std::size_t>(axis)];
      return std::array{std::clamp(static_cast<int>(std::ceil(low)), 0, cells),
                        std::clamp(static_cast<int>(std::floor(high)), -1, cells)};
    };
    const auto [west, east] = range(0);
    const auto [south, north] = range(1);
    for (int row = south; row <= north; ++row) {
      for (int column = west; column <= east; ++column) {
        float& height = heights_[index(column, row)];
        if (static_cast<float>(z) > height && is_there(point(column, row))) {
          height = static_cast<float>(z);
        }
      }
    }
  }

  AlignedBox2d box_;
  std::array<int, 2> cells_{};
  Vector2d step_ = Vector2d::Ones();
  std::vector<float> heights_;
};

/// Connected gaps of lattice cells with a corner without known ground.
class Gaps {
 public:
  explicit Gaps(const Lattice& lattice)
      : lattice_(lattice),
        gap_indices_(
            static_cast<std::size_t>(lattice.columns()) * static_cast<std::size_t>(lattice.rows()),
            known) {
    for (int row = 0; row < lattice.rows(); ++row) {
      for (int column = 0; column < lattice.columns(); ++column) {
        if (has_gap(column, row)) gap_indices_[index(column, row)] = unvisited;
      }
    }
    for (int row = 0; row < lattice.rows(); ++row) {
      for (int column = 0; column < lattice.columns(); ++column) visit(column, row);
    }
  }

  struct Gap {
    bool is_surrounded = true;  ///< Enclosed by known ground.
    float max_height = none;    ///< Maximum height of the adjacent ground.
    std::size_t cells = 0;
  };
  /// Returns the gap of a cell, or null if its ground is known.
  const Gap* at(int column, int row) const {
    const std::int32_t gap = gap_indices_[index(column, row)];
    return gap < 0 ? nullptr : &gaps_[static_cast<std::size_t>(gap)];
  }
  const std::vector<Gap>& all() const { return gaps_; }

 private:
  static constexpr std::int32_t known = -1, unvisited = -2;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(lattice_.columns()) +
           static_cast<std::size_t>(column);
  }
  bool has_gap(int column, int row) const {
    return std::ranges::any_of(lattice_.corners(column, row), [](float z) { return z == none; });
  }

  void visit(int column, int row) {
    if (gap_indices_[index(column, row)] != unvisited) return;
    Gap gap;
    const auto number = static_cast<std::int32_t>(gaps_.size());
    std::vector<std::array<int, 2>> open;
    const auto enter = [&](int c, int r) {
      if (c < 0 || r < 0 || c >= lattice_.columns() || r >= lattice_.rows()) {
        gap.is_surrounded = false;
      } else if (gap_indices_[index(c, r)] == unvisited) {
        gap_indices_[index(c, r)] = number;
        open.push_back({c, r});
      }
    };
    enter(column, row);
    while (!open.empty()) {
      const auto [c, r] = open.back();
      open.pop_back();
      ++gap.cells;
      for (const float height : lattice_.corners(c, r))
        gap.max_height = std::max(gap.max_height, height);
      enter(c - 1, r);
      enter(c + 1, r);
      enter(c, r - 1);
      enter(c, r + 1);
    }
    gaps_.push_back(gap);
  }

  const Lattice& lattice_;
  std::vector<std::int32_t> gap_indices_;
  std::vector<Gap> gaps_;
};

/// Returns a flat column. Its lower end is arbitrary.
AlignedBox3d column_over(const Vector2d& low, const Vector2d& high, double top) {
  return {Vector3d(low.x(), low.y(), top - 1.0), Vector3d(high.x(), high.y(), top)};
}

/// Adds the gaps as one column per run of cells in a row.
void add_gaps(const Lattice& lattice, const Gaps& gaps, double plane_z,
              std::vector<AlignedBox3d>& columns) {
  for (int row = 0; row < lattice.rows(); ++row) {
    for (int first = 0; first < lattice.columns();) {
      const Gaps::Gap* const gap = gaps.at(first, row);
      int end = first + 1;
      while (end < lattice.columns() && gaps.at(end, row) == gap) ++end;
      if (gap != nullptr) {
        const double top = gap->is_surrounded ? static_cast<double>(gap->max_height) : plane_z;
        columns.push_back(column_over(lattice.point(first, row), lattice.point(end, row + 1), top));
      }
      first = end;
    }
  }
}

/// Adds everything outside a box up to the height `top`.
void add_beyond(const AlignedBox2d& box, double top, std::vector<AlignedBox3d>& columns) {
  constexpr double far = 5e4;
  const Vector2d &low = box.min(), &high = box.max();
  columns.push_back(column_over({-far, -far}, {low.x(), far}, top));
  columns.push_back(column_over({high.x(), -far}, {far, far}, top));
  columns.push_back(column_over({low.x(), -far}, {high.x(), low.y()}, top));
  columns.push_back(column_over({low.x(), high.y()}, {high.x(), far}, top));
}

std::string make_note(const Lattice& lattice, const Gaps& gaps, double plane_z) {
  std::size_t holes = 0, cells = 0;
  for (const Gaps::Gap& gap : gaps.all()) {
    if (!gap.is_surrounded) continue;
    ++holes;
    cells += gap.cells;
  }
  std::string note = fmt::format(
      "outside the terrain files, the ground is assumed to be the plane z = {:.2f} m", plane_z);
  if (holes > 0) {
    note += fmt::format(
        "; {} holes in the terrain files ({:.0f} m^2) are filled to the height of the highest "
        "ground around them",
        holes, static_cast<double>(cells) * lattice.cell_area());
  }
  return note;
}

}  // namespace

UnknownGround::UnknownGround(const std::vector<flight::PriorObstacleConfig>& terrain,
                             double plane_z)
    : plane_z_(plane_z) {
  const Lattice lattice(terrain);
  const Gaps gaps(lattice);
  obstacle_.name = "the ground in unknown terrain";
  obstacle_.is_ground = true;
  for (const flight::PriorObstacleConfig& part : terrain) {
    obstacle_.uncertainty = std::max(obstacle_.uncertainty, part.uncertainty);
  }
  add_gaps(lattice, gaps, plane_z, obstacle_.columns);
  add_beyond(lattice.box(), plane_z, obstacle_.columns);
  note_ = make_note(lattice, gaps, plane_z);
}

double UnknownGround::height(const Vector2d& position) const {
  std::optional<double> max_height;
  for (const AlignedBox3d& column : obstacle_.columns) {
    if (!AlignedBox2d(column.min().head<2>(), column.max().head<2>()).contains(position)) continue;
    max_height = std::max(max_height.value_or(column.max().z()), column.max().z());
  }
  return max_height.value_or(plane_z_);
}

}  // namespace skycap::missions::site_data
