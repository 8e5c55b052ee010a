#include "survey/pb_nbv/ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/LU>

namespace skycap::survey::pb_nbv {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

/// Symmetric matrix of a conic in pixels, negative inside.
using Conic = Matrix3d;

/// Returns the conic of the projected ellipsoid, or nullopt if it has no elliptic image.
std::optional<Conic> project(const Ellipsoid& ellipsoid, const Eigen::Isometry3d& camera_from_world,
                             const ScoreImage& image) {
  const Vector3d centre = camera_from_world * ellipsoid.centre;
  if (centre.z() <= 0.0) return std::nullopt;
  const Matrix3d rotation = camera_from_world.linear();
  const Matrix3d shape = rotation * ellipsoid.shape * rotation.transpose();
  // The nearest point of the ellipsoid must be in front of the camera. This excludes cameras inside
  // it, and outlines that are not ellipses.
  if (centre.z() * centre.z() <= shape(2, 2)) return std::nullopt;
  // Dual quadric Q* = [S - c c^T, -c; -c^T, -1] (Hartley & Zisserman, 2nd ed., Eq. 8.5), so that
  // the dual conic is C* = K (S - c c^T) K^T.
  const Matrix3d dual =
      image.calibration * (shape - centre * centre.transpose()) * image.calibration.transpose();
  Conic conic = dual.inverse();
  // The dual conic of an ellipse in front of the camera has dual(2, 2) < 0; its inverse is positive
  // at infinity and negative at the centre.
  const Vector3d inside = image.calibration * centre;
  if (inside.dot(conic * inside) > 0.0) conic = -conic;
  return conic;
}

/// Counts the pixel centres with conic(u, v) <= 0, row by row.
std::size_t count_inside(const Conic& conic, const ScoreImage& image) {
  const double a = conic(0, 0);
  if (!(a > 0.0)) return 0;
  std::size_t count = 0;
  for (int v = 0; v < image.height; ++v) {
    const double half_b = conic(0, 1) * v + conic(0, 2);
    const double c = conic(1, 1) * v * v + 2.0 * conic(1, 2) * v + conic(2, 2);
    const double discriminant = half_b * half_b - a * c;
    if (!(discriminant >= 0.0)) continue;
    const double root = std::sqrt(discriminant);
    const double first = std::max(0.0, std::ceil((-half_b - root) / a));
    const double last = std::min(image.width - 1.0, std::floor((-half_b + root) / a));
    if (last >= first) count += static_cast<std::size_t>(last - first) + 1;
  }
  return count;
}

/// Returns the ellipse drawn by the released code: the correct centre and angle, but semi-axes from
/// the sine and cosine of the angle in degrees. Nullopt if a semi-axis is imaginary.
std::optional<Conic> misdraw(const Conic& conic) {
  const Eigen::Matrix2d form = conic.topLeftCorner<2, 2>();
  const Eigen::Vector2d centre = form.inverse() * Eigen::Vector2d(-conic(0, 2), -conic(1, 2));
  const Vector3d at(centre.x(), centre.y(), 1.0);
  const double scale = -at.dot(conic * at);
  const double angle = 0.5 * std::atan2(2.0 * form(0, 1), form(0, 0) - form(1, 1));
  const double degrees = angle * 180.0 / std::numbers::pi;  // taken for radians
  const auto squared_axis = [&](double cosine, double sine) {
    return scale / (form(0, 0) * cosine * cosine + 2.0 * form(0, 1) * cosine * sine +
                    form(1, 1) * sine * sine);
  };
  const double cosine = std::cos(degrees), sine = std::sin(degrees);
  const double first = squared_axis(cosine, sine), second = squared_axis(-sine, cosine);
  if (!(first > 0.0 && second > 0.0)) return std::nullopt;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Eigen::Matrix2d drawn =
      turn * Eigen::Vector2d(1.0 / first, 1.0 / second).asDiagonal() * turn.transpose();
  Conic result;
  result.topLeftCorner<2, 2>() = drawn;
  result.topRightCorner<2, 1>() = -drawn * centre;
  result.bottomLeftCorner<1, 2>() = (-drawn * centre).transpose();
  result(2, 2) = centre.dot(drawn * centre) - 1.0;
  return result;
}

}  // namespace

std::optional<Ellipsoid> enclose(std::span<const Vector3d> points) {
  if (points.size() < 4) return std::nullopt;
  constexpr double dimension = 3.0;
  constexpr double tolerance = 0.01;
  constexpr int max_rounds = 10'000;
  // Coordinates relative to the mean, because the 4 x 4 matrix is badly conditioned far from it.
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  double size = 0.0;
  for (const Vector3d& point : points) size = std::max(size, (point - mean).norm());
  if (!(size > 0.0)) return std::nullopt;
  std::vector<Vector4d> lifted;
  for (const Vector3d& point : points) {
    const Vector3d scaled = (point - mean) / size;
    lifted.emplace_back(scaled.x(), scaled.y(), scaled.z(), 1.0);
  }
  std::vector<double> weights(points.size(), 1.0 / static_cast<double>(points.size()));
  for (int round = 0; round < max_rounds; ++round) {
    Matrix4d moments = Matrix4d::Zero();
    for (std::size_t i = 0; i < lifted.size(); ++i) {
      moments += weights[i] * lifted[i] * lifted[i].transpose();
    }
    if (!(moments.determinant() > 1e-14)) return std::nullopt;
    const Matrix4d inverse = moments.inverse();
    double max = 0.0, min = std::numeric_limits<double>::infinity();
    std::size_t farthest = 0, nearest = 0;
    for (std::size_t i = 0; i < lifted.size(); ++i) {
      const double distance = lifted[i].dot(inverse * lifted[i]);
      if (distance > max) max = distance, farthest = i;
      if (weights[i] > 0.0 && distance < min) min = distance, nearest = i;
    }
    const double above = max / (dimension + 1.0) - 1.0, below = 1.0 - min / (dimension + 1.0);
    if (above <= tolerance) break;
    // Steps towards the farthest point, or away from the nearest one (Todd & Yildirim, 2007).
    if (above >= below) {
      const double step = (max - dimension - 1.0) / ((dimension + 1.0) * (max - 1.0));
      for (double& weight : weights) weight *= 1.0 - step;
      weights[farthest] += step;
    } else {
      const double most = weights[nearest] / (1.0 - weights[nearest]);
      const double step =
          std::min((dimension + 1.0 - min) / ((dimension + 1.0) * (min - 1.0)), most);
      const bool is_dropped = !(step < most);
      for (double& weight : weights) weight *= 1.0 + step;
      weights[nearest] = is_dropped ? 0.0 : weights[nearest] - step;
    }
  }
  Vector3d centre = Vector3d::Zero();
  for (std::size_t i = 0; i < lifted.size(); ++i) centre += weights[i] * lifted[i].head<3>();
  Matrix3d scatter = Matrix3d::Zero();
  for (std::size_t i = 0; i < lifted.size(); ++i) {
    const Vector3d offset = lifted[i].head<3>() - centre;
    scatter += weights[i] * offset * offset.transpose();
  }
  const Matrix3d inverse = scatter.inverse();
  double max = 0.0;
  for (const Vector4d& point : lifted) {
    const Vector3d offset = point.head<3>() - centre;
    max = std::max(max, offset.dot(inverse * offset));
  }
  if (!std::isfinite(max)) return std::nullopt;
  return Ellipsoid{mean + size * centre, size * size * max * scatter};
}

std::size_t count_pixels(const Ellipsoid& ellipsoid, const Eigen::Isometry3d& camera_from_world,
                         const ScoreImage& image, Reading reading) {
  std::optional<Conic> conic = project(ellipsoid, camera_from_world, image);
  if (conic && reading == Reading::released) conic = misdraw(*conic);
  return conic ? count_inside(*conic, image) : 0;
}

}  // namespace skycap::survey::pb_nbv
