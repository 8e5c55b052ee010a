#include "clients/ros2/frames.h"

#include <cmath>
#include <sstream>
#include <vector>

#include "geometry/error.h"

namespace skycap::ros2 {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

[[noreturn]] void reject(const std::string& what) { throw Error(ErrorKind::bad_geometry, what); }

bool is_unit_length(const Quaterniond& turn) { return std::abs(turn.norm() - 1.0) < 1e-2; }

Isometry3d isometry(const Matrix3d& turn, const Vector3d& position) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = turn;
  pose.translation() = position;
  return pose;
}

/// Returns the matrix of the cross product with v.
Matrix3d cross_matrix(const Vector3d& v) {
  return (Matrix3d() << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0).finished();
}

/// Returns std::nullopt if all elements are zero, which means unknown in ROS.
std::optional<Covariance> read_covariance(const double (&numbers)[36]) {
  const Covariance given =
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(&numbers[0]);
  if (!given.allFinite()) reject("its covariance is not finite");
  if ((given.array() == 0.0).all()) return std::nullopt;
  if ((given.diagonal().array() < 0.0).any()) reject("its covariance has a negative variance");
  const double difference = (given - given.transpose()).cwiseAbs().maxCoeff();
  if (difference > 1e-6 * given.cwiseAbs().maxCoeff()) reject("its covariance is not symmetric");
  return 0.5 * (given + given.transpose());
}

BodyPose checked_pose(const Vector3d& position, const QuaternionMessage& given) {
  if (!position.allFinite()) reject("its position is not finite");
  constexpr double farthest = 1e7;  // Limit of all external positions [m].
  if (position.cwiseAbs().maxCoeff() > farthest)
    reject("its position is more than 10,000 km from the origin");
  const Quaterniond turn(given.w, given.x, given.y, given.z);
  if (!is_unit_length(turn)) reject("its quaternion must have unit length");
  return {.position = position, .turn = turn.normalized(), .covariance = {}};
}

}  // namespace

BodyPose body_pose(const Odometry& odometry) {
  const PoseMessage& given = odometry.pose.pose;
  BodyPose pose =
      checked_pose({given.position.x, given.position.y, given.position.z}, given.orientation);
  pose.covariance = read_covariance(odometry.pose.covariance);
  return pose;
}

BodyPose body_pose(const TransformMessage& transform) {
  const auto& [x, y, z] = transform.translation;
  return checked_pose({x, y, z}, transform.rotation);
}

Isometry3d to_isometry(const BodyPose& pose) {
  return isometry(pose.turn.toRotationMatrix(), pose.position);
}

Matrix3d optical_from(Axes axes) {
  if (axes == Axes::optical) return Matrix3d::Identity();
  // Right is -left, down is -up, forward is forward.
  return (Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished();
}

Mount::Mount(const Isometry3d& body_from_sensor, Axes axes)
    : axes_(axes),
      body_from_optical_(body_from_sensor *
                         isometry(optical_from(axes).transpose(), Vector3d::Zero())) {}

Isometry3d Mount::world_from_optical(const BodyPose& body) const {
  return to_isometry(body) * body_from_optical_;
}

Isometry3d Mount::world_from_body(const Isometry3d& world_from_optical) const {
  return world_from_optical * body_from_optical_.inverse();
}

std::optional<Covariance> Mount::covariance_at_sensor(const BodyPose& body) const {
  if (!body.covariance) return std::nullopt;
  // The sensor is at p + R l; exp(w) moves it by w x R l.
  const Vector3d lever = body.turn.toRotationMatrix() * body_from_optical_.translation();
  Covariance sensor_from_body = Covariance::Identity();
  sensor_from_body.topRightCorner<3, 3>() = -cross_matrix(lever);
  const Covariance moved = sensor_from_body * *body.covariance * sensor_from_body.transpose();
  return 0.5 * (moved + moved.transpose());
}

Isometry3d parse_extrinsic(const std::string& text, const std::string& what) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  std::vector<double> n;
  for (double number = 0.0; stream >> number;) n.push_back(number);
  if (!stream.eof() || n.size() != 7 || !is_unit_length({n[6], n[3], n[4], n[5]})) {
    throw Error(ErrorKind::bad_usage,
                what + " is '" + text + "'; it must be x y z qx qy qz qw, with a unit quaternion");
  }
  return isometry(Quaterniond(n[6], n[3], n[4], n[5]).normalized().toRotationMatrix(),
                  {n[0], n[1], n[2]});
}

}  // namespace skycap::ros2
