#include "missions/online/live/pose_covariance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/online/live/scan_input.h"

namespace skycap::missions::online {
namespace {

using Matrix = PoseCovariance::Matrix;

constexpr double farthest = 100.0, widest = 90.0;  // Maximum standard deviations [m, degrees].
constexpr double rounding = 1e-6;                  // Tolerance of correlations, for float input.
constexpr std::array<const char*, 6> names{"x", "y", "z", "rx", "ry", "rz"};

double largest_deviation(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, axes.eigenvalues().maxCoeff()));
}

Matrix to_matrix(const std::vector<double>& numbers) {
  Matrix matrix;
  std::size_t at = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = numbers.size() == 36 ? 0 : row; column < 6; ++column) {
      matrix(row, column) = numbers[at++];
      if (numbers.size() == 21) matrix(column, row) = matrix(row, column);
    }
  }
  return matrix;
}

/// Returns the reason why a matrix is not a valid pose covariance; empty if it is valid.
std::string find_defect(const Matrix& matrix) {
  Matrix correlations = Matrix::Identity();
  for (int i = 0; i < 6; ++i) {
    const double max = i < 3 ? farthest : widest * geometry::radians_per_degree;
    if (!(matrix(i, i) >= 0.0 && matrix(i, i) <= max * max)) {
      return fmt::format("the variance of {} is {:.6g}; it must be from 0 to {:.6g} {}", names[i],
                         matrix(i, i), max * max, i < 3 ? "m^2 (100 m)" : "rad^2 (90 degrees)");
    }
  }
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) {
      const double scale = std::sqrt(matrix(i, i)) * std::sqrt(matrix(j, j));
      const double above = matrix(j, i), below = matrix(i, j);
      if (!(std::abs(above - below) <= rounding * scale)) {
        return fmt::format("is not symmetric: {},{} is {:.6g}, {},{} is {:.6g}", names[j], names[i],
                           above, names[i], names[j], below);
      }
      if (!(std::abs(above) <= (1.0 + rounding) * scale)) {
        return fmt::format("{},{} is {:.6g}, beyond the limit set by the variances of {} and {}",
                           names[j], names[i], above, names[j], names[i]);
      }
      correlations(i, j) = correlations(j, i) = scale > 0.0 ? 0.5 * (above + below) / scale : 0.0;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> axes(correlations, Eigen::EigenvaluesOnly);
  if (axes.eigenvalues().minCoeff() >= -6.0 * rounding) return {};
  return "is not positive semidefinite and therefore not a covariance";
}

}  // namespace

PoseCovariance PoseCovariance::of(double position, double angle) {
  Vector variances;
  variances << Eigen::Vector3d::Constant(position * position),
      Eigen::Vector3d::Constant(angle * angle);
  return {variances.asDiagonal()};
}

double PoseCovariance::position() const { return largest_deviation(matrix.topLeftCorner<3, 3>()); }

double PoseCovariance::angle() const { return largest_deviation(matrix.bottomRightCorner<3, 3>()); }

double PoseCovariance::deviation(const Vector& direction) const {
  return std::sqrt(std::max(0.0, direction.dot(matrix * direction)));
}

double PoseCovariance::distance(const Vector& error, double position, double angle) const {
  const Matrix all = matrix + of(position, angle).matrix;
  return std::sqrt(std::max(0.0, error.dot(all.ldlt().solve(error))));
}

std::vector<double> PoseCovariance::triangle() const {
  std::vector<double> numbers;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) numbers.push_back(matrix(row, column));
  }
  return numbers;
}

PoseCovariance parse_pose_sigma(const std::string& text, const std::string& what) {
  const std::vector<double> n = parse_numbers(text, what);
  const bool is_good =
      n.size() == 2 && n[0] >= 0.0 && n[0] <= farthest && n[1] >= 0.0 && n[1] <= widest;
  if (is_good) return PoseCovariance::of(n[0], n[1] * geometry::radians_per_degree);
  throw Error(ErrorKind::bad_usage,
              what + ": must be \"metres degrees\", from 0 to 100 and from 0 to 90");
}

PoseCovariance parse_pose_covariance(const std::string& text, const std::string& what) {
  const std::vector<double> numbers = parse_numbers(text, what);
  if (numbers.size() != 36 && numbers.size() != 21) {
    throw Error(
        ErrorKind::bad_usage,
        fmt::format("{}: has {} numbers; it must contain a covariance of x y z rx ry rz [m, rad]: "
                    "all 36 numbers row by row, or the 21 numbers of its upper triangle",
                    what, numbers.size()));
  }
  const Matrix matrix = to_matrix(numbers);
  const std::string fault = find_defect(matrix);
  if (!fault.empty()) throw Error(ErrorKind::bad_usage, what + ": " + fault);
  return {0.5 * (matrix + matrix.transpose())};
}

}  // namespace skycap::missions::online
