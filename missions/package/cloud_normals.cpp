#include "missions/package/cloud_normals.h"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "geometry/parallel.h"
#include "geometry/points/spaced_points.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3f;

constexpr std::size_t points_in_a_task = 4096;

/// Returns the normal of the best-fitting plane through `neighbours`, oriented towards the sensor.
Vector3f plane_normal(std::span<const Vector3f> neighbours, const Vector3f& point,
                      const Vector3f& to_sensor) {
  if (neighbours.size() < 3) return to_sensor;
  // Single precision is sufficient because the sums are relative to `point`.
  Vector3f sum = Vector3f::Zero();
  float xx = 0.0F, xy = 0.0F, xz = 0.0F, yy = 0.0F, yz = 0.0F, zz = 0.0F;
  for (const Vector3f& neighbour : neighbours) {
    const Vector3f offset = neighbour - point;
    sum += offset;
    xx += offset.x() * offset.x();
    xy += offset.x() * offset.y();
    xz += offset.x() * offset.z();
    yy += offset.y() * offset.y();
    yz += offset.y() * offset.z();
    zz += offset.z() * offset.z();
  }
  Eigen::Matrix3f squares;
  squares << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  const Vector3f mean = sum / static_cast<float>(neighbours.size());
  const Eigen::Matrix3f covariance = squares - sum * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes(covariance);
  const Vector3f normal = axes.eigenvectors().col(0).normalized();
  if (!normal.allFinite()) return to_sensor;
  return normal.dot(to_sensor) < 0.0F ? Vector3f(-normal) : normal;
}

}  // namespace

std::vector<Vector3f> cloud_normals(const geometry::PointCloud& cloud,
                                    std::span<const Eigen::Vector3d> sensors, double radius,
                                    unsigned threads, const std::stop_token& stop) {
  geometry::SpacedPoints surface(0.25 * radius);
  geometry::PointGrid grid(radius);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % points_in_a_task == 0 && stop.stop_requested()) return {};
    if (surface.keep(cloud.positions[i])) grid.insert(cloud.positions[i]);
  }
  std::vector<Vector3f> normals(cloud.size());
  const std::size_t tasks = (cloud.size() + points_in_a_task - 1) / points_in_a_task;
  geometry::parallel_for(tasks, threads, [&](std::size_t task) {
    if (stop.stop_requested()) return;
    std::vector<Vector3f> neighbours;
    const std::size_t end = std::min(cloud.size(), (task + 1) * points_in_a_task);
    for (std::size_t i = task * points_in_a_task; i < end; ++i) {
      const Vector3f& point = cloud.positions[i];
      neighbours.clear();
      grid.find_points_within(point, radius, neighbours);
      const Vector3f to_sensor =
          (sensors[cloud.views[i]] - point.cast<double>()).normalized().cast<float>();
      normals[i] = plane_normal(neighbours, point, to_sensor);
    }
  });
  if (stop.stop_requested()) normals.clear();
  return normals;
}

}  // namespace skycap::missions::package
