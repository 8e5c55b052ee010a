#include "sim/models/masonry/solids.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "geometry/surfaces/ear_clipping.h"

namespace skycap::sim::models {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

double distance_to_segment(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
  const double length = (b - a).squaredNorm();
  const double share = length == 0.0 ? 0.0 : std::clamp((point - a).dot(b - a) / length, 0.0, 1.0);
  return (point - a - share * (b - a)).norm();
}

/// Returns the line simplified by the method of Douglas and Peucker. It keeps both ends and all
/// points farther than `tolerance` from the simplified line.
Polyline2 simplified(const Polyline2& line, double tolerance) {
  std::vector<char> is_kept(line.size(), 0);
  is_kept.front() = is_kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> subdivisions{{0, line.size() - 1}};
  while (!subdivisions.empty()) {
    const auto [first, last] = subdivisions.back();
    subdivisions.pop_back();
    std::size_t farthest = first;
    double distance = tolerance;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double away = distance_to_segment(line[i], line[first], line[last]);
      if (away > distance) farthest = i, distance = away;
    }
    if (farthest == first) continue;
    is_kept[farthest] = 1;
    subdivisions.emplace_back(first, farthest);
    subdivisions.emplace_back(farthest, last);
  }
  Polyline2 result;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (is_kept[i]) result.push_back(line[i]);
  }
  return result;
}

/// Reverses the triangles if the surface faces inwards.
Mesh facing_outwards(Mesh mesh) {
  if (signed_volume(mesh) >= 0.0) return mesh;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// Adds triangles between two neighbouring rings of `size` vertices.
void join_rings(std::uint32_t lower, std::uint32_t upper, std::uint32_t size, Mesh& mesh) {
  for (std::uint32_t i = 0; i < size; ++i) {
    const std::uint32_t next = (i + 1) % size;
    mesh.triangles.push_back({lower + i, lower + next, upper + next});
    mesh.triangles.push_back({lower + i, upper + next, upper + i});
  }
}

/// Returns the area vector of a flat ring (Newell's formula).
Vector3d area_vector(const Polyline3& ring) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    sum += (ring[i] - ring[0]).cross(ring[(i + 1) % ring.size()] - ring[0]);
  }
  return 0.5 * sum;
}

/// Returns the ring in the coordinates of its own plane, counter-clockwise.
Polyline2 flattened(const Polyline3& ring) {
  const Vector3d normal = area_vector(ring).normalized();
  Vector3d axis = Vector3d::Zero();
  Eigen::Index smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  axis[smallest] = 1.0;
  const Vector3d right = axis.cross(normal).normalized(), ahead = normal.cross(right);
  Polyline2 flat;
  for (const Vector3d& point : ring) flat.emplace_back(point.dot(right), point.dot(ahead));
  return flat;
}

}  // namespace

int Fineness::chords(double radius, double angle) const {
  const double ratio = std::clamp(1.0 - chord_error / radius, 0.5, 1.0);
  return std::max(1,
                  static_cast<int>(std::ceil(std::abs(angle) / (2.0 * std::acos(ratio)) - 1e-9)));
}

int Fineness::circle(double radius, int multiple) const {
  return (chords(radius, 2.0 * pi) + multiple - 1) / multiple * multiple;
}

double chord_length(const Fineness& fineness, double radius) {
  return 2.0 * pi * radius / fineness.chords(radius, 2.0 * pi);
}

Profile::Profile(const Fineness& fineness, double x, double y)
    : fineness_(fineness), points_{Vector2d(x, y)} {}

Profile& Profile::to(double x, double y) {
  points_.emplace_back(x, y);
  return *this;
}

Profile& Profile::by(double dx, double dy) {
  return to(points_.back().x() + dx, points_.back().y() + dy);
}

Profile& Profile::arc_to(double x, double y, double angle) {
  const Vector2d start = points_.back(), end(x, y);
  const double radius = (end - start).norm() / (2.0 * std::abs(std::sin(0.5 * angle)));
  const int chords = fineness_.chords(radius, angle);
  // A point of the arc by its angle: the inscribed angle gives direction and length of the chord.
  for (int i = 1; i < chords; ++i) {
    const double gone = angle * i / chords;
    const Vector2d chord = Eigen::Rotation2Dd(0.5 * (gone - angle)) * (end - start);
    points_.push_back(start + chord * (std::sin(0.5 * gone) / std::sin(0.5 * angle)));
  }
  return to(x, y);
}

Profile& Profile::arc_by(double dx, double dy, double angle) {
  return arc_to(points_.back().x() + dx, points_.back().y() + dy, angle);
}

Profile& Profile::wave_by(double dx, double dy, double angle) {
  return arc_by(0.5 * dx, 0.5 * dy, angle).arc_by(0.5 * dx, 0.5 * dy, -angle);
}

Polyline2 Profile::points() const { return simplified(points_, 0.5 * fineness_.chord_error); }

Mesh revolve(const Polyline2& profile, int chords) {
  assert(profile.size() >= 3 && profile.front().x() == 0.0 && profile.back().x() == 0.0);
  const auto size = static_cast<std::uint32_t>(chords);
  Mesh mesh;
  for (std::size_t i = 1; i + 1 < profile.size(); ++i) {
    for (int j = 0; j < chords; ++j) {
      const double azimuth = 2.0 * pi * j / chords, radius = profile[i].x();
      mesh.vertices.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth),
                                 profile[i].y());
    }
    if (i > 1) {
      const auto upper = static_cast<std::uint32_t>(mesh.vertices.size()) - size;
      join_rings(upper - size, upper, size, mesh);
    }
  }
  const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::uint32_t last = bottom - size;
  mesh.vertices.emplace_back(0.0, 0.0, profile.front().y());
  mesh.vertices.emplace_back(0.0, 0.0, profile.back().y());
  for (std::uint32_t j = 0; j < size; ++j) {
    const std::uint32_t next = (j + 1) % size;
    mesh.triangles.push_back({bottom, next, j});
    mesh.triangles.push_back({bottom + 1, last + j, last + next});
  }
  return mesh;
}

Mesh revolve_ring(const Polyline2& profile, int chords) {
  Mesh mesh;
  for (const Vector2d& point : profile) {
    for (int j = 0; j < chords; ++j) {
      const double azimuth = 2.0 * pi * j / chords;
      mesh.vertices.emplace_back(point.x() * std::cos(azimuth), point.x() * std::sin(azimuth),
                                 point.y());
    }
  }
  const auto size = static_cast<std::uint32_t>(chords);
  const auto rings = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t i = 0; i < rings; ++i) {
    join_rings(i * size, (i + 1) % rings * size, size, mesh);
  }
  return facing_outwards(std::move(mesh));
}

Mesh loft(const std::vector<Polyline3>& rings) {
  const auto size = static_cast<std::uint32_t>(rings.front().size());
  Mesh mesh;
  for (const Polyline3& ring : rings) {
    assert(ring.size() == size);
    mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
    const auto end = static_cast<std::uint32_t>(mesh.vertices.size());
    if (end > size) join_rings(end - 2 * size, end - size, size, mesh);
  }
  // flattened() views a ring from the side on which it is counter-clockwise. For the first ring,
  // that is against the path direction exactly if it is along the path for the last one.
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size()) - size;
  for (const auto& [a, b, c] : geometry::clip_ears(flattened(rings.front()))) {
    mesh.triangles.push_back({a, c, b});
  }
  for (const auto& [a, b, c] : geometry::clip_ears(flattened(rings.back()))) {
    mesh.triangles.push_back({last + a, last + b, last + c});
  }
  return facing_outwards(std::move(mesh));
}

Mesh extrude(const Polyline2& outline, double back, double front) {
  std::vector<Polyline3> rings(2);
  for (const Vector2d& point : outline) {
    rings[0].emplace_back(back, point.x(), point.y());
    rings[1].emplace_back(front, point.x(), point.y());
  }
  return loft(rings);
}

Mesh box(const Vector3d& smallest, const Vector3d& largest) {
  return extrude({{smallest.y(), smallest.z()},
                  {largest.y(), smallest.z()},
                  {largest.y(), largest.z()},
                  {smallest.y(), largest.z()}},
                 smallest.x(), largest.x());
}

Mesh sweep(const Polyline2& section, const Polyline3& path, const Vector3d& up, bool is_closed) {
  const std::size_t count = path.size();
  const auto leg_left_normal = [&](std::size_t leg) {
    return Vector3d(up.cross(path[(leg + 1) % count] - path[leg % count]).normalized());
  };
  std::vector<Polyline3> rings;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_first = !is_closed && i == 0, is_last = !is_closed && i + 1 == count;
    const Vector3d before = leg_left_normal(is_first ? 0 : i + count - 1);
    const Vector3d after = is_last ? before : leg_left_normal(i);
    // At the mitre, the mouldings of both legs have their own distance from the path.
    const Vector3d sideways = (before + after) / (1.0 + before.dot(after));
    Polyline3& ring = rings.emplace_back();
    for (const Vector2d& point : section) {
      ring.push_back(path[i] + point.x() * sideways + point.y() * up);
    }
  }
  if (!is_closed) return loft(rings);

  Mesh mesh;
  const auto size = static_cast<std::uint32_t>(section.size());
  for (const Polyline3& ring : rings) {
    mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    join_rings(i * size, (i + 1) % static_cast<std::uint32_t>(count) * size, size, mesh);
  }
  return facing_outwards(std::move(mesh));
}

Mesh turned(Mesh mesh, double azimuth) {
  transform(mesh, Eigen::Affine3d(Eigen::AngleAxisd(azimuth, Vector3d::UnitZ())));
  return mesh;
}

Mesh moved(Mesh mesh, const Vector3d& by) {
  for (Vector3d& vertex : mesh.vertices) vertex += by;
  return mesh;
}

double signed_volume(const Mesh& mesh) {
  if (mesh.vertices.empty()) return 0.0;
  const Vector3d origin = mesh.vertices.front();  // Close to the solid, which limits cancellation.
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += (mesh.vertices[a] - origin)
                  .dot((mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin));
  }
  return volume / 6.0;
}

Mesh join(const Parts& parts) {
  std::size_t vertices = 0, triangles = 0;
  for (const Part& part : parts) {
    vertices += part.mesh.vertices.size();
    triangles += part.mesh.triangles.size();
  }
  Mesh mesh;
  mesh.vertices.reserve(vertices);
  mesh.triangles.reserve(triangles);
  for (const Part& part : parts) append(mesh, part.mesh);
  return mesh;
}

}  // namespace skycap::sim::models
