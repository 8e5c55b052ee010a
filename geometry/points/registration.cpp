#include "geometry/points/registration.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

namespace skycap::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Patch in its current position, with its partner.
struct Match {
  const SurfacePatch* patch;
  Vector3d point, normal;
  double error;      // n . (p - q)
  double deviation;  // deviation of the partner
  double variance;   // variance of both
};

std::vector<Match> find_matches(std::span<const SurfacePatch> patches, const Isometry3d& correction,
                                SurfaceMap& map, double reach) {
  std::vector<Match> matches;
  matches.reserve(patches.size());
  for (const SurfacePatch& patch : patches) {
    const SurfacePatch moved{correction * patch.mean, correction.linear() * patch.normal,
                             patch.deviation};
    const SurfacePatch* there = map.nearest(moved, reach);
    if (there == nullptr) continue;
    const Vector3d shift = moved.mean - there->mean;
    const double error = there->normal.dot(shift);
    // Planes are valid only up to the border of the measured surface.
    if ((shift - error * there->normal).norm() > map.radius()) continue;
    matches.push_back({&patch, moved.mean, there->normal, error, there->deviation,
                       patch.deviation * patch.deviation + there->deviation * there->deviation});
  }
  return matches;
}

template <typename Value>
double median(const std::vector<Match>& matches, Value value) {
  std::vector<double> values;
  values.reserve(matches.size());
  for (const Match& match : matches) values.push_back(value(match));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double median_error(const std::vector<Match>& matches) {
  return median(matches, [](const Match& match) { return std::abs(match.error); });
}

/// Centre and size of the matches: the units of a step.
struct Frame {
  Vector3d middle = Vector3d::Zero();
  double size = 0.0;
};

Frame make_frame(const std::vector<Match>& matches) {
  Frame frame;
  for (const Match& match : matches) frame.middle += match.point;
  const auto count = static_cast<double>(matches.size());
  frame.middle /= count;
  double squares = 0.0;
  for (const Match& match : matches) squares += (match.point - frame.middle).squaredNorm();
  frame.size = std::sqrt(squares / count);
  return frame;
}

/// Normal equations, divided by the sum of the weights.
struct Equations {
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
};

/// Noise scales of errors and flatness [m].
struct Scales {
  double error;     // minimum standard deviation of errors
  double flatness;  // minimum standard deviation of patches
};

Scales fine_scales(const SurfaceMap& map) { return {0.01 * map.radius(), 0.03 * map.radius()}; }

Equations make_equations(const std::vector<Match>& matches, const Frame& frame,
                         const Scales& scales) {
  constexpr double normal_deviation = 1.4826, tukey = 4.685;
  const double scale = tukey * std::max(normal_deviation * median_error(matches), scales.error);
  Equations equations;
  double sum = 0.0;
  for (const Match& match : matches) {
    const double share = match.error / scale;
    if (std::abs(share) >= 1.0) continue;
    // A patch across an edge is not planar, although it may be flat enough to pass the test.
    const double flatness = 1.0 / (match.variance + scales.flatness * scales.flatness);
    const double weight = flatness * (1.0 - share * share) * (1.0 - share * share);
    Vector6d row;
    row << match.normal, (match.point - frame.middle).cross(match.normal) / frame.size;
    equations.information += weight * row * row.transpose();
    equations.pull -= weight * match.error * row;
    sum += weight;
  }
  equations.information /= sum;
  equations.pull /= sum;
  return equations;
}

using Eigenvectors = Eigen::SelfAdjointEigenSolver<Matrix6d>;

RigidDirection compute_direction(const Eigenvectors& axes, int k, const Frame& frame) {
  const Vector6d axis = axes.eigenvectors().col(k);
  return {.displacement = axis.head<3>(),
          .turn = axis.tail<3>() / frame.size,
          .information = axes.eigenvalues()[k]};
}

/// Returns a displacement of `frame.middle` with a rotation about it.
Isometry3d motion(const Vector6d& step, const Frame& frame) {
  const Vector3d turn = step.tail<3>() / frame.size;
  const double angle = turn.norm();
  Isometry3d motion = Isometry3d::Identity();
  if (angle > 0.0) motion.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  motion.translation() = frame.middle + step.head<3>() - motion.linear() * frame.middle;
  return motion;
}

/// Returns the Gauss-Newton step along the observable directions.
Vector6d compute_step(const Equations& equations) {
  const Eigenvectors axes(equations.information);
  Vector6d step = Vector6d::Zero();
  for (int k = 0; k < 6; ++k) {
    if (!RigidDirection{.information = axes.eigenvalues()[k]}.is_observable()) continue;
    const Vector6d axis = axes.eigenvectors().col(k);
    step += axis * (axis.dot(equations.pull) / axes.eigenvalues()[k]);
  }
  return step;
}

/// Computes the component of the correction along each direction.
void measure(Registration& found, const Equations& equations, const Frame& frame) {
  const Eigenvectors axes(equations.information);
  const Eigen::AngleAxisd turn(found.correction.linear());
  Vector6d moved;
  moved << found.correction * found.middle - found.middle, frame.size * turn.angle() * turn.axis();
  for (int k = 0; k < 6; ++k) {
    RigidDirection& direction = found.directions[static_cast<std::size_t>(k)];
    direction = compute_direction(axes, k, frame);
    direction.amount = axes.eigenvectors().col(k).dot(moved);
  }
}

/// Correction and the resulting matches.
struct Alignment {
  Isometry3d correction = Isometry3d::Identity();
  std::vector<Match> matches;
};

/// Aligns a scan with the map, starting from the matches `given` at its initial pose. Reduces first
/// the search radius of partners, then the error scale. At the search radius d, the noise scale is
/// `relative_noise` * d.
Alignment aligned(std::span<const SurfacePatch> patches, SurfaceMap& map,
                  const std::vector<Match>& given, double reach, std::size_t min_matches,
                  double relative_noise) {
  constexpr int max_rounds = 12;  // per stage
  const double radius = map.radius(), last = std::min(reach, 2.0 * radius), flat = 0.03 * radius;
  Alignment found{.matches = given};
  const auto settle = [&](const Scales& scales) {
    for (int round = 0; round < max_rounds && found.matches.size() >= min_matches; ++round) {
      const Frame frame = make_frame(found.matches);
      const Vector6d step = compute_step(make_equations(found.matches, frame, scales));
      found.correction = motion(step, frame) * found.correction;
      found.matches = find_matches(patches, found.correction, map, reach);
      if (step.norm() < 1e-4 * radius) break;
    }
  };
  for (; reach > last; reach = std::max(last, 0.5 * reach)) settle({relative_noise * reach, flat});
  settle({relative_noise * reach, flat});
  settle(fine_scales(map));
  return found;
}

/// Returns the misfit of matches in [0, 1]. Patches without a partner, or with an error of at least
/// a quarter of the radius, count as 1.
double compute_misfit(const std::vector<Match>& matches, std::size_t patches, double radius) {
  double sum = static_cast<double>(patches - matches.size());
  for (const Match& match : matches) {
    const double share = std::min(1.0, std::abs(match.error) / (0.25 * radius));
    sum += share * share;
  }
  return sum / static_cast<double>(patches);
}

}  // namespace

Registration register_scan(std::span<const SurfacePatch> patches, SurfaceMap& map, double reach,
                           std::size_t min_matches) {
  min_matches = std::max<std::size_t>(min_matches, 1);
  const std::vector<Match> given = find_matches(patches, Isometry3d::Identity(), map, reach);
  if (given.size() < min_matches) return {.matches = given.size()};
  Registration found{.first_error = median_error(given)};
  // With a narrow noise scale, surface that already fits keeps the rest in place, even a distant
  // wall that should move. With a wide scale, all surface contributes, including surface that was
  // not measured before. The better alignment is used.
  constexpr double narrow = 1.0 / 16.0, wide = 1.0 / 4.0, clearly = 0.8;
  Alignment best = aligned(patches, map, given, reach, min_matches, narrow);
  Alignment other = aligned(patches, map, given, reach, min_matches, wide);
  if (compute_misfit(other.matches, patches.size(), map.radius()) <
      clearly * compute_misfit(best.matches, patches.size(), map.radius())) {
    best = std::move(other);
  }
  found.matches = best.matches.size();
  if (found.matches < min_matches) return found;
  found.correction = best.correction;
  std::vector<SurfacePatch> matched;
  for (const Match& match : given) matched.push_back(*match.patch);
  found.first_misfit = compute_misfit(given, given.size(), map.radius());
  found.misfit = compute_misfit(find_matches(matched, found.correction, map, reach), given.size(),
                                map.radius());
  const Frame frame = make_frame(best.matches);
  found.size = frame.size;
  found.middle = found.correction.inverse() * frame.middle;
  found.error = median_error(best.matches);
  found.deviation = median(best.matches, [](const Match& match) { return match.deviation; });
  measure(found, make_equations(best.matches, frame, fine_scales(map)), frame);
  return found;
}

}  // namespace skycap::geometry
