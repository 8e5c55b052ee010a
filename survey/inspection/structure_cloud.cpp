#include "survey/inspection/structure_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "geometry/error.h"
#include "geometry/points/principal_axes.h"
#include "geometry/points/spatial_index.h"

namespace skycap::survey::inspection {
namespace {

using Eigen::Vector3f;

constexpr std::size_t plane_neighbours = 10, radius_neighbour = 6;
constexpr float max_radius_ratio = 2.5F;

/// Returns the indices of the first occurrences of all distinct finite points, ascending.
std::vector<std::uint32_t> distinct_points(std::span<const Vector3f> points) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite()) order.push_back(i);
  }
  const auto key = [&](std::uint32_t i) {
    return std::array{points[i].x(), points[i].y(), points[i].z()};
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    const auto left = key(a), right = key(b);
    return left != right ? left < right : a < b;
  });
  // std::ranges::unique does not compile with clang 14.
  order.erase(std::unique(order.begin(), order.end(),
                          [&](std::uint32_t a, std::uint32_t b) { return points[a] == points[b]; }),
              order.end());
  std::ranges::sort(order);
  return order;
}

/// Returns a typical distance between neighbouring points, for the spatial index [m].
double typical_spacing(const StructureCloud& cloud) {
  const Eigen::Vector3d sides = cloud.box().sizes();
  const double area = sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x();
  const double spacing = std::sqrt(2.0 * area / static_cast<double>(cloud.size()));
  return std::max(spacing, 1e-3);
}

/// Axes of the faces of a cube: forward, right and up as indices, and the sign of forward.
struct CubeFace {
  int forward, right, up;
  float sign;
};
constexpr std::array<CubeFace, 6> cube_faces{{{0, 1, 2, 1.0F},
                                              {0, 1, 2, -1.0F},
                                              {1, 2, 0, 1.0F},
                                              {1, 2, 0, -1.0F},
                                              {2, 0, 1, 1.0F},
                                              {2, 0, 1, -1.0F}}};

/// Returns the coordinates of a vector on a face: right, up, forward.
Vector3f on_face(const CubeFace& face, const Vector3f& vector) {
  return {vector[face.right], vector[face.up], face.sign * vector[face.forward]};
}

/// Range of tangents [from, to] under which a sphere may appear along one axis of a face.
struct TangentRange {
  float from, to;
};
TangentRange tangents_of(float across, float forward, float radius) {
  const float near = forward - radius, far = forward + radius;
  const float low = across - radius, high = across + radius;
  if (near <= 0.0F) return {-1.0F, 1.0F};
  return {low < 0.0F ? low / near : low / far, high > 0.0F ? high / near : high / far};
}

}  // namespace

Eigen::AlignedBox3d StructureCloud::box() const {
  Eigen::AlignedBox3d box;
  for (const Vector3f& point : points) box.extend(point.cast<double>());
  return box;
}

StructureCloud make_structure_cloud(std::span<const Vector3f> points,
                                    std::span<const Vector3f> normals) {
  StructureCloud cloud;
  const std::vector<std::uint32_t> kept = distinct_points(points);
  if (kept.size() < min_structure_points) {
    throw Error(ErrorKind::bad_geometry, "the structure has " + std::to_string(kept.size()) +
                                             " distinct points, and at least " +
                                             std::to_string(min_structure_points) +
                                             " are required; use a complete point cloud");
  }
  for (const std::uint32_t i : kept) {
    cloud.points.push_back(points[i]);
    if (!normals.empty()) cloud.normals.push_back(normals[i]);
  }
  constexpr double spacings = 3.0;
  geometry::SpatialIndex index(spacings * typical_spacing(cloud));
  for (const Vector3f& point : cloud.points) index.insert(point);
  std::vector<Vector3f> near;
  for (const Vector3f& point : cloud.points) {
    const auto neighbours = index.nearest(point, plane_neighbours + 1);
    const std::size_t sixth = std::min(radius_neighbour, neighbours.size() - 1);
    cloud.radii.push_back(std::sqrt(neighbours[sixth].squared_distance));
    if (!normals.empty()) continue;
    near.clear();
    for (const geometry::Neighbour& neighbour : neighbours) {
      near.push_back(cloud.points[neighbour.index]);
    }
    cloud.normals.push_back(geometry::principal_axes(near).axes.col(0).cast<float>());
  }
  std::vector<float> sorted = cloud.radii;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  cloud.median_radius = *middle;
  for (float& radius : cloud.radii) {
    radius = std::min(radius, max_radius_ratio * cloud.median_radius);
  }
  return cloud;
}

DepthCube::DepthCube(int resolution) : resolution_(resolution) {
  for (int i = 0; i < resolution; ++i) {
    slopes_.push_back(-1.0F +
                      2.0F * (static_cast<float>(i) + 0.5F) / static_cast<float>(resolution));
  }
  depths_.resize(cube_faces.size() * slopes_.size() * slopes_.size());
}

void DepthCube::draw(const StructureCloud& cloud, std::span<const std::uint32_t> discs,
                     const Vector3f& eye) {
  eye_ = eye;
  std::ranges::fill(depths_, std::numeric_limits<float>::infinity());
  for (const std::uint32_t disc : discs) {
    const Vector3f centre = cloud.points[disc] - eye;
    const float radius = cloud.radii[disc];
    for (std::size_t i = 0; i < cube_faces.size(); ++i) {
      const Vector3f on = on_face(cube_faces[i], centre);
      if (on.z() + radius <= 0.0F) continue;
      if (std::abs(on.x()) - radius > on.z() + radius ||
          std::abs(on.y()) - radius > on.z() + radius) {
        continue;
      }
      draw_face(i, on, on_face(cube_faces[i], cloud.normals[disc]), radius);
    }
  }
}

void DepthCube::draw_face(std::size_t face, const Vector3f& centre, const Vector3f& normal,
                          float radius) {
  const auto size = static_cast<std::size_t>(resolution_);
  const float half = 0.5F * static_cast<float>(resolution_);
  const auto first = [&](float tangent) {
    return std::max(0,
                    static_cast<int>(std::ceil((std::max(tangent, -1.0F) + 1.0F) * half - 0.5F)));
  };
  const auto last = [&](float tangent) {
    return std::min(resolution_ - 1,
                    static_cast<int>(std::floor((std::min(tangent, 1.0F) + 1.0F) * half - 0.5F)));
  };
  const TangentRange across = tangents_of(centre.x(), centre.z(), radius);
  const TangentRange along = tangents_of(centre.y(), centre.z(), radius);
  const int from = first(across.from), to = last(across.to);
  const float offset = normal.dot(centre), squared_radius = radius * radius;
  constexpr float min_cosine = 0.001F;
  for (int row = first(along.from); row <= last(along.to); ++row) {
    const float up = slopes_[static_cast<std::size_t>(row)];
    float* const depths = depths_.data() + (face * size + static_cast<std::size_t>(row)) * size;
    for (int column = from; column <= to; ++column) {
      const float right = slopes_[static_cast<std::size_t>(column)];
      const float length = std::sqrt(right * right + up * up + 1.0F);
      const float cosine = normal.x() * right + normal.y() * up + normal.z();
      if (std::abs(cosine) < min_cosine * length) continue;
      const float scale = offset / cosine;
      if (scale <= 0.0F) continue;
      const float x = scale * right - centre.x(), y = scale * up - centre.y();
      const float z = scale - centre.z();
      if (x * x + y * y + z * z > squared_radius) continue;
      depths[column] = std::min(depths[column], scale * length);
    }
  }
}

bool DepthCube::is_visible(const StructureCloud& cloud, std::uint32_t point,
                           float tolerance) const {
  const Vector3f line = cloud.points[point] - eye_;
  const Vector3f size = line.cwiseAbs();
  int axis = 0;
  if (size.y() > size[axis]) axis = 1;
  if (size.z() > size[axis]) axis = 2;
  const std::size_t face = static_cast<std::size_t>(2 * axis) + (line[axis] < 0.0F ? 1 : 0);
  const Vector3f on = on_face(cube_faces[face], line);
  if (!(on.z() > 0.0F)) return true;
  const float half = 0.5F * static_cast<float>(resolution_);
  const auto pixel = [&](float tangent) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>((tangent + 1.0F) * half), 0, resolution_ - 1));
  };
  const auto resolution = static_cast<std::size_t>(resolution_);
  const float depth =
      depths_[(face * resolution + pixel(on.y() / on.z())) * resolution + pixel(on.x() / on.z())];
  return depth >= line.norm() - tolerance * cloud.radii[point];
}

}  // namespace skycap::survey::inspection
