#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <nlopt.hpp>

#include "geometry/spherical_cap/spherical_cap_methods.h"

// Solves the two programs of SEE++ §III-B in the unknowns (n, e) like the authors' released code:
// sequential quadratic programming with one constraint per direction and the tolerances below. As
// published, e is bounded by n.n, so that |n| = h and e = h^2 at the optimum.
namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

constexpr double constraint_tolerance = 1e-3;
constexpr double unknown_tolerance = 1e-3;  // absolute, for each unknown
constexpr double smallest_plane =
    1e-3;  // results with e up to this value mean that no cap was found

// Both programs have the constraints sign (e - n.n) <= 0 and sign (n.q - e) <= 0. The sign is +1 if
// the directions surround the origin and -1 if they lie in a hemisphere.
struct Program {
  std::span<const Vector3d> occluded;
  double sign;
};

double plane_distance(const std::vector<double>& unknowns, std::vector<double>& gradient, void*) {
  if (!gradient.empty()) gradient = {0.0, 0.0, 0.0, 1.0};
  return unknowns[3];
}

void constraints(unsigned, double* values, unsigned, const double* unknowns, double* gradient,
                 void* data) {
  const auto& [occluded, sign] = *static_cast<const Program*>(data);
  const Eigen::Map<const Vector3d> n(unknowns);
  const double e = unknowns[3];
  values[0] = sign * (e - n.squaredNorm());
  for (std::size_t i = 0; i < occluded.size(); ++i) values[i + 1] = sign * (n.dot(occluded[i]) - e);
  if (gradient == nullptr) return;
  Eigen::Map<Eigen::Vector4d>(gradient) << -2.0 * sign * n, sign;
  for (std::size_t i = 0; i < occluded.size(); ++i) {
    Eigen::Map<Eigen::Vector4d>(gradient + 4 * (i + 1)) << sign * occluded[i], -sign;
  }
}

// Returns the normal n of the plane found from `start_normal`, or nullopt.
std::optional<Vector3d> solve(Program program, const Vector3d& start_normal, double start_distance,
                              int max_evaluations) {
  constexpr double free = HUGE_VAL;
  nlopt::opt solver(nlopt::LD_SLSQP, 4);
  solver.set_lower_bounds({-free, -free, -free, 0.0});
  solver.set_upper_bounds({free, free, free, 1.0});
  solver.set_xtol_abs(unknown_tolerance);
  solver.set_maxeval(max_evaluations);
  if (program.sign > 0.0) {
    solver.set_min_objective(plane_distance, nullptr);
  } else {
    solver.set_max_objective(plane_distance, nullptr);
  }
  solver.add_inequality_mconstraint(
      constraints, &program,
      std::vector<double>(program.occluded.size() + 1, constraint_tolerance));

  std::vector<double> unknowns{start_normal.x(), start_normal.y(), start_normal.z(),
                               start_distance};
  double distance = 0.0;
  try {
    solver.optimize(unknowns, distance);
  } catch (const std::runtime_error&) {  // failures of the solver, including rounding
    return std::nullopt;
  }
  const Vector3d normal(unknowns[0], unknowns[1], unknowns[2]);
  if (!(distance > smallest_plane) || !(normal.norm() > 0.0)) return std::nullopt;
  return normal;
}

}  // namespace

std::optional<SphericalCap> cap_by_nonlinear_program(std::span<const Vector3d> occluded,
                                                     const Vector3d& known_clear,
                                                     int max_evaluations) {
  Vector3d direction;
  if (const auto n = solve({occluded, 1.0}, known_clear, 1.0, max_evaluations)) {
    direction = n->normalized();
  } else if (const auto m = solve({occluded, -1.0}, -known_clear, 0.0, max_evaluations)) {
    direction = -m->normalized();
  } else {
    return std::nullopt;
  }
  double cosine = -1.0;
  for (const Vector3d& q : occluded) cosine = std::max(cosine, q.dot(direction));
  return SphericalCap{direction, cosine};
}

}  // namespace skycap::geometry
