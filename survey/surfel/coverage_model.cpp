#include "survey/surfel/coverage_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace skycap::survey::surfel {
namespace {

/// Returns the probability that a point is inside a ball. The point is displaced by isotropic noise
/// from a position at distance `offset` from the centre. Non-central chi distribution with 3
/// degrees of freedom.
double probability_in_ball(double offset, double radius, double sigma) {
  using std::numbers::pi;
  using std::numbers::sqrt2;
  if (sigma < 1e-3 * radius) return offset < radius ? 1.0 : 0.0;
  if (offset < 1e-3 * sigma) {
    const double ratio = radius / sigma;
    return std::erf(ratio / sqrt2) - std::sqrt(2.0 / pi) * ratio * std::exp(-0.5 * ratio * ratio);
  }
  const double near = (offset - radius) / (sqrt2 * sigma),
               far = (offset + radius) / (sqrt2 * sigma);
  const double probability =
      0.5 * (std::erf(far) - std::erf(near)) -
      sigma / (offset * std::sqrt(2.0 * pi)) * (std::exp(-near * near) - std::exp(-far * far));
  return std::clamp(probability, 0.0, 1.0);
}

/// Lookup table of probability_in_ball(), which is evaluated a million times.
class BallTable {
 public:
  BallTable(double radius, double sigma) : reach_(radius + 4.0 * sigma) {
    for (int i = 0; i <= step_count; ++i) {
      table_[i] = probability_in_ball(reach_ * i / step_count, radius, sigma);
    }
  }
  double operator()(double offset) const {
    const double step = offset / reach_ * step_count;
    if (step >= step_count) return 0.0;
    const auto below = static_cast<std::size_t>(step);
    return table_[below] +
           (step - static_cast<double>(below)) * (table_[below + 1] - table_[below]);
  }
  double reach() const { return reach_; }

 private:
  static constexpr int step_count = 512;
  double reach_;
  std::array<double, step_count + 1> table_;
};

/// Probability that the return of a ray is inside the ball. The ray hits the plane at (across,
/// along) from the centre of the ball; `along` is in the plane of incidence. Noise along the ray is
/// integrated by the midpoint rule over 3 standard deviations.
class RayTable {
 public:
  RayTable(double radius, const Noise& noise) : ball_(radius, noise.isotropic) {
    if (noise.along_ray <= 0.0) {
      nodes_.push_back({0.0, 1.0});
      return;
    }
    // The integrand is the product of two bell curves with these widths. With at least one node per
    // width of the product, the rule is nearly exact. Without isotropic noise, the border of the
    // ball is sharp.
    constexpr int min_nodes = 7, max_nodes = 41;
    const double ratio = noise.along_ray / std::max(noise.isotropic, 1e-9 * noise.along_ray);
    const int nodes = static_cast<int>(
        std::clamp(std::ceil(6.0 * std::hypot(1.0, ratio)), double{min_nodes}, double{max_nodes}));
    double total = 0.0;
    for (int i = 0; i < nodes; ++i) {
      const double z = 3.0 * (2.0 * (i + 0.5) / nodes - 1.0);
      nodes_.push_back({z * noise.along_ray, std::exp(-0.5 * z * z)});
      total += nodes_.back().weight;
    }
    for (Node& node : nodes_) node.weight /= total;
  }

  /// `lift` is the displacement of the whole observation across the surface.
  double operator()(double across, double along, double cosine, double sine, double lift) const {
    double probability = 0.0;
    for (const Node& node : nodes_) {
      const double lateral = along + node.displacement * sine;
      const double normal = node.displacement * cosine + lift;
      const double squared = across * across + lateral * lateral + normal * normal;
      if (squared < ball_.reach() * ball_.reach()) {
        probability += node.weight * ball_(std::sqrt(squared));
      }
    }
    return probability;
  }

  double reach_across() const { return ball_.reach(); }
  double reach_along(double sine) const {
    return ball_.reach() + std::abs(nodes_.front().displacement) * sine;
  }

 private:
  struct Node {
    double displacement, weight;
  };
  BallTable ball_;
  std::vector<Node> nodes_;
};

/// Returns 1 - f of the class comment for a grid of this spacing perpendicular to the rays, and an
/// observation displaced by `lift`.
double uncovered_share(const RayTable& ray, double spacing, double cosine, bool even, double lift) {
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const double step_along = spacing / cosine;
  const int reach_across = static_cast<int>(ray.reach_across() / spacing) + 1;
  const int reach_along = static_cast<int>(ray.reach_along(sine) / step_along) + 1;
  // By symmetry, a quarter of a grid cell represents the whole cell. If noise blurs the grid, two
  // offsets per axis are sufficient.
  const int offsets = even ? 2 : 8;
  double share = 0.0;
  for (int a = 0; a < offsets; ++a) {
    for (int b = 0; b < offsets; ++b) {
      const double offset_across = 0.5 * (a + 0.5) / offsets,
                   offset_along = 0.5 * (b + 0.5) / offsets;
      double missed = 1.0;
      for (int i = -reach_across; i <= reach_across; ++i) {
        for (int j = -reach_along; j <= reach_along; ++j) {
          missed *= 1.0 - ray((i + offset_across) * spacing, (j + offset_along) * step_along,
                              cosine, sine, lift);
        }
        if (missed <= 0.0) break;
      }
      share += missed / (offsets * offsets);
    }
  }
  return share;
}

/// Returns the mean of uncovered_share() over displacements with this standard deviation, by the
/// midpoint rule. Positive and negative displacements are symmetric.
double mean_uncovered_share(const RayTable& ray, double spacing, double cosine, bool even,
                            double deviation) {
  if (deviation <= 0.0) return uncovered_share(ray, spacing, cosine, even, 0.0);
  constexpr int min_nodes = 6,
                max_nodes = 40;  // four nodes within the reach of the ball, if possible
  const int nodes = static_cast<int>(std::clamp(std::ceil(12.0 * deviation / ray.reach_across()),
                                                double{min_nodes}, double{max_nodes}));
  double share = 0.0, total = 0.0;
  for (int i = 0; i < nodes; ++i) {
    const double z = 3.0 * (i + 0.5) / nodes, weight = std::exp(-0.5 * z * z);
    share += weight * uncovered_share(ray, spacing, cosine, even, z * deviation);
    total += weight;
  }
  return share / total;
}

}  // namespace

double Noise::across(double cos_incidence) const {
  return std::hypot(isotropic, along_ray * cos_incidence);
}

double Noise::lateral_error(double cos_incidence, double z) const {
  // A rotation moves points perpendicular to the ray.
  const double sine = std::sqrt(std::max(0.0, 1.0 - cos_incidence * cos_incidence));
  return std::hypot(position, angle * z * sine);
}

Noise Noise::at(double z) const {
  if (growing == 0.0) return *this;
  const double factor = std::sqrt(1.0 - growing + growing * std::pow(z / depth, 4));
  return {.isotropic = factor * isotropic,
          .along_ray = factor * along_ray,
          .position = position,
          .angle = angle};
}

bool Noise::is_similar(const Noise& other, double tolerance) const {
  const double change =
      std::abs(other.isotropic - isotropic) + std::abs(other.along_ray - along_ray);
  const double growth = std::abs(other.growing - growing);
  return change <= tolerance * across(1.0) && growth <= tolerance;
}

CoverageModel::CoverageModel(double coverage_radius, const Noise& noise, double ray_spacing)
    : coverage_radius_(coverage_radius), noise_(noise) {
  const RayTable constant(coverage_radius, noise);
  for (int c = 0; c < incidence_count; ++c) {
    // At grazing incidence, the grid degenerates and nothing useful is measured.
    const double cosine = std::max(0.05, static_cast<double>(c) / (incidence_count - 1));
    for (int d = 0; d < density_count; ++d) {
      // Two nodes per octave, at 1 and 1.5 times its start, so that hazard() interpolates linearly
      // in the density.
      const int octave = d / 2;
      const double rays = std::exp2(double{first_octave} + octave) * (d % 2 == 0 ? 1.0 : 1.5);
      const double spacing = coverage_radius * std::sqrt(cosine / rays);
      const Noise here = noise.at(spacing / ray_spacing);
      const bool even = here.isotropic > 0.6 * spacing / cosine;
      const double displaced = noise.lateral_error(cosine, spacing / ray_spacing);
      const double uncovered =
          mean_uncovered_share(noise.growing > 0.0 ? RayTable(coverage_radius, here) : constant,
                               spacing, cosine, even, displaced);
      const double hazard =
          -std::log(std::max(uncovered, std::exp(-static_cast<double>(max_hazard))));
      hazard_per_ray_[c][d] = static_cast<float>(hazard / rays);
    }
  }
}

}  // namespace skycap::survey::surfel
