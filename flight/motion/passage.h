/// Taking pictures without a stop: one curve through all views of a flight, the camera turned
/// meanwhile from each to the next.
///
/// The curve goes round the way's corners (corner_blend.h). At views corners are moved outwards by
/// what the curve cuts of them, so that it leads through the places of views. It is no faster than
/// pictures stay sharp. Where the time between two pictures does not do for turning the camera, the
/// vehicle stops at the first and waits.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/curve.h"
#include "flight/motion/motion.h"
#include "flight/space/clearance.h"

namespace skycap::flight {

/// What pictures ask of a flight that does not stop for them.
struct PassRules {
  double speed = 0.0;     ///< at which they are sharp; may be infinite [m/s]
  double most_cut = 0.0;  ///< what a corner may be cut by, and moved outwards, at a view [m]
  double exposure = 0.0;  ///< during which the camera does not turn, readout included [s]
  double period = 0.0;    ///< between two of them, at the least [s]
};

/// Where a camera looks: heading from north, clockwise, and pitch, 0 at the horizon [rad].
struct Aim {
  double yaw = 0.0, pitch = 0.0;
};

/// A view on a way.
struct ViewOnWay {
  std::size_t point = 0;  ///< of the way; views ascend by it
  Aim aim;
};

/// A picture taken in passing.
struct PassedView {
  double moment = 0.0;  ///< from the start of the curve [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Aim aim;
};

/// A flight from rest to rest along a way.
struct Passage {
  Curve curve;
  std::vector<PassedView> views;  ///< as they were given; moments ascend
  std::size_t stops = 0;          ///< in between: turns too sharp to go round, and waits
  double length = 0.0;
  double duration = 0.0;   ///< [s]
  double energy = 0.0;     ///< [J]
  double clearance = 0.0;  ///< proven lower bound over the whole curve, see LegProof
  double steady = 0.0;     ///< before and after each picture, when the camera does not turn [s]

  /// Where the camera looks: it turns evenly between pictures, and looks as at the first and last
  /// ones before and after them. There must be a view.
  Aim aim_at(double time) const;
};

/// The passage along a polyline whose straight pieces are proven at `clearance`; nothing if it has
/// no view, or one at an end, or if pictures are not sharp at any speed that is flown. It keeps the
/// vehicle's limits. Where a piece of the curve is not proven, or `is_allowed` says no of it (of
/// straight pieces of the polyline it must say yes), the corners at its ends are cut less, and at
/// last stopped in. Clearance is looked at up to `up_to`. Deterministic.
std::optional<Passage> pass_through(const std::vector<Eigen::Vector3d>& points,
                                    std::span<const ViewOnWay> views, const FreeSpace& space,
                                    double clearance, double up_to, const Motion& motion,
                                    const PassRules& rules,
                                    const std::function<bool(const Curve&)>& is_allowed = {});

/// The time that the camera needs from one picture to the next [s].
double least_interval(const Aim& from, const Aim& to, const Motion& motion, const PassRules& rules);

}  // namespace skycap::flight
