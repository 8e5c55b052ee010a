#include "sim/models/masonry/wall.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

#include "geometry/surfaces/ear_clipping.h"
#include "sim/models/masonry/wall_tiles.h"

namespace skycap::sim::models {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;
using Loop = std::vector<std::uint32_t>;

constexpr double same = same_corner;

/// Vertices of a wall under construction, indexed by their position on the developed face.
class Face {
 public:
  Face(const PlanCurve& plan, Mesh& mesh) : plan_(plan), mesh_(mesh) {}

  /// Returns the vertex at (s, z), displaced outwards from the plan by `offset`.
  std::uint32_t vertex(const Vector2d& position, double offset) {
    const double s =
        position.x() - plan_.length() * std::floor((position.x() + same) / plan_.length());
    const Vector3d target(s, position.y(), offset);
    const Key middle = make_key(target);
    for (std::int64_t i = -1; i <= 1; ++i) {
      for (std::int64_t j = -1; j <= 1; ++j) {
        for (std::int64_t k = -1; k <= 1; ++k) {
          const auto found = indices_.find({middle[0] + i, middle[1] + j, middle[2] + k});
          if (found != indices_.end() && (positions_[found->second] - target).norm() < same) {
            return found->second;
          }
        }
      }
    }
    const auto index = static_cast<std::uint32_t>(positions_.size());
    indices_.emplace(middle, index);
    positions_.push_back(target);
    const Vector2d point = plan_.point(s, offset);
    mesh_.vertices.emplace_back(point.x(), point.y(), position.y());
    return index;
  }

  Vector2d position(std::uint32_t vertex) const { return positions_[vertex].head<2>(); }

 private:
  using Key = std::array<std::int64_t, 3>;
  static Key make_key(const Vector3d& position) {
    return {std::llround(position.x() / (2 * same)), std::llround(position.y() / (2 * same)),
            std::llround(position.z() / (2 * same))};
  }

  const PlanCurve& plan_;
  Mesh& mesh_;
  std::map<Key, std::uint32_t> indices_;
  std::vector<Vector3d> positions_;
};

/// Builds one wall. The steps are in the order of build() below.
class WallBuilder {
 public:
  explicit WallBuilder(const Wall& wall) : wall_(wall), face_(wall.plan, band_.mesh) {}

  void lay_out_tiles() {
    const SideSplitter splitter(wall_);
    for (const Polyline2& tile : wall_.tiles) {
      outlines_.push_back(splitter.split(tile));
      Loop& ring = rings_.emplace_back();
      for (const Vector2d& corner : outlines_.back()) {
        ring.push_back(face_.vertex(corner, -wall_.joint.depth));
      }
      for (std::size_t i = 0; i < ring.size(); ++i) {
        [[maybe_unused]] const bool is_new =
            next_.try_emplace({ring[i], ring[(i + 1) % ring.size()]}).second;
        assert(is_new && "tiles overlap");
      }
    }
  }

  void raise_stones() {
    for (std::size_t t = 0; t < rings_.size(); ++t) raise_stone(outlines_[t], rings_[t]);
  }

  /// Finds sides that belong to a single tile, as loops with the wall to the left.
  void find_edges() {
    std::map<std::uint32_t, std::uint32_t> after;
    for (const auto& [side, unused] : next_) {
      if (!next_.contains({side.second, side.first})) after.emplace(side.first, side.second);
    }
    while (!after.empty()) {
      Loop loop;
      for (auto side = after.begin(); side != after.end(); side = after.find(side->second)) {
        loop.push_back(side->first);
        if (loop.size() > 1) after.erase(loop[loop.size() - 2]);
      }
      after.erase(loop.back());
      const auto is_at = [&](double z) {
        return std::all_of(loop.begin(), loop.end(), [&](std::uint32_t v) {
          return std::abs(face_.position(v).y() - z) < same;
        });
      };
      if (is_at(wall_.bottom)) {
        band_.bottom = std::move(loop);
      } else if (is_at(wall_.top)) {
        std::reverse(loop.begin(), loop.end());
        band_.top = std::move(loop);
      } else {
        std::reverse(loop.begin(), loop.end());
        fill(loop);
      }
    }
  }

  Band result() { return std::move(band_); }

 private:
  /// Converts a tile to a stone: its face and, from the bottom of the joints, its sides.
  void raise_stone(const Polyline2& outline, const Loop& ring) {
    if (wall_.joint.depth == 0.0) {
      add_polygon(outline, ring);
      return;
    }
    const std::size_t size = ring.size();
    std::vector<double> widths;
    // Corner of the plan, at which the stone continues in the next tile.
    std::vector<bool> is_corner;
    for (std::size_t i = 0; i < size; ++i) {
      const Vector2d &a = outline[i], &b = outline[(i + 1) % size];
      const bool is_shared = next_.contains({ring[(i + 1) % size], ring[i]});
      is_corner.push_back(is_shared && std::abs(a.x() - b.x()) < same &&
                          wall_.plan.is_corner(a.x()));
      widths.push_back(is_shared && !is_corner.back() ? wall_.joint.half_width : 0.0);
    }
    const Polyline2 face = inset(outline, widths);
    Loop face_ring;
    for (const Vector2d& corner : face) face_ring.push_back(face_.vertex(corner, 0.0));
    for (std::size_t i = 0; i < size; ++i) {
      if (is_corner[i]) continue;
      const std::size_t j = (i + 1) % size;
      add(ring[i], ring[j], face_ring[j]);
      add(ring[i], face_ring[j], face_ring[i]);
    }
    add_polygon(face, face_ring);
  }

  /// Returns the positions of a counter-clockwise loop, continuous where s wraps around.
  Polyline2 unrolled(const Loop& loop) const {
    Polyline2 positions;
    for (const std::uint32_t v : loop) {
      Vector2d position = face_.position(v);
      const double from_first = positions.empty() ? 0.0 : position.x() - positions[0].x();
      position.x() -= std::round(from_first / wall_.plan.length()) * wall_.plan.length();
      positions.push_back(position);
    }
    return positions;
  }

  /// Fills the opening bounded by this loop.
  void fill(const Loop& loop) {
    Polyline2 outline = unrolled(loop);
    Vector2d low = outline[0], high = low;
    for (const Vector2d& position : outline) {
      low = low.cwiseMin(position);
      high = high.cwiseMax(position);
    }
    const auto turns_to = [&](const Opening& opening) {
      return (0.5 * (low.x() + high.x()) - opening.centre) / wall_.plan.length();
    };
    const auto found =
        std::find_if(wall_.openings.begin(), wall_.openings.end(), [&](const Opening& opening) {
          const double turns = turns_to(opening);
          return std::abs(turns - std::round(turns)) * wall_.plan.length() < same &&
                 std::abs(low.y() - opening.sill) < same;
        });
    assert(found != wall_.openings.end() && "each gap between the tiles must be an opening");
    const Opening& opening = *found;
    const double shift = std::round(turns_to(opening)) * wall_.plan.length();
    for (Vector2d& position : outline) position.x() -= shift;
    if (opening.back == Opening::Back::flat) {
      fill_flat(opening, outline, loop);
    } else {
      fill_round(opening, outline, loop);
    }
  }

  void fill_flat(const Opening& opening, const Polyline2& outline, const Loop& loop) {
    Loop panel;
    for (const Vector2d& position : outline)
      panel.push_back(face_.vertex(position, -opening.depth));
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::size_t j = (i + 1) % loop.size();
      add(loop[i], loop[j], panel[j]);
      add(loop[i], panel[j], panel[i]);
    }
    add_polygon(outline, panel);
  }

  void fill_round(const Opening& opening, const Polyline2& outline, const Loop& loop) {
    // The loop's vertices as the sill, from left to right, and the two sides up to the crown.
    const auto is_sill = [&](const Vector2d& p) { return std::abs(p.y() - opening.sill) < same; };
    const std::size_t size = loop.size();
    std::size_t start = 0;  // Left end of the sill.
    while (!(is_sill(outline[start]) && !is_sill(outline[(start + size - 1) % size]))) ++start;
    std::vector<std::size_t> sill{start};
    while (is_sill(outline[(sill.back() + 1) % size])) sill.push_back((sill.back() + 1) % size);
    const std::size_t rows = (size - sill.size()) / 2 + 1;  // Number of rows below the crown.
    assert((size - sill.size()) % 2 == 1 &&
           "the sides of a niche must mirror each other below one crown");

    const int chords = std::max<int>(4, static_cast<int>(rows));
    const auto row_at = [&](std::size_t i) {
      const std::size_t left = (start + size - i) % size, right = (sill.back() + i) % size;
      const double z = outline[left].y();
      assert(std::abs(outline[right].y() - z) < same &&
             "the sides of a niche must mirror each other");
      const double half_width = outline[right].x() - opening.centre;
      Loop row{loop[left]};
      for (int j = 1; j < chords; ++j) {
        const double angle = pi * j / chords;
        const double s = opening.centre - half_width * std::cos(angle);
        const double reach = half_width / opening.half_width * std::sin(angle);
        row.push_back(face_.vertex({s, z}, -wall_.joint.depth - opening.depth * reach));
      }
      row.push_back(loop[right]);
      return row;
    };

    Loop row = row_at(0);
    add_floor(opening, sill, outline, loop, row);
    for (std::size_t i = 1; i < rows; ++i) {
      const Loop upper = row_at(i);
      for (std::size_t j = 0; j + 1 < row.size(); ++j) {
        add(row[j], row[j + 1], upper[j + 1]);
        add(row[j], upper[j + 1], upper[j]);
      }
      row = upper;
    }
    const std::uint32_t crown = loop[(start + size - rows) % size];
    for (std::size_t j = 0; j + 1 < row.size(); ++j) add(row[j], row[j + 1], crown);
  }

  /// Adds the floor of a niche, between the edge of the sill and the lowest row.
  void add_floor(const Opening& opening, const std::vector<std::size_t>& sill,
                 const Polyline2& outline, const Loop& loop, const Loop& row) {
    Polyline2 floor;  // (s, distance inwards).
    Loop ring;
    for (const std::size_t i : sill) {
      floor.emplace_back(outline[i].x(), 0.0);
      ring.push_back(loop[i]);
    }
    for (std::size_t j = row.size() - 2; j > 0; --j) {
      const double angle = pi * static_cast<double>(j) / static_cast<double>(row.size() - 1);
      floor.emplace_back(opening.centre - opening.half_width * std::cos(angle),
                         opening.depth * std::sin(angle));
      ring.push_back(row[j]);
    }
    add_polygon(floor, ring);
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    band_.mesh.triangles.push_back({a, b, c});
  }

  void add_polygon(const Polyline2& outline, const Loop& ring) {
    for (const auto& [a, b, c] : geometry::clip_ears(outline)) add(ring[a], ring[b], ring[c]);
  }

  const Wall& wall_;
  Band band_;
  Face face_;
  std::vector<Polyline2> outlines_;  // Outlines of the tiles with all corners of their neighbours.
  std::vector<Loop> rings_;          // Outlines at the bottom of the joints.
  std::map<std::pair<std::uint32_t, std::uint32_t>, char> next_;  // Directed sides of the tiles.
};

}  // namespace

double Opening::head_height(double s, double margin) const {
  for (std::size_t i = 0; i + 1 < head.size(); ++i) {
    const Vector2d &right = head[i], &left = head[i + 1];
    if (margin >= right.x() || margin <= left.x()) continue;
    return left.y() + (s - left.x()) / (right.x() - left.x()) * (right.y() - left.y());
  }
  return sill;
}

Polyline2 Opening::outline() const {
  Polyline2 polygon{{centre - half_width, sill}, {centre + half_width, sill}};
  polygon.insert(polygon.end(), head.begin(), head.end());
  return polygon;
}

Opening rectangular(double centre, double width, double sill, double head, double depth) {
  return {
      centre, 0.5 * width,         sill,
      depth,  Opening::Back::flat, {{centre + 0.5 * width, head}, {centre - 0.5 * width, head}}};
}

Opening arched(double centre, double width, double sill, double crown, double depth,
               const Fineness& fineness) {
  const double radius = 0.5 * width;
  // Even, so that one vertex is the crown.
  const int chords = 2 * fineness.chords(radius, 0.5 * pi);
  Opening opening{centre, radius, sill, depth, Opening::Back::flat, {}};
  for (int i = 0; i <= chords; ++i) {
    const double angle = pi * i / chords;
    opening.head.emplace_back(centre + radius * std::cos(angle),
                              crown - radius + radius * std::sin(angle));
  }
  return opening;
}

std::vector<Polyline2> plain_tiles(double start, double end, double bottom, double top,
                                   const std::vector<Opening>& openings, double max_width) {
  const double max_height = 4.0 * max_width;  // Thinner triangles would slow down ray casting.
  std::vector<double> stops{start, end};
  for (const Opening& opening : openings) {
    for (const Vector2d& corner : opening.outline()) stops.push_back(corner.x());
  }
  std::sort(stops.begin(), stops.end());
  const auto is_same = [](double a, double b) { return b - a < same; };
  stops.erase(std::unique(stops.begin(), stops.end(), is_same), stops.end());

  std::vector<Polyline2> tiles;
  const auto add_column = [&](double left, double right) {
    double left_low = bottom, right_low = bottom;
    const auto add_tiles_to = [&](double left_high, double right_high) {
      const double height = std::max(left_high - left_low, right_high - right_low);
      const int count = static_cast<int>(std::ceil(height / max_height - 1e-9));
      const auto level = [&](double low, double high, int i) {
        return low + (high - low) * i / count;
      };
      for (int i = 0; i < count; ++i) {
        tiles.push_back({{left, level(left_low, left_high, i)},
                         {right, level(right_low, right_high, i)},
                         {right, level(right_low, right_high, i + 1)},
                         {left, level(left_low, left_high, i + 1)}});
      }
    };
    for (const Opening& opening : openings) {  // In ascending order.
      const double middle = 0.5 * (left + right);
      if (std::abs(middle - opening.centre) > opening.half_width) continue;
      add_tiles_to(opening.sill, opening.sill);
      left_low = opening.head_height(left, middle);
      right_low = opening.head_height(right, middle);
    }
    add_tiles_to(top, top);
  };
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    const int count = static_cast<int>(std::ceil((stops[i + 1] - stops[i]) / max_width - 1e-9));
    for (int j = 0; j < count; ++j) {
      const double step = (stops[i + 1] - stops[i]) / count;
      add_column(stops[i] + j * step, stops[i] + (j + 1) * step);
    }
  }
  return tiles;
}

Band build(const Wall& wall) {
  WallBuilder builder(wall);
  builder.lay_out_tiles();
  builder.raise_stones();
  builder.find_edges();
  return builder.result();
}

}  // namespace skycap::sim::models
