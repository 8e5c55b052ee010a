/// Time-parametrised curves: chains of quintic Bezier pieces, with bounds from their control
/// points.
///
/// A piece lies in the convex hull of its control points. Its derivatives are Bezier curves, too,
/// with differences as control points. Bounds on control points are therefore bounds on the whole
/// piece, and subdivision (de Casteljau) makes them tighter. No sampling is involved. Source:
/// Farin, Curves and Surfaces for CAGD, 5th ed., sections 4.3 (convex hull, subdivision) and 5.3
/// (derivatives).
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/motion/motion.h"

namespace skycap::flight {

/// Position [m], velocity [m/s] and acceleration [m/s^2] at one time.
struct CurveState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// Bezier curve of degree 5 with a parameter proportional to time.
struct CurveSegment {
  std::array<Eigen::Vector3d, 6> control;
  double duration = 0.0;  ///< Duration [s], positive.
};

/// Consecutive pieces. Each piece starts in the end state of the previous one.
using Curve = std::vector<CurveSegment>;

/// Returns the piece between two states. The polynomial of degree 5 is unique, so it reproduces any
/// motion of lower degree between them.
CurveSegment segment_between(const CurveState& from, const CurveState& to, double duration);

/// Splits a piece into two pieces of half its duration.
std::array<CurveSegment, 2> halves(const CurveSegment& segment);

/// Returns the maximum distance of the control points from the line segment between the ends [m].
double hull_radius(const CurveSegment& segment);

double duration(const Curve& curve);
/// Returns the length of a curve [m], with a relative error of about 1e-6.
double length(const Curve& curve);
/// Returns the state at `time` [s] after the start. After the end, the state is at rest in the end
/// position. The curve must not be empty.
CurveState state_at(const Curve& curve, double time);

/// Returns the curve with its duration multiplied by `factor`.
Curve slowed(Curve curve, double factor);

/// Returns the time factor that keeps the curve within the vehicle's limits of speed (per
/// direction, see Motion::leg_speed()), acceleration and jerk. A factor below 1 permits a faster
/// flight. The result is an upper bound, a few percent above the minimum.
double needed_slowdown(const Curve& curve, const Motion& motion);

/// Proves that the convex hulls of the curve keep the clearance [m], subdividing as needed.
/// LegVerification::clearance is at most `up_to` [m] and is a lower bound for the whole curve.
LegVerification verify(const FreeSpace& space, const Curve& curve, double clearance,
                       double up_to = std::numeric_limits<double>::infinity());

/// Returns the electrical energy of flying the curve [J].
double energy(const Curve& curve, const Motion& motion);

}  // namespace skycap::flight
