#include "survey/see/view_adjustment.h"

#include <cmath>

#include <Eigen/Geometry>

namespace skycap::survey::see {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// Returns the direction from the frontier to the adjusted sensor position.
Vector3d adjusted_direction(const Frontier& frontier, const Vector3d& from_centroid, double gain,
                            double distance, Adjustment adjustment) {
  const auto& [n, e_f, e_b] = frontier.frame;
  const double a1 = from_centroid.dot(e_f), a2 = from_centroid.dot(e_b);
  const double s = gain, d = distance;
  Vector3d u = frontier.view.position - frontier.position;
  if (adjustment == Adjustment::shift) {
    return (u + (s + 1.0) * (a1 * e_f + a2 * e_b)).normalized();
  }
  // theta is the difference between the angles of the shifted view and of the centroid at the
  // distance d.
  const double theta1 = std::atan(s * a1 * d / (d * d + (s + 1.0) * a1 * a1));
  const double theta2 = std::atan(s * a2 * d / (d * d + (s + 1.0) * a2 * a2));
  u = AngleAxisd(theta1, e_b) * (u + (s + 1.0) * a1 * e_f);
  u = AngleAxisd(theta2, e_f) * (u + (s + 1.0) * a2 * e_b);
  return u.normalized();
}

}  // namespace

Vector3d centroid(std::span<const Eigen::Vector3f> points) {
  Vector3d sum = Vector3d::Zero();
  for (const Eigen::Vector3f& point : points) sum += point.cast<double>();
  return sum / static_cast<double>(points.size());
}

std::vector<Eigen::Vector3f> points_inside(std::span<const Eigen::Vector3f> points,
                                           const Eigen::AlignedBox3d& box) {
  std::vector<Eigen::Vector3f> inside;
  for (const Eigen::Vector3f& point : points) {
    if (box.contains(point.cast<double>())) inside.push_back(point);
  }
  return inside;
}

bool adjust_view(Frontier& frontier, AttemptRecord& record, const Vector3d& scan_centroid,
                 const ViewPlacement& placement, Adjustment adjustment) {
  if (adjustment == Adjustment::none) return false;
  const Vector3d from_centroid = frontier.position - scan_centroid;
  const double centroid_distance = from_centroid.norm();
  if (centroid_distance < record.best_distance) {
    const Vector3d direction =
        adjusted_direction(frontier, from_centroid, record.gain, placement.distance, adjustment);
    frontier.view = place_view(frontier.position, direction, placement);
    record.best_distance = centroid_distance;
    record.gain *= 2.0;
    return true;
  }
  if (!record.may_switch) return false;
  const Vector3d observing = (frontier.observed_from - frontier.position).normalized();
  frontier.view = place_view(frontier.position, observing, placement);
  record = {.may_switch = false, .views = record.views};
  return true;
}

}  // namespace skycap::survey::see
