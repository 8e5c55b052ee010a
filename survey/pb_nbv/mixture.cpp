#include "survey/pb_nbv/mixture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>

#include "geometry/random_numbers.h"

namespace skycap::survey::pb_nbv {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t min_released_components = 5;

struct Component {
  double weight = 0.0;
  Vector3d mean = Vector3d::Zero();
  Matrix3d precision = Matrix3d::Identity();  ///< inverse covariance
  double log_norm = 0.0;                      ///< logarithm of weight times the density at the mean
};

/// Result of one fit.
struct Fit {
  std::vector<Component> components;
  double log_likelihood = 0.0;
  double log_posteriors = 0.0;  ///< sum of the logarithms of the largest posterior probabilities
  std::vector<std::uint32_t> likeliest;
};

/// Draws the initial means (Arthur & Vassilvitskii, k-means++, 2007).
std::vector<Vector3d> draw_means(std::span<const Vector3d> points, std::size_t count,
                                 geometry::RandomNumbers& random) {
  std::vector<Vector3d> means{points[random() % points.size()]};
  std::vector<double> squared(points.size(), std::numeric_limits<double>::infinity());
  while (means.size() < count) {
    double sum = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      squared[i] = std::min(squared[i], (points[i] - means.back()).squaredNorm());
      sum += squared[i];
    }
    double left = sum * random.uniform();
    std::size_t drawn = points.size() - 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      left -= squared[i];
      if (left >= 0.0) continue;
      drawn = i;
      break;
    }
    means.push_back(points[drawn]);
  }
  return means;
}

class Mixture {
 public:
  Mixture(std::span<const Vector3d> points, double voxel, std::size_t count, Reading reading,
          geometry::RandomNumbers& random)
      : points_(points),
        floor_(voxel * voxel / 12.0),  // variance of a uniform distribution over a voxel
        reading_(reading),
        posteriors_(points.size() * count) {
    const std::vector<Vector3d> means = draw_means(points, count, random);
    fit_.components.resize(count);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto nearest = std::ranges::min_element(
          means, {}, [&](const Vector3d& mean) { return (points[i] - mean).squaredNorm(); });
      posteriors_[i * count + static_cast<std::size_t>(nearest - means.begin())] = 1.0;
    }
  }

  Fit fit() {
    constexpr int max_rounds = 100;
    constexpr double tolerance = 1e-6;  // of the log-likelihood per point
    double before = -std::numeric_limits<double>::infinity();
    for (int round = 0; round < max_rounds; ++round) {
      maximise();
      expect();
      const double gain = fit_.log_likelihood - before;
      if (gain < tolerance * static_cast<double>(points_.size())) break;
      before = fit_.log_likelihood;
    }
    return std::move(fit_);
  }

 private:
  void maximise() {
    const std::size_t count = fit_.components.size();
    for (std::size_t k = 0; k < count; ++k) {
      Component& component = fit_.components[k];
      double sum = 0.0;
      Vector3d mean = Vector3d::Zero();
      for (std::size_t i = 0; i < points_.size(); ++i) {
        sum += posteriors_[i * count + k];
        mean += posteriors_[i * count + k] * points_[i];
      }
      component.weight = sum / static_cast<double>(points_.size());
      if (component.weight < 1e-12) {
        component.log_norm = -std::numeric_limits<double>::infinity();
        continue;
      }
      component.mean = mean / sum;
      Matrix3d covariance = Matrix3d::Zero();
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const Vector3d offset = points_[i] - component.mean;
        covariance += posteriors_[i * count + k] * offset * offset.transpose();
      }
      covariance /= sum;
      if (reading_ == Reading::released) {
        covariance = (covariance.trace() / 3.0) * Matrix3d::Identity();
      }
      covariance += floor_ * Matrix3d::Identity();
      component.precision = covariance.inverse();
      component.log_norm =
          std::log(component.weight) -
          0.5 * (3.0 * std::log(2.0 * std::numbers::pi) + std::log(covariance.determinant()));
    }
  }

  void expect() {
    const std::size_t count = fit_.components.size();
    fit_.log_likelihood = fit_.log_posteriors = 0.0;
    fit_.likeliest.assign(points_.size(), 0);
    std::vector<double> logs(count);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      for (std::size_t k = 0; k < count; ++k) {
        const Component& component = fit_.components[k];
        const Vector3d offset = points_[i] - component.mean;
        logs[k] = component.log_norm - 0.5 * offset.dot(component.precision * offset);
      }
      const auto max = std::ranges::max_element(logs);
      double sum = 0.0;
      for (const double log : logs) sum += std::exp(log - *max);
      for (std::size_t k = 0; k < count; ++k) {
        posteriors_[i * count + k] = std::exp(logs[k] - *max) / sum;
      }
      fit_.log_likelihood += *max + std::log(sum);
      fit_.log_posteriors -= std::log(sum);
      fit_.likeliest[i] = static_cast<std::uint32_t>(max - logs.begin());
    }
  }

  std::span<const Vector3d> points_;
  double floor_;
  Reading reading_;
  std::vector<double> posteriors_;  // by point, then by component
  Fit fit_;
};

double compute_criterion(const Fit& fit, std::size_t points, Reading reading) {
  const double log_points = std::log(static_cast<double>(points));
  if (reading == Reading::released) return 3.0 * log_points - 2.0 * fit.log_posteriors;
  // A mean, a covariance and a weight each; the weights sum up to 1.
  const double parameters = 10.0 * static_cast<double>(fit.components.size()) - 1.0;
  return parameters * log_points - 2.0 * fit.log_likelihood;
}

/// Numbers the components in use consecutively.
Clusters compact(const std::vector<std::uint32_t>& likeliest, std::size_t components) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(components, unused);
  Clusters clusters;
  for (const std::uint32_t component : likeliest) {
    if (number[component] == unused) {
      number[component] = static_cast<std::uint32_t>(clusters.count++);
    }
    clusters.component.push_back(number[component]);
  }
  return clusters;
}

}  // namespace

Clusters find_clusters(std::span<const Vector3d> points, double voxel, std::size_t max_components,
                       Reading reading, std::uint64_t seed) {
  if (points.empty() || max_components == 0) return {};
  std::size_t max = max_components, min = 1;
  if (points.size() <= 3) {
    max = 1;
  } else if (points.size() < 2 * max_components) {
    max = points.size() / 2;
  }
  if (reading == Reading::released) min = std::min(min_released_components, max);
  Clusters best;
  double best_criterion = std::numeric_limits<double>::infinity();
  for (std::size_t count = min; count <= max; ++count) {
    geometry::RandomNumbers random(seed, count);
    const Fit fit = Mixture(points, voxel, count, reading, random).fit();
    const double criterion = compute_criterion(fit, points.size(), reading);
    if (criterion >= best_criterion) continue;
    best_criterion = criterion;
    best = compact(fit.likeliest, count);
  }
  return best;
}

}  // namespace skycap::survey::pb_nbv
