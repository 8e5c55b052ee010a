#include "flight/monte_carlo/simulated_flight.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "flight/clearance/segment_distance.h"
#include "flight/monte_carlo/return_flight.h"
#include "flight/monte_carlo/weather.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double step = simulation_step;

/// Closest approaches for one judge, above the pad and elsewhere.
struct CriterionPass {
  NearestPass elsewhere, over_pad;
  NearestApproach nearest;
};

class Simulation {
 public:
  Simulation(const SimulatedMission& mission, const FlightDraw& draw,
             std::span<const ClearanceCriterion> criteria, double up_to)
      : mission_(mission),
        draw_(draw),
        random_(draw.seed, draw.number),
        weather_(draw.wind, random_),
        receiver_(draw.position_error, random_),
        vehicle_(mission.motion, mission.script.front().from),
        ground_(mission.script.front().from.z()) {
    for (const ClearanceCriterion& criterion : criteria) {
      judged_passes_.push_back({{criterion.space, up_to}, {criterion.pad_space, up_to}, {}});
      judged_passes_.back().nearest.closest.distance = up_to;
    }
  }

  std::vector<Vector3d> track() {
    track_ = {vehicle_.position()};
    fly();
    return std::move(*track_);
  }

  SimulatedFlight fly() {
    for (const ScriptedLeg& leg : mission_.script) {
      if (!fly_leg(leg)) continue;
      fly_return();
      break;
    }
    result_.time = time_;
    result_.energy = vehicle_.energy();
    for (const CriterionPass& pass : judged_passes_) result_.nearest.push_back(pass.nearest);
    return std::move(result_);
  }

 private:
  double jerk() const { return mission_.motion.vehicle().mode.jerk; }

  /// Flies a leg. Returns true if the vehicle was recalled and has come to rest.
  bool fly_leg(const ScriptedLeg& leg) {
    // Pieces follow each other between the steps of the simulation.
    if (!leg.is_piece || !is_on_piece_) begin_ = time_;
    is_on_piece_ = leg.is_piece && leg.end_speed > 0.0;
    const double begin = begin_, end = begin + leg.duration();
    begin_ = end;
    const double return_time = is_returning_ ? end : std::min(end, draw_.return_time.value_or(end));
    while (time_ < return_time) advance(leg, set_point(leg, jerk(), time_ - begin));
    if (is_returning_ || return_time >= end) return false;
    // A vehicle that has landed no longer returns.
    if (leg.is_over_pad && &leg == &mission_.script.back() && time_ - begin >= leg.moving) {
      while (time_ < end) advance(leg, set_point(leg, jerk(), time_ - begin));
      return false;
    }
    const Vehicle& vehicle = mission_.motion.vehicle();
    const double called = time_, rest = called + recall_time(leg, vehicle, called - begin);
    while (time_ < rest) {
      advance(leg, recall_point(leg, vehicle, called - begin, time_ - called));
    }
    position_ = recall_point(leg, vehicle, called - begin, rest - called).position;
    return true;
  }

  void fly_return() {
    is_returning_ = true;
    for (const ScriptedLeg& leg :
         return_script(*mission_.rtl_profile, mission_.motion, position_, random_)) {
      fly_leg(leg);
    }
  }

  void advance(const ScriptedLeg& leg, const SetPoint& target) {
    const Vector3d before = vehicle_.position();
    air_ = weather_.next(step, before.z() - ground_, (vehicle_.velocity() - air_).norm());
    vehicle_.fly(target, receiver_.next(step), air_, step);
    time_ += step;
    if (track_) track_->push_back(vehicle_.position());
    const Segment line{leg.from, leg.to};
    if (line.length() > 0.0) {
      // The vehicle comes to rest on a leg. It follows a piece from behind.
      const Vector3d direction = (leg.to - leg.from) / line.length();
      const double off_line = leg.is_piece
                                  ? direction.cross(vehicle_.position() - leg.from).norm()
                                  : std::sqrt(nearest(line, vehicle_.position()).squared_distance);
      result_.off_line = std::max(result_.off_line, off_line);
    }
    for (CriterionPass& pass : judged_passes_) {
      NearestPass& part = leg.is_over_pad ? pass.over_pad : pass.elsewhere;
      part.pass({before, vehicle_.position()});
      if (part.nearest().distance >= pass.nearest.closest.distance) continue;
      pass.nearest = {part.nearest(), time_, is_returning_};
    }
  }

  const SimulatedMission& mission_;
  const FlightDraw& draw_;
  geometry::RandomNumbers random_;
  Weather weather_;
  ReceiverError receiver_;
  VehicleModel vehicle_;
  double ground_;
  std::deque<CriterionPass> judged_passes_;
  SimulatedFlight result_;
  std::optional<std::vector<Vector3d>> track_;  ///< Set if the track is requested.
  double time_ = 0.0;
  double begin_ = 0.0;        ///< Of the leg [s].
  bool is_on_piece_ = false;  ///< The next piece continues without rest.
  Vector3d air_ = Vector3d::Zero();
  Vector3d position_ = Vector3d::Zero();  ///< Position at rest after a recall.
  bool is_returning_ = false;
};

}  // namespace

std::vector<Vector3d> compute_track(const SimulatedMission& mission, const FlightDraw& draw) {
  return Simulation(mission, draw, {}, 0.0).track();
}

SimulatedFlight fly(const SimulatedMission& mission, const FlightDraw& draw,
                    std::span<const ClearanceCriterion> criteria, double up_to) {
  return Simulation(mission, draw, criteria, up_to).fly();
}

}  // namespace skycap::flight
