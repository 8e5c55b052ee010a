// Families of houses: hollow, among trees, on a slope, in lanes.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/models/families/families.h"
#include "sim/models/masonry/elements.h"
#include "sim/models/masonry/tree.h"

namespace skycap::sim::models {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

/// Adds four walls around `room`. The wall towards -y has a gate in its middle, unless the gate
/// width is 0.
void add_walls(const AlignedBox3d& room, double thickness, double gate_width, double gate_height,
               Parts& parts) {
  const Vector3d low = room.min(), high = room.max();
  const double x0 = low.x() - thickness, x1 = high.x() + thickness;
  const double y0 = low.y() - thickness, y1 = high.y() + thickness;
  parts.push_back({"wall", box({x0, low.y(), low.z()}, {low.x(), high.y(), high.z()})});
  parts.push_back({"wall", box({high.x(), low.y(), low.z()}, {x1, high.y(), high.z()})});
  parts.push_back({"wall", box({x0, high.y(), low.z()}, {x1, y1, high.z()})});
  if (gate_width <= 0.0) {
    parts.push_back({"wall", box({x0, y0, low.z()}, {x1, low.y(), high.z()})});
    return;
  }
  const double middle = room.center().x(), half = 0.5 * gate_width, head = low.z() + gate_height;
  parts.push_back({"wall", box({x0, y0, low.z()}, {middle - half, low.y(), high.z()})});
  parts.push_back({"wall", box({middle + half, y0, low.z()}, {x1, low.y(), high.z()})});
  parts.push_back({"lintel", box({middle - half, y0, head}, {middle + half, low.y(), high.z()})});
}

/// Returns a plain house around the origin with a gabled roof, whose ridge is along x.
Parts plain_house(double width, double depth, double eaves, double slope, RandomNumbers& draw) {
  Parts parts;
  parts.push_back({"walls", block(0.0, 0.0, width, depth, 0.0, eaves)});
  parts.push_back({"roof", gabled_roof(width, depth, eaves, slope)});
  const double x = draw.between(-0.3, 0.3) * width, ridge = eaves + slope * 0.5 * depth;
  parts.push_back({"chimney", block(x, 0.6, 0.9, 0.7, eaves, ridge + draw.between(0.8, 1.5))});
  for (double at = -0.5 * width + 1.5; at < 0.5 * width - 1.0; at += 2.4) {
    for (double sill = 0.9; sill < eaves - 1.6; sill += 2.9) {
      for (const double side : {-1.0, 1.0}) {
        const double face = side * 0.5 * depth;
        parts.push_back({"sill", block(at, face + side * 0.08, 1.3, 0.3, sill - 0.12, sill)});
        parts.push_back({"hood", block(at, face + side * 0.06, 1.3, 0.24, sill + 1.4, sill + 1.5)});
      }
    }
  }
  return parts;
}

void add_at(Parts&& scene, double azimuth, const Vector3d& at, Parts& parts) {
  for (Part& part : scene) {
    parts.push_back({std::move(part.name), moved(turned(std::move(part.mesh), azimuth), at)});
  }
}

/// Height of a slope at a position of the plan.
struct Slope {
  double tilt, azimuth, wave, phase;

  double operator()(double x, double y) const {
    const double along = x * std::cos(azimuth) + y * std::sin(azimuth);
    return 9.0 + tilt * along + wave * std::sin(0.16 * x + phase) * std::cos(0.19 * y - phase);
  }
};

/// Returns the solid between the slope and z = 0 below a square.
Mesh hill(const Slope& slope, double side) {
  constexpr int steps = 40;
  Mesh mesh;
  for (const bool is_top : {true, false}) {
    for (int j = 0; j <= steps; ++j) {
      for (int i = 0; i <= steps; ++i) {
        const double x = side * (static_cast<double>(i) / steps - 0.5);
        const double y = side * (static_cast<double>(j) / steps - 0.5);
        mesh.vertices.emplace_back(x, y, is_top ? slope(x, y) : 0.0);
      }
    }
  }
  const auto at = [](int i, int j, bool is_top) {
    constexpr int row = steps + 1;
    return static_cast<std::uint32_t>((is_top ? 0 : row * row) + j * row + i);
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      quad(at(i, j, true), at(i + 1, j, true), at(i + 1, j + 1, true), at(i, j + 1, true));
      quad(at(i, j, false), at(i, j + 1, false), at(i + 1, j + 1, false), at(i + 1, j, false));
    }
    quad(at(j, 0, false), at(j + 1, 0, false), at(j + 1, 0, true), at(j, 0, true));
    quad(at(j + 1, steps, false), at(j, steps, false), at(j, steps, true), at(j + 1, steps, true));
    quad(at(0, j + 1, false), at(0, j, false), at(0, j, true), at(0, j + 1, true));
    quad(at(steps, j, false), at(steps, j + 1, false), at(steps, j + 1, true), at(steps, j, true));
  }
  return mesh;
}

}  // namespace

FamilyScene hollow_house(RandomNumbers& draw, const Fineness&) {
  const double width = draw.between(13.0, 20.0), depth = draw.between(8.0, 12.0);
  const double storey = draw.between(3.2, 3.8), wall = 0.3;
  const int upper = draw.integer(1, 3);
  const double share = draw.between(0.4, 0.6);  // Fraction of the ground floor for the hall.
  const double gate_width = draw.between(3.6, 5.0);
  FamilyScene scene;
  Parts& parts = scene.parts;
  const double x0 = -0.5 * width, y0 = -0.5 * depth, y1 = 0.5 * depth, split = x0 + share * width;
  parts.push_back({"floor", block(0.0, 0.0, width + 2.0 * wall, depth + 2.0 * wall, 0.0, 0.2)});
  const AlignedBox3d hall(Vector3d(x0, y0, 0.2), Vector3d(split, y1, 0.2 + storey));
  const AlignedBox3d store(Vector3d(split + wall, y0, 0.2),
                           Vector3d(0.5 * width, y1, 0.2 + storey));
  add_walls(hall, wall, std::min(gate_width, 0.8 * share * width), 2.9, parts);
  add_walls(store, wall, 0.0, 0.0, parts);
  scene.open_rooms.push_back(hall);
  scene.sealed_rooms.push_back(store);
  double level = 0.2 + storey;
  for (int i = 0; i < upper; ++i) {
    const AlignedBox3d room(Vector3d(x0, y0, level + wall),
                            Vector3d(0.5 * width, y1, level + wall + 2.8));
    parts.push_back(
        {"ceiling", block(0.0, 0.0, width + 2.0 * wall, depth + 2.0 * wall, level, level + wall)});
    add_walls(room, wall, 0.0, 0.0, parts);
    scene.sealed_rooms.push_back(room);
    level += wall + 2.8;
  }
  parts.push_back({"roof", gabled_roof(width + 2.0 * wall, depth + 2.0 * wall, level + 0.25,
                                       draw.between(0.6, 1.1))});
  return scene;
}

FamilyScene grove(RandomNumbers& draw, const Fineness& fineness) {
  FamilyScene scene;
  const double width = draw.between(14.0, 20.0), depth = draw.between(8.0, 11.0);
  const double eaves = draw.between(5.5, 8.0), slope = draw.between(0.7, 1.0);
  scene.parts = plain_house(width, depth, eaves, slope, draw);
  const int count = draw.integer(7, 11);
  for (int i = 0; i < count; ++i) {
    // Trees around the house with crowns near or against its walls.
    const double angle = 2.0 * pi * (i + draw.between(0.2, 0.8)) / count;
    const double height = draw.between(5.0, 11.0), gap = draw.between(2.2, 4.5);
    const double x = std::cos(angle), y = std::sin(angle);
    const double reach = std::min(0.5 * width / std::max(1e-9, std::abs(x)),
                                  0.5 * depth / std::max(1e-9, std::abs(y)));
    Parts tree = models::tree(height, draw, fineness);
    add_at(std::move(tree), 0.0, {(reach + gap) * x, (reach + gap) * y, 0.0}, scene.parts);
  }
  return scene;
}

FamilyScene hillside(RandomNumbers& draw, const Fineness&) {
  const double tilt = draw.between(0.1, 0.2), azimuth = draw.between(0.0, 2.0 * pi);
  const double wave = draw.between(0.4, 1.2), phase = draw.between(0.0, 2.0 * pi);
  const Slope slope{tilt, azimuth, wave, phase};
  FamilyScene scene;
  scene.parts.push_back({"hill", hill(slope, 56.0)});
  const int count = draw.integer(3, 4);
  const double turn = draw.between(0.0, pi);
  for (int i = 0; i < count; ++i) {
    const double angle = turn + 2.0 * pi * i / count, radius = draw.between(11.0, 15.0);
    const double x = radius * std::cos(angle), y = radius * std::sin(angle);
    const double width = draw.between(8.0, 11.0), depth = draw.between(6.0, 8.0);
    // The foot of the house is below the ground on all sides.
    double foot = slope(x, y);
    for (int j = 0; j < 16; ++j) {
      const double at = 2.0 * pi * j / 16, reach = 0.5 * std::hypot(width, depth);
      foot = std::min(foot, slope(x + reach * std::cos(at), y + reach * std::sin(at)));
    }
    const double eaves = draw.between(5.0, 7.0), pitch = draw.between(0.7, 1.0);
    Parts house = plain_house(width, depth, eaves, pitch, draw);
    add_at(std::move(house), draw.between(0.0, pi), {x, y, foot - 0.3}, scene.parts);
  }
  return scene;
}

FamilyScene old_town(RandomNumbers& draw, const Fineness&) {
  FamilyScene scene;
  const int columns = draw.integer(3, 4), rows = 3;
  const int bridged = draw.integer(0, columns - 2);  // Lane below a house, in the middle row.
  double x = -0.5 * columns * 12.0;
  for (int i = 0; i < columns; ++i) {
    const double width = draw.between(8.5, 10.5), lane = draw.between(2.6, 4.0);
    double y = -18.0;
    for (int j = 0; j < rows; ++j) {
      const double depth = draw.between(7.5, 9.5), eaves = draw.between(6.5, 11.0);
      Parts house = plain_house(width, depth, eaves, draw.between(0.8, 1.2), draw);
      add_at(std::move(house), 0.0, {x + 0.5 * width, y + 0.5 * depth, 0.0}, scene.parts);
      if (i == bridged && j == 1) {  // Rooms above the lane, from this house into the next one.
        scene.parts.push_back({"rooms over the lane", box({x + width - 0.5, y + 1.5, 3.4},
                                                          {x + width + lane + 0.5, y + 5.5, 6.2})});
        scene.open_rooms.emplace_back(Vector3d(x + width, y + 1.5, 0.0),
                                      Vector3d(x + width + lane, y + 5.5, 3.4));
      }
      y += depth + draw.between(2.6, 4.0);
    }
    x += width + lane;
  }
  return scene;
}

}  // namespace skycap::sim::models
