/// The direction that is farthest from all occluded ones: maximin on the unit sphere.
///
/// Source: SEE++ §III-B "Proactively Handling Occlusions". Q are the unit directions in which a
/// frontier is known to be occluded; the answer s* maximises the distance to the nearest q, that is
/// it minimises h(s) = max_q s.q. The cap around s* of the angle acos(h(s*)) is the empty one.
///
/// What is true of h, and used here: if conv(Q) does not hold the origin, all of Q lies in an open
/// hemisphere, and s* = -m/|m| with m the point of conv(Q) nearest to the origin; it is the only
/// minimum, and h = -|m|. Otherwise the minima of h are the normals of those facets of conv(Q)
/// that the ray along their normal passes through, and h is the facet's distance from the origin.
/// There are many; the policy says which.
///
/// Degenerate sets, for all but `nonlinear_program`:
/// - empty: known_clear, cosine -1;
/// - one direction (or copies): its antipode;
/// - an antipodal pair: the direction at right angles to it that is nearest to known_clear;
/// - on a great circle: the pole nearest to known_clear, cosine 0;
/// - fills a closed hemisphere: its pole, cosine 0;
/// - covers the sphere: some direction, cosine near 1; there is no clear direction.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace skycap::geometry {

enum class CapPolicy {
  local,              ///< downhill from the known clear direction in finite steps, as the paper's
                      ///< solver goes, and over to larger caps next to the one found; ends in an
                      ///< exact local minimum of h
  global,             ///< the largest empty cap there is
  nonlinear_program,  ///< the paper's two programs, solved by NLopt, for comparison
};

struct CapConfig {
  CapPolicy policy = CapPolicy::local;
  /// For `nonlinear_program`: evaluations of the objective in each of its two programs, at least 1.
  /// The authors' code limits the wall clock (10 ms) instead, which no two runs repeat.
  int max_evaluations = 100;

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

struct SphericalCap {
  Eigen::Vector3d direction;  ///< s*, of unit length
  double cosine;  ///< h(s*), of the angle to the nearest occluded direction; negative if all of
                  ///< these fit into an open hemisphere
};

/// The clearest direction. `occluded` and `known_clear` are of unit length (to 1e-6). Nothing is
/// returned only under `nonlinear_program`, when both of its programs fail. Deterministic. With
/// 30,000 directions `local` and `global` take about 0.5 ms; where these cover the sphere evenly,
/// so that there is no clear direction, `global` takes 3 ms, and 300 ms if hundreds of its gaps are
/// as large as the largest. Cosines are exact to 1e-6.
std::optional<SphericalCap> clearest_direction(std::span<const Eigen::Vector3d> occluded,
                                               const Eigen::Vector3d& known_clear,
                                               const CapConfig& config = {});

}  // namespace skycap::geometry
