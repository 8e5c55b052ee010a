/// Finds the direction with the largest angular distance from all occluded directions (maximin on
/// the unit sphere).
///
/// Source: SEE++ §III-B "Proactively Handling Occlusions". Q is the set of unit directions in which
/// a frontier is known to be occluded. The result s* maximises the distance to the nearest q, which
/// means that it minimises h(s) = max_q s.q. The cap around s* with the half-angle acos(h(s*))
/// contains no member of Q.
///
/// Two properties of h are used. If conv(Q) does not contain the origin, all of Q lies in an open
/// hemisphere. Then s* = -m/|m| is the only minimum and h = -|m|, where m is the point of conv(Q)
/// nearest to the origin. Otherwise the minima of h are facet normals of conv(Q): those whose ray
/// from the origin intersects the facet. At such a normal, h equals the distance of the facet from
/// the origin. CapPolicy selects one of the minima.
///
/// Degenerate sets, for all policies except `nonlinear_program`:
/// - empty: known_clear, cosine -1;
/// - one direction (or copies): its antipode;
/// - an antipodal pair: the direction orthogonal to it that is nearest to known_clear;
/// - on a great circle: the pole nearest to known_clear, cosine 0;
/// - fills a closed hemisphere: its pole, cosine 0;
/// - covers the sphere: an arbitrary direction, cosine near 1; no clear direction exists.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace skycap::geometry {

enum class CapPolicy {
  local,   ///< Descends from `known_clear` in finite steps, as the paper's solver does, then moves
           ///< to adjacent larger caps. The result is an exact local minimum of h.
  global,  ///< Returns the largest empty cap.
  nonlinear_program,  ///< Solves the two nonlinear programs of the paper with NLopt, for
                      ///< comparison.
};

struct CapConfig {
  CapPolicy policy = CapPolicy::local;
  /// Maximum number of objective evaluations in each program of `nonlinear_program`, at least 1.
  /// The authors' code limits the wall-clock time to 10 ms instead, which makes results
  /// irreproducible.
  int max_evaluations = 100;

  /// Throws Error{bad_config} that names the first field outside its interval.
  void validate() const;
};

struct SphericalCap {
  Eigen::Vector3d direction;  ///< s*, unit vector
  double cosine;  ///< h(s*): cosine of the angle to the nearest occluded direction; negative if all
                  ///< occluded directions lie in an open hemisphere
};

/// Returns the clearest direction. `occluded` and `known_clear` must have unit length (to 1e-6).
/// Returns nullopt only with `nonlinear_program`, if both of its programs fail. The result is
/// deterministic. Cosines are exact to 1e-6.
///
/// With 30,000 directions, `local` and `global` take about 0.5 ms. If the directions cover the
/// sphere evenly, so that no clear direction exists, `global` takes 3 ms. It takes 300 ms if
/// hundreds of gaps are as large as the largest gap.
std::optional<SphericalCap> clearest_direction(std::span<const Eigen::Vector3d> occluded,
                                               const Eigen::Vector3d& known_clear,
                                               const CapConfig& config = {});

}  // namespace skycap::geometry
