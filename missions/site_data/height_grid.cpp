#include "missions/site_data/height_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace skycap::missions::site_data {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double max_nodes = 2e6;

const Vector3f& node_at(const HeightGrid& grid, std::size_t row, std::size_t line) {
  return grid.nodes[row * grid.columns + line];
}

/// Returns a position offset from a node by `across` and `down` cells, at the node's height.
Vector3d shifted_node(const HeightGrid& grid, const Vector3f& node, float across, float down) {
  const Eigen::Vector2f position = node.head<2>() + across * grid.right + down * grid.down;
  return Vector3f(position.x(), position.y(), node.z()).cast<double>();
}

/// Returns the box over the part of the grid that starts at row `top` - 1 and column `left` - 1 and
/// has `step` cells in each direction. At its start it includes only the second half of the first
/// cell, at its end only the first half of the last cell.
AlignedBox3d make_column(const HeightGrid& grid, std::size_t top, std::size_t left,
                         std::size_t step) {
  AlignedBox3d column;
  const std::size_t bottom = top + step - 1, right = left + step - 1;
  for (std::size_t row = top - std::min<std::size_t>(top, 1); row <= bottom; ++row) {
    if (row >= grid.rows) break;
    const float up = row + 1 == top ? 0.0F : -0.5F, down = row == bottom ? 0.0F : 0.5F;
    for (std::size_t line = left - std::min<std::size_t>(left, 1); line <= right; ++line) {
      if (line >= grid.columns) break;
      const Vector3f& node = node_at(grid, row, line);
      if (!node.allFinite()) continue;
      const float west = line + 1 == left ? 0.0F : -0.5F, east = line == right ? 0.0F : 0.5F;
      for (const float v : {up, down}) {
        for (const float u : {west, east}) column.extend(shifted_node(grid, node, u, v));
      }
    }
  }
  return column;
}

/// Returns the maximum height of the nodes around a node, at the position of that node.
Vector3f max_point_around(const HeightGrid& grid, std::size_t row, std::size_t line,
                          std::size_t reach) {
  Vector3f max_point = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t r = row - std::min(row, reach); r <= std::min(row + reach, grid.rows - 1); ++r) {
    for (std::size_t c = line - std::min(line, reach);
         c <= std::min(line + reach, grid.columns - 1); ++c) {
      const Vector3f& node = node_at(grid, r, c);
      if (!node.allFinite() || node.z() <= max_point.z()) continue;
      max_point = shifted_node(grid, node, static_cast<float>(line) - static_cast<float>(c),
                               static_cast<float>(row) - static_cast<float>(r))
                      .cast<float>();
    }
  }
  return max_point;
}

/// Square between four nodes: upper left, upper right, lower left, lower right. Nodes that do not
/// exist or have no height are empty.
using Square = std::array<std::optional<Vector3f>, 4>;

/// Returns the square whose lower right node is at the given row and column.
Square square_at(const HeightGrid& grid, std::size_t row, std::size_t line) {
  Square square;
  for (std::size_t i = 0; i < square.size(); ++i) {
    const std::size_t r = row + i / 2, c = line + i % 2;  // Offset by one.
    if (r == 0 || c == 0 || r > grid.rows || c > grid.columns) continue;
    const Vector3f& node = node_at(grid, r - 1, c - 1);
    if (node.allFinite()) square[i] = node;
  }
  return square;
}

/// Returns a position in the square, `across` and `down` from each corner towards the centre. It is
/// the mean of the positions relative to the nodes in `of`.
Vector3d position_in(const HeightGrid& grid, const Square& square,
                     std::initializer_list<std::size_t> of, float across, float down) {
  Vector3d sum = Vector3d::Zero();
  double count = 0.0;
  for (const std::size_t i : of) {
    if (!square[i]) continue;
    sum += shifted_node(grid, *square[i], i % 2 == 0 ? across : -across, i / 2 == 0 ? down : -down);
    count += 1.0;
  }
  return sum / count;
}

void add_quarters(const HeightGrid& grid, const Square& square,
                  std::vector<flight::Triangle>& triangles) {
  const Vector3d middle = position_in(grid, square, {0, 1, 2, 3}, 0.5F, 0.5F);
  for (std::size_t i = 0; i < square.size(); ++i) {
    if (!square[i]) continue;
    const Vector3d node = square[i]->cast<double>();
    const Vector3d neighbour = position_in(grid, square, {i, i ^ 1U}, 0.5F, 0.0F),
                   below_it = position_in(grid, square, {i, i ^ 2U}, 0.0F, 0.5F);
    triangles.push_back({node, neighbour, middle});
    triangles.push_back({node, middle, below_it});
  }
}

}  // namespace

std::size_t compute_step(const HeightGrid& grid) {
  const double nodes = static_cast<double>(grid.columns) * static_cast<double>(grid.rows);
  return static_cast<std::size_t>(std::max(1.0, std::ceil(std::sqrt(nodes / max_nodes))));
}

HeightGrid downsampled(const HeightGrid& grid, std::size_t step) {
  const auto kept = [step](std::size_t nodes) {
    return nodes == 0 ? 0 : (nodes - 1 + step - 1) / step + 1;
  };
  HeightGrid result{.columns = kept(grid.columns),
                    .rows = kept(grid.rows),
                    .nodes = {},
                    .right = static_cast<float>(step) * grid.right,
                    .down = static_cast<float>(step) * grid.down};
  result.nodes.reserve(result.columns * result.rows);
  for (std::size_t row = 0; row < result.rows; ++row) {
    for (std::size_t line = 0; line < result.columns; ++line) {
      result.nodes.push_back(max_point_around(grid, std::min(row * step, grid.rows - 1),
                                              std::min(line * step, grid.columns - 1), step));
    }
  }
  return result;
}

std::vector<AlignedBox3d> make_columns(const HeightGrid& grid) {
  std::vector<AlignedBox3d> columns;
  if (grid.nodes.empty()) return columns;
  const std::size_t step = compute_step(grid);
  for (std::size_t top = 0; top <= grid.rows; top += step) {
    for (std::size_t left = 0; left <= grid.columns; left += step) {
      const AlignedBox3d column = make_column(grid, top, left, step);
      if (!column.isEmpty()) columns.push_back(column);
    }
  }
  return columns;
}

std::vector<flight::Triangle> to_triangles(const HeightGrid& grid) {
  std::vector<flight::Triangle> triangles;
  for (std::size_t row = 1; row < grid.rows; ++row) {
    for (std::size_t line = 1; line < grid.columns; ++line) {
      const auto node = [&](std::size_t up, std::size_t left) -> Vector3d {
        return node_at(grid, row - up, line - left).cast<double>();
      };
      const Vector3d a = node(1, 1), b = node(1, 0), c = node(0, 0), d = node(0, 1);
      if (!(a + b + c + d).allFinite()) continue;
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  return triangles;
}

std::vector<flight::Triangle> make_rim_triangles(const HeightGrid& grid) {
  std::vector<flight::Triangle> triangles;
  for (std::size_t row = 0; row <= grid.rows && grid.rows > 0; ++row) {
    for (std::size_t line = 0; line <= grid.columns; ++line) {
      const Square square = square_at(grid, row, line);
      const auto there =
          std::ranges::count_if(square, [](const auto& node) { return node.has_value(); });
      if (there > 0 && there < 4) add_quarters(grid, square, triangles);
    }
  }
  return triangles;
}

}  // namespace skycap::missions::site_data
