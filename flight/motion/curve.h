/// Curves in time: chains of quintic Bezier pieces, and what their control points prove of them.
///
/// A piece lies in the convex hull of its control points, and its derivatives are Bezier curves
/// whose control points are differences of its own: so bounds on control points are bounds on the
/// whole piece, and halving it (de Casteljau) makes them as tight as needed. Nothing is sampled.
/// Source: Farin, Curves and Surfaces for CAGD, 5th ed., sections 4.3 (convex hull, subdivision)
/// and 5.3 (derivatives).
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// Position, velocity and acceleration at a moment.
struct CurveState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// One Bezier curve of degree 5, flown at an even pace of its parameter.
struct CurvePiece {
  std::array<Eigen::Vector3d, 6> control;
  double duration = 0.0;  ///< [s], positive
};

/// Pieces flown one after the other; each begins in the state that the one before it ends in.
using Curve = std::vector<CurvePiece>;

/// The piece that leads from one state to another: the one motion of degree 5 that does. A motion
/// of lower degree between the same states is that same motion.
CurvePiece piece_between(const CurveState& from, const CurveState& to, double duration);

/// The two halves of a piece, each flown in half of its time.
std::array<CurvePiece, 2> halves(const CurvePiece& piece);

/// How far from the straight line between its ends the hull of a piece reaches.
double hull_radius(const CurvePiece& piece);

double duration(const Curve& curve);
/// Length to about 1e-6 of it.
double length(const Curve& curve);
/// The state `time` after the start; at rest in the end's place from then on. The curve must not be
/// empty.
CurveState state_at(const Curve& curve, double time);

/// The same way, flown `factor` times as long.
Curve slowed(Curve curve, double factor);

/// Factor by which the curve must be slowed (may be sped up, if below one) to keep the vehicle's
/// limits of acceleration and jerk and, in every direction, of speed: see Motion::leg_speed(). An
/// upper bound, within some percent of the least one.
double needed_slowdown(const Curve& curve, const Motion& motion);

/// The hull of every part of the curve, the curve being halved as often as it takes, proven to keep
/// the clearance. LegProof::clearance is at most `up_to`, and a bound for the whole curve.
LegProof prove(const FreeSpace& space, const Curve& curve, double clearance,
               double up_to = std::numeric_limits<double>::infinity());

/// Electrical energy of flying the curve [J].
double energy(const Curve& curve, const Motion& motion);

}  // namespace skycap::flight
