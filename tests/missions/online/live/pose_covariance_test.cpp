#include "missions/online/live/pose_covariance.h"

#include <cmath>
#include <random>
#include <string>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "missions/support/number_text.h"
#include "tests/support/complaint.h"

namespace skycap::missions::online {
namespace {

using Eigen::MatrixXd;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::thrown_message;
using Matrix = PoseCovariance::Matrix;
using Vector = PoseCovariance::Vector;

/// Formats the matrix by rows: all elements, or the upper triangle.
std::string format_covariance(const Matrix& matrix, bool is_whole) {
  std::string text;
  for (int row = 0; row < 6; ++row) {
    for (int column = is_whole ? 0 : row; column < 6; ++column) {
      text += support::exact_text(matrix(row, column)) + " ";
    }
  }
  return text;
}

/// Returns the root L of a covariance: pose errors are L n with independent unit normals n.
Matrix some_root(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> number(0.0, 0.1);
  Matrix root;
  for (double& value : root.reshaped()) value = number(random);
  return root;
}

TEST(PoseCovariance, ReadsFullMatrixOrUpperTriangle) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Matrix root = some_root(seed), matrix = root * root.transpose();
    for (const bool is_whole : {true, false}) {
      const PoseCovariance read = parse_pose_covariance(format_covariance(matrix, is_whole), "c");
      EXPECT_LT((read.matrix - matrix).norm(), 1e-15) << seed;
      EXPECT_TRUE(read.matrix == read.matrix.transpose());
    }
  }
}

/// ROS: "In order, the parameters are: (x, y, z, rotation about X axis, rotation about Y axis,
/// rotation about Z axis)".
TEST(PoseCovariance, UsesRosOrder) {
  std::string text;
  for (int i = 1; i <= 6; ++i) {
    for (int j = 1; j <= 6; ++j) text += i == j ? std::to_string(i) + "e-2 " : "0 ";
  }
  const PoseCovariance read = parse_pose_covariance(text, "c");
  EXPECT_DOUBLE_EQ(read.position(), std::sqrt(0.03));
  EXPECT_DOUBLE_EQ(read.angle(), std::sqrt(0.06));
  for (int i = 0; i < 6; ++i) {
    EXPECT_DOUBLE_EQ(read.deviation(Vector::Unit(i)), std::sqrt(0.01 * (i + 1)));
  }
}

TEST(PoseCovariance, IsIsotropicForSigma) {
  const PoseCovariance covariance = parse_pose_sigma("0.05 2", "s");
  const double angle = 2.0 * geometry::radians_per_degree;
  EXPECT_DOUBLE_EQ(covariance.position(), 0.05);
  EXPECT_DOUBLE_EQ(covariance.angle(), angle);
  Vector direction;
  direction << 3.0, 0.0, -4.0, 0.0, 12.0, 5.0;
  EXPECT_DOUBLE_EQ(covariance.deviation(direction), std::hypot(0.05 * 5.0, angle * 13.0));
}

TEST(PoseCovariance, ComputesDeviationsLikeMatrixRoot) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Matrix root = some_root(seed);
    const PoseCovariance covariance{root * root.transpose()};
    const Vector direction = some_root(seed + 100).col(0);
    EXPECT_NEAR(covariance.deviation(direction), (root.transpose() * direction).norm(), 1e-12);
    const auto largest = [](const MatrixXd& rows) {
      return Eigen::JacobiSVD<MatrixXd>(rows).singularValues()(0);
    };
    EXPECT_NEAR(covariance.position(), largest(root.topRows<3>()), 1e-9);
    EXPECT_NEAR(covariance.angle(), largest(root.bottomRows<3>()), 1e-9);
  }
}

TEST(PoseCovariance, ComputesDistanceInStandardDeviations) {
  Vector error;
  error << 0.3, 0.0, 0.0, 0.0, 0.0, 0.04;
  // With zero covariance, only the additional errors remain.
  EXPECT_NEAR(PoseCovariance{}.distance(error, 0.1, 0.01), 5.0, 1e-12);
  // Correlated errors with the expected signs have a smaller distance than errors with other signs.
  PoseCovariance together;
  together.matrix(0, 0) = 0.09;
  together.matrix(5, 5) = 0.0016;
  together.matrix(0, 5) = together.matrix(5, 0) = 0.3 * 0.04;
  EXPECT_NEAR(together.distance(error, 1e-6, 1e-6), 1.0, 1e-6);
  error(5) = -0.04;
  EXPECT_GT(together.distance(error, 1e-3, 1e-3), 30.0);
}

/// Filters produce such matrices, with rounding errors and without uncertainty along some axes.
TEST(PoseCovariance, AcceptsRoundedAndSingularMatrices) {
  Vector once;
  once << 0.1, -0.2, 0.3, 0.01, 0.02, -0.03;
  const Matrix singular = (once * once.transpose()).cast<float>().cast<double>();
  EXPECT_NEAR(
      parse_pose_covariance(format_covariance(singular, true), "c").deviation(Vector::Unit(2)), 0.3,
      1e-7);
  EXPECT_EQ(parse_pose_covariance(format_covariance(Matrix::Zero(), false), "c").position(), 0.0);
}

TEST(PoseCovariance, RejectsInvalidInputInOneLine) {
  const auto error_message = [](const std::string& text) {
    const std::string what = thrown_message([&] { parse_pose_covariance(text, "c"); });
    EXPECT_EQ(what.find('\n'), std::string::npos);
    EXPECT_TRUE(what.starts_with("c: ")) << what;
    return what;
  };
  const auto with = [&](int row, int column, double value, double other) {
    Matrix matrix = Matrix::Identity() * 0.01;
    matrix(row, column) = value;
    matrix(column, row) = other;
    return error_message(format_covariance(matrix, true));
  };
  EXPECT_THAT(error_message("1 2 3"), HasSubstr("has 3 numbers; it must contain a covariance"));
  EXPECT_THAT(error_message(""), HasSubstr("has 0 numbers"));
  EXPECT_THAT(with(2, 2, NAN, NAN), HasSubstr("finite"));
  EXPECT_THAT(with(2, 2, INFINITY, INFINITY), HasSubstr("finite"));
  EXPECT_THAT(error_message("a" + format_covariance(Matrix::Zero(), true)),
              HasSubstr("expected a number"));
  EXPECT_THAT(with(4, 4, -1e-9, -1e-9), HasSubstr("the variance of ry is -1e-09"));
  EXPECT_THAT(with(0, 0, 1e6, 1e6), HasSubstr("the variance of x is 1e+06; it must be from 0 to"));
  EXPECT_THAT(with(5, 5, 9.0, 9.0), HasSubstr("rad^2"));
  EXPECT_THAT(with(0, 1, 0.001, 0.002), HasSubstr("is not symmetric: x,y is 0.001, y,x is 0.002"));
  EXPECT_THAT(with(3, 5, 0.011, 0.011),
              HasSubstr("rx,rz is 0.011, beyond the limit set by the variances"));
  Matrix impossible = Matrix::Identity() * 0.01;  // each pair alone would be valid
  for (const auto& [row, column, value] :
       {std::tuple(0, 1, 0.009), {1, 2, 0.009}, {0, 2, -0.009}}) {
    impossible(row, column) = impossible(column, row) = value;
  }
  EXPECT_THAT(error_message(format_covariance(impossible, false)),
              HasSubstr("not positive semidefinite"));
  EXPECT_THAT(error_message(format_covariance(Matrix::Identity() * 1e308, true)),
              HasSubstr("variance of x"));
}

TEST(PoseSigma, RejectsInvalidInput) {
  for (const std::string text : {"", "1", "1 2 3", "-1 0", "101 0", "0 91", "nan 1", "0.1 x"}) {
    EXPECT_THAT(thrown_message([&] { parse_pose_sigma(text, "s"); }), HasSubstr("s: ")) << text;
  }
}

}  // namespace
}  // namespace skycap::missions::online
