#include "missions/online/live/box_sight.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;

constexpr int samples_a_side = 40;

}  // namespace

BoxSight::BoxSight(const std::optional<Eigen::AlignedBox3d>& box,
                   const geometry::CameraConfig& camera)
    : box_(box), camera_(camera) {
  if (!box_) return;
  const Vector3d size = box_->sizes();
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double area = size[u] * size[v] / (samples_a_side * samples_a_side);
    for (const Vector3d& corner : {box_->min(), box_->max()}) {
      for (int i = 0; i < samples_a_side; ++i) {
        for (int j = 0; j < samples_a_side; ++j) {
          Vector3d sample = box_->min();
          sample[axis] = corner[axis];
          sample[u] += size[u] * (i + 0.5) / samples_a_side;
          sample[v] += size[v] * (j + 0.5) / samples_a_side;
          samples_.push_back(sample);
          areas_.push_back(area);
        }
      }
    }
  }
  is_seen_.assign(samples_.size(), 0);
}

void BoxSight::add(const geometry::Scan& scan) {
  if (!box_) return;
  ++scans_;
  points_ += scan.points.size();
  for (const Eigen::Vector3f& point : scan.points) {
    if (!box_->contains(point.cast<double>())) ++outside_;
  }
  const Eigen::Isometry3d sensor_from_world = scan.world_from_sensor.inverse();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (is_seen_[i] != 0) continue;
    is_seen_[i] = camera_.project(sensor_from_world * samples_[i]).has_value() ? 1 : 0;
  }
}

double BoxSight::outside_share() const {
  return points_ == 0 ? 0.0 : static_cast<double>(outside_) / static_cast<double>(points_);
}

std::optional<double> BoxSight::unseen_share() const {
  if (!box_ || scans_ == 0) return std::nullopt;
  double all = 0.0, unobserved = 0.0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    all += areas_[i];
    if (is_seen_[i] == 0) unobserved += areas_[i];
  }
  return unobserved / all;
}

}  // namespace skycap::missions::online
