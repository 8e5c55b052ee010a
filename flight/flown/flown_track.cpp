#include "flight/flown/flown_track.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Movement from which a vehicle counts as flying: vertical and horizontal [m].
constexpr double min_climb = 1.0, min_movement = 3.0;

bool has_moved(const Vector3d& position, const Vector3d& from) {
  const Vector3d displacement = position - from;
  return std::abs(displacement.z()) > min_climb || displacement.head<2>().norm() > min_movement;
}

/// Speed above which a vehicle moves [m/s].
constexpr double min_speed = 0.4;

/// Returns the number of states before the first movement of a flight. States of the movement
/// itself are kept, because a log may begin in the air.
template <class Iterator>
std::ptrdiff_t count_resting(Iterator begin, Iterator end) {
  const Vector3d first = begin->position;
  auto moved = std::find_if(
      begin, end, [&](const TrackState& state) { return has_moved(state.position, first); });
  if (moved == end) return 0;
  const auto moves = [](const TrackState& a, const TrackState& b) {
    const double duration = std::abs(b.time - a.time);
    return duration <= min_log_gap && (b.position - a.position).norm() > min_speed * duration;
  };
  // The last state at rest is kept, too.
  while (moved != begin && moves(*(moved - 1), *moved)) --moved;
  if (moved != begin) --moved;
  return moved - begin;
}

/// Removes the states on the ground.
void trim(std::vector<TrackState>& states) {
  const std::ptrdiff_t before = count_resting(states.begin(), states.end());
  const std::ptrdiff_t after = count_resting(states.rbegin(), states.rend());
  if (before + after >= static_cast<std::ptrdiff_t>(states.size())) return;
  states.erase(states.end() - after, states.end());
  states.erase(states.begin(), states.begin() + before);
}

bool has_takeoff_heights(const FlownLog& log) {
  const auto count = std::ranges::count_if(
      log.states, [](const LoggedState& state) { return std::isfinite(state.above_takeoff); });
  return 2 * static_cast<std::size_t>(count) >= log.states.size();
}

/// Places single states.
class Placement {
 public:
  Placement(const FlownLog& log, const Site& site, const Vector3d& pad, TrackHeights heights)
      : log_(log), site_(site), pad_(pad) {
    if (log.is_local) return;
    const bool has_takeoff = has_takeoff_heights(log);
    const bool has_absolute =
        log.datum == HeightDatum::ellipsoid || site.geoid_undulation.has_value();
    is_above_takeoff_ = heights == TrackHeights::takeoff ||
                        (heights == TrackHeights::automatic && (has_takeoff || !has_absolute));
    is_above_first_ = is_above_takeoff_ && !has_takeoff;
  }

  std::string heights() const {
    if (log_.is_local) return "mission frame";
    if (is_above_first_) return "above the first position, which counts as the take-off point";
    if (is_above_takeoff_) return "above take-off";
    return log_.datum == HeightDatum::ellipsoid ? "above the ellipsoid" : "above mean sea level";
  }

  std::vector<TrackState> place(const std::vector<LoggedState>& states) const {
    std::vector<TrackState> placed;
    RouteFile file;
    for (const LoggedState& state : states) {
      double height = state.location.z();
      if (is_above_first_) height -= log_.states.front().location.z();
      if (is_above_takeoff_ && !is_above_first_) height = state.above_takeoff;
      if (!std::isfinite(height)) continue;
      placed.push_back({state.time, state.location, state.yaw_deg, state.camera_yaw_deg,
                        state.camera_pitch_deg});
      if (log_.is_local) continue;
      FilePoint point;
      point.latitude_deg = state.location.x();
      point.longitude_deg = state.location.y();
      point.height = height;
      point.datum = is_above_takeoff_ ? HeightDatum::takeoff : log_.datum;
      file.points.push_back(point);
    }
    if (log_.is_local || placed.empty()) return placed;
    const std::vector<Vector3d> positions = local_points(file, site_, pad_);
    for (std::size_t i = 0; i < placed.size(); ++i) placed[i].position = positions[i];
    return placed;
  }

 private:
  const FlownLog& log_;
  const Site& site_;
  const Vector3d& pad_;
  bool is_above_takeoff_ = false, is_above_first_ = false;
};

}  // namespace

FlownTrack place_track(const FlownLog& log, const Site& site, bool is_georeferenced,
                       const Eigen::Vector3d& pad, TrackHeights heights) {
  if (!log.is_local && !is_georeferenced) {
    throw Error(ErrorKind::bad_config,
                "the log has geodetic coordinates, but the mission has no georeference; set "
                "site.latitude_deg and site.longitude_deg");
  }
  const Placement placement(log, site, pad, heights);
  FlownTrack track{log.kind,
                   placement.heights(),
                   placement.place(log.states),
                   placement.place(log.captures),
                   log.has_captures,
                   log.warnings};
  if (track.states.empty()) {
    throw Error(ErrorKind::bad_file, "contains no height above take-off; use --heights absolute");
  }
  trim(track.states);
  return track;
}

void append_track(FlownTrack& track, FlownTrack next) {
  if (track.states.empty()) {
    track = std::move(next);
    return;
  }
  // Longer than a gap in a log, so that the time between two flights belongs to no leg.
  const double shift = track.states.back().time + 2.0 * min_log_gap - next.states.front().time;
  for (std::vector<TrackState>* states : {&next.states, &next.captures}) {
    for (TrackState& state : *states) state.time += shift;
  }
  std::ranges::move(next.states, std::back_inserter(track.states));
  std::ranges::move(next.captures, std::back_inserter(track.captures));
  std::ranges::move(next.warnings, std::back_inserter(track.warnings));
  track.has_captures = track.has_captures && next.has_captures;
  if (next.kind != track.kind) track.kind += ", " + next.kind;
  if (next.heights != track.heights) track.heights += ", " + next.heights;
}

Eigen::Vector3d compute_velocity(const std::vector<TrackState>& states, double time) {
  constexpr double half = 0.5, tolerance = 1e-6;
  const auto begin =
      std::ranges::lower_bound(states, time - half - tolerance, {}, &TrackState::time);
  auto end = std::ranges::upper_bound(states, time + half + tolerance, {}, &TrackState::time);
  if (end - begin < 2) return Vector3d::Zero();
  --end;
  const double duration = end->time - begin->time;
  return duration > 0.0 ? Vector3d((end->position - begin->position) / duration) : Vector3d::Zero();
}

}  // namespace skycap::flight
