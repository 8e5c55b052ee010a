/// Fly-through capture: one curve through all views of a flight, with camera rotation between
/// views.
///
/// The curve rounds the corners of the path (corner_blend.h). Corners at views are moved outwards
/// by the amount that the curve would cut, so that the curve passes through the view positions. Its
/// speed is limited by image sharpness. Where the interval between two images is too short for the
/// camera rotation, the vehicle stops and waits at the first.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/motion/curve.h"
#include "flight/motion/motion.h"

namespace skycap::flight {

/// Requirements of images captured without stops.
struct PassRules {
  double speed = 0.0;  ///< Maximum speed for sharp images, possibly infinite [m/s].
  /// Maximum cut of a corner at a view, which is also its outward displacement [m].
  double max_cut = 0.0;
  double exposure = 0.0;  ///< Exposure including readout, without camera rotation [s].
  double period = 0.0;    ///< Minimum interval between images [s].
};

/// Camera aim: heading clockwise from north, and pitch with 0 at the horizon [rad].
struct Aim {
  double yaw = 0.0, pitch = 0.0;
};

/// View on a path.
struct FlyThroughView {
  std::size_t point = 0;  ///< Index of the path point. Views must be sorted by it.
  Aim aim;
};

/// Image captured in flight.
struct PassedView {
  double moment = 0.0;  ///< Time from the start of the curve [s].
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Aim aim;
};

/// Rest-to-rest flight along a path.
struct FlyThrough {
  Curve curve;
  std::vector<PassedView> views;  ///< Views in the given order, with ascending times.
  std::size_t stops = 0;  ///< Number of intermediate stops, at sharp corners and for waiting.
  double length = 0.0;
  double duration = 0.0;   ///< Duration [s].
  double energy = 0.0;     ///< Electrical energy [J].
  double clearance = 0.0;  ///< Verified lower bound over the whole curve [m], see LegVerification.
  double steady = 0.0;     ///< Time before and after each image without camera rotation [s].

  /// Returns the camera aim at `time` [s]. The camera rotates at a constant rate between images. It
  /// keeps the first aim before the first image, and the last aim after the last one. Requires at
  /// least one view.
  Aim aim_at(double time) const;
};

/// Returns the fly-through flight along a polyline whose lines are verified at `clearance` [m].
/// Where a piece of the curve cannot be verified or `is_allowed` rejects it, the adjacent corners
/// are cut less and finally become stops. `is_allowed` must accept the lines of the polyline. The
/// curve observes the vehicle's limits. Clearance is searched up to `up_to` [m]. Deterministic.
///
/// Returns std::nullopt without views, with a view at either end, or if images are not sharp at any
/// flyable speed.
std::optional<FlyThrough> pass_through(const std::vector<Eigen::Vector3d>& points,
                                       std::span<const FlyThroughView> views,
                                       const FreeSpace& space, double clearance, double up_to,
                                       const Motion& motion, const PassRules& rules,
                                       const std::function<bool(const Curve&)>& is_allowed = {});

/// Returns the minimum time from one image to the next for the camera rotation [s].
double min_interval(const Aim& from, const Aim& to, const Motion& motion, const PassRules& rules);

}  // namespace skycap::flight
