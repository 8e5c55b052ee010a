#include "geometry/points/principal_axes.h"

#include <Eigen/Eigenvalues>

namespace skycap::geometry {

using Eigen::Matrix3d;
using Eigen::Vector3d;

PrincipalAxes principal_axes(std::span<const Eigen::Vector3f> points) {
  Vector3d mean = Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) mean += p.cast<double>();
  mean /= static_cast<double>(points.size());
  Matrix3d covariance = Matrix3d::Zero();
  for (const Eigen::Vector3f& p : points) {
    const Vector3d offset = p.cast<double>() - mean;
    covariance += offset * offset.transpose();
  }
  covariance /= static_cast<double>(points.size());
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  return {mean, solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace skycap::geometry
