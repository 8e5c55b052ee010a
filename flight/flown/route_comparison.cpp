#include "flight/flown/route_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

#include "flight/monte_carlo/flight_script.h"
#include "flight/route/route.h"
#include "geometry/angle.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Length of the pieces of a plan [m], and the maximum number of table entries of an alignment.
constexpr double piece_length = 2.0;
constexpr std::size_t max_entries = 40'000'000;
/// Distance and time between the aligned positions of a track [m], [s].
constexpr double sample_distance = 1.0, sample_interval = 2.0;
/// Cost of a skipped metre of the plan [m^2/m].
constexpr double skip_cost = 0.1;
/// Speed below which a vehicle rests [m/s].
constexpr double resting_speed = 0.4;
constexpr double min_flown_fraction = 0.5;

double distance_to_segment(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const Vector3d direction = b - a;
  const double length = direction.squaredNorm();
  const double t = length > 0.0 ? std::clamp((point - a).dot(direction) / length, 0.0, 1.0) : 0.0;
  return (point - (a + t * direction)).norm();
}

double distance_to_leg(const Vector3d& point, const PlannedLeg& leg) {
  if (leg.points.size() == 1) return (point - leg.points.front()).norm();
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < leg.points.size(); ++i) {
    nearest = std::min(nearest, distance_to_segment(point, leg.points[i - 1], leg.points[i]));
  }
  return nearest;
}

double compute_length(const PlannedLeg& leg) {
  double length = 0.0;
  for (std::size_t i = 1; i < leg.points.size(); ++i) {
    length += (leg.points[i] - leg.points[i - 1]).norm();
  }
  return length;
}

/// Straight part of a planned leg.
struct Piece {
  Vector3d from, to;
  std::size_t leg = 0;
  double length() const { return (to - from).norm(); }
};

std::vector<Piece> make_pieces(const std::vector<PlannedLeg>& legs, double max_length) {
  std::vector<Piece> pieces;
  for (std::size_t leg = 0; leg < legs.size(); ++leg) {
    const std::vector<Vector3d>& points = legs[leg].points;
    const std::size_t before = pieces.size();
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vector3d displacement = points[i] - points[i - 1];
      if (displacement.norm() == 0.0) continue;
      const auto count = static_cast<std::size_t>(std::ceil(displacement.norm() / max_length));
      for (std::size_t k = 0; k < count; ++k) {
        const double a = static_cast<double>(k) / static_cast<double>(count);
        const double b = static_cast<double>(k + 1) / static_cast<double>(count);
        pieces.push_back({points[i - 1] + a * displacement, points[i - 1] + b * displacement, leg});
      }
    }
    // Rotations without a movement are legs, too.
    if (pieces.size() == before) pieces.push_back({points.front(), points.front(), leg});
  }
  return pieces;
}

/// Position of the track at one time. `moved` is the distance from the previous sample; the track
/// between two samples is unknown after a gap.
struct Sample {
  double time = 0.0;
  Vector3d position;
  double moved = 0.0;
  bool follows_gap = false;
};

/// Returns positions at most `distance` and `sample_interval` apart, except in gaps.
std::vector<Sample> make_samples(const std::vector<TrackState>& states, double distance) {
  std::vector<Sample> samples{{states.front().time, states.front().position, 0.0, true}};
  const auto add = [&](double time, const Vector3d& position, bool follows_gap) {
    samples.push_back({time, position, (position - samples.back().position).norm(), follows_gap});
  };
  for (std::size_t i = 1; i < states.size(); ++i) {
    const TrackState& state = states[i];
    const Sample last = samples.back();
    const bool is_gap = state.time - states[i - 1].time > min_log_gap;
    const double moved = (state.position - last.position).norm();
    const bool is_last = i + 1 == states.size();
    if (is_gap) {
      if (states[i - 1].time > last.time) add(states[i - 1].time, states[i - 1].position, false);
      add(state.time, state.position, true);
      continue;
    }
    if (moved < distance && state.time - last.time < sample_interval && !is_last) continue;
    const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil(moved / distance - 1e-9)));
    for (std::size_t k = 1; k <= count; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(count);
      add(last.time + t * (state.time - last.time),
          last.position + t * (state.position - last.position), false);
    }
  }
  return samples;
}

/// Returns the piece of each sample: the monotone assignment with minimum cost.
std::vector<std::uint32_t> align(const std::vector<Sample>& samples,
                                 const std::vector<Piece>& pieces, double max_deviation) {
  const std::size_t rows = samples.size(), columns = pieces.size();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  std::vector<double> cost(columns), next(columns), skipped(columns);
  for (std::size_t j = 0; j < columns; ++j) skipped[j] = skip_cost * pieces[j].length();
  std::vector<std::uint32_t> from(rows * columns);
  for (std::size_t i = 0; i < rows; ++i) {
    double best = i == 0 ? 0.0 : infinite;  // cost of arriving at piece j from an earlier piece
    std::uint32_t best_from = 0;
    for (std::size_t j = 0; j < columns; ++j) {
      const double d = distance_to_segment(samples[i].position, pieces[j].from, pieces[j].to);
      double arrival = best;
      std::uint32_t source = best_from;
      if (i > 0 && cost[j] <= arrival) arrival = cost[j], source = static_cast<std::uint32_t>(j);
      next[j] = arrival + std::min(d * d, max_deviation * max_deviation);
      from[i * columns + j] = source;
      // The next piece is reached from this one without a cost, or from an earlier one past it.
      best += skipped[j];
      if (i > 0 && cost[j] <= best) best = cost[j], best_from = static_cast<std::uint32_t>(j);
    }
    std::swap(cost, next);
  }
  double rest = 0.0;
  std::size_t end = columns - 1;
  double min_cost = infinite;
  for (std::size_t j = columns; j-- > 0;) {
    if (cost[j] + rest < min_cost) min_cost = cost[j] + rest, end = j;
    rest += skipped[j];
  }
  std::vector<std::uint32_t> assigned(rows);
  for (std::size_t i = rows; i-- > 0;) {
    assigned[i] = static_cast<std::uint32_t>(end);
    end = from[i * columns + end];
  }
  return assigned;
}

/// Returns the end of the rest of the vehicle at `time`, which may begin or end up to
/// `max_rest_distance` seconds from it. Returns `time` if the vehicle does not rest then.
double find_rest_end(const std::vector<TrackState>& states, double time) {
  constexpr double max_rest_distance = 3.0;
  const auto rests = [&](const TrackState& state) {
    return compute_velocity(states, state.time).norm() <= resting_speed;
  };
  auto nearest = states.end();
  for (auto state =
           std::ranges::lower_bound(states, time - max_rest_distance, {}, &TrackState::time);
       state != states.end() && state->time <= time + max_rest_distance; ++state) {
    const bool is_nearer =
        nearest == states.end() || std::abs(state->time - time) < std::abs(nearest->time - time);
    if (is_nearer && rests(*state)) nearest = state;
  }
  if (nearest == states.end()) return time;
  double end = nearest->time;
  for (auto state = nearest; state != states.end() && state->time - end <= min_log_gap; ++state) {
    if (!rests(*state)) break;
    end = state->time;
  }
  return end;
}

Vector3d compute_direction_of(double yaw_deg, double pitch_deg) {
  return compute_direction(
      {geometry::radians_per_degree * yaw_deg, geometry::radians_per_degree * pitch_deg});
}

/// Completes the camera's direction: by the heading of the vehicle, then by the plan.
void complete_direction(TrackState& state, const PlannedCapture& planned) {
  if (std::isnan(state.camera_yaw_deg)) state.camera_yaw_deg = state.yaw_deg;
  if (std::isnan(state.camera_yaw_deg)) state.camera_yaw_deg = planned.yaw_deg;
  if (std::isnan(state.camera_pitch_deg)) state.camera_pitch_deg = planned.pitch_deg;
}

/// Returns the angle between the planned direction and the logged one [rad]; empty if nothing of
/// it is logged.
std::optional<double> compute_turned(const TrackState& logged, const PlannedCapture& planned) {
  if (std::isnan(planned.yaw_deg) || std::isnan(planned.pitch_deg)) return std::nullopt;
  if (std::isnan(logged.camera_yaw_deg) && std::isnan(logged.yaw_deg) &&
      std::isnan(logged.camera_pitch_deg)) {
    return std::nullopt;
  }
  TrackState state = logged;
  complete_direction(state, planned);
  const Vector3d a = compute_direction_of(state.camera_yaw_deg, state.camera_pitch_deg);
  const Vector3d b = compute_direction_of(planned.yaw_deg, planned.pitch_deg);
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

CaptureComparison make_capture(const PlannedCapture& planned, const TrackState& logged) {
  CaptureComparison capture{true, logged, (logged.position - planned.position).norm(),
                            compute_turned(logged, planned)};
  complete_direction(capture.state, planned);
  return capture;
}

/// Aligns the captures of the log with the plan. Returns the logged capture of each planned one.
std::vector<std::optional<std::size_t>> align_captures(const std::vector<PlannedCapture>& planned,
                                                       const std::vector<TrackState>& logged,
                                                       double max_deviation) {
  const std::size_t rows = planned.size() + 1, columns = logged.size() + 1;
  const double gap = max_deviation * max_deviation;
  constexpr std::uint8_t pair = 0, missed = 1, other = 2;
  std::vector<std::uint8_t> step(rows * columns, missed);
  std::vector<double> cost(columns), next(columns);
  for (std::size_t j = 1; j < columns; ++j) {
    cost[j] = cost[j - 1] + gap;
    step[j] = other;
  }
  for (std::size_t i = 1; i < rows; ++i) {
    next[0] = cost[0] + gap;
    for (std::size_t j = 1; j < columns; ++j) {
      next[j] = cost[j] + gap;
      std::uint8_t chosen = missed;
      if (next[j - 1] + gap < next[j]) next[j] = next[j - 1] + gap, chosen = other;
      const double d = (logged[j - 1].position - planned[i - 1].position).norm();
      if (d <= max_deviation) {
        // The direction distinguishes captures at one position.
        const double turned = compute_turned(logged[j - 1], planned[i - 1]).value_or(0.0);
        const double both = cost[j - 1] + d * d + 0.5 * gap * (1.0 - std::cos(turned));
        if (both <= next[j]) next[j] = both, chosen = pair;
      }
      step[i * columns + j] = chosen;
    }
    std::swap(cost, next);
  }
  std::vector<std::optional<std::size_t>> found(planned.size());
  for (std::size_t i = rows - 1, j = columns - 1; i > 0 || j > 0;) {
    const std::uint8_t chosen = step[i * columns + j];
    if (chosen == pair) found[i - 1] = j - 1;
    if (chosen != other) --i;
    if (chosen != missed) --j;
  }
  return found;
}

/// Sets the flown length and duration.
void measure_track(const FlownTrack& track, RouteComparison& result) {
  for (std::size_t i = 1; i < track.states.size(); ++i) {
    const double time = track.states[i].time - track.states[i - 1].time;
    result.length += (track.states[i].position - track.states[i - 1].position).norm();
    if (time <= min_log_gap) result.duration += time;
  }
}

/// Adds a capture without a plan.
void add_other_capture(TrackState state, RouteComparison& result) {
  ++result.num_other_captures;
  complete_direction(state, {});
  if (std::isfinite(state.camera_yaw_deg) && std::isfinite(state.camera_pitch_deg)) {
    result.other_captures.push_back(state);
  }
}

/// Comparison of one track with one plan.
class Comparison {
 public:
  Comparison(const PlannedFlight& plan, const FlownTrack& track, const ComparisonOptions& options)
      : plan_(plan), track_(track), max_deviation_(options.max_deviation) {
    double length = 0.0;
    for (const PlannedLeg& leg : plan.legs) length += compute_length(leg);
    double scale = 1.0;
    do {
      pieces_ = make_pieces(plan.legs, scale * piece_length);
      samples_ = make_samples(track.states, scale * sample_distance);
      scale *= 2.0;
    } while (pieces_.size() * samples_.size() > max_entries && scale < length);
    if (!pieces_.empty()) assigned_ = align(samples_, pieces_, max_deviation_);
  }

  RouteComparison compare() {
    RouteComparison result;
    result.legs.resize(plan_.legs.size());
    result.captures.resize(plan_.captures.size());
    measure_track(track_, result);
    measure_legs(result.legs);
    measure_times(result.legs);
    if (track_.has_captures) {
      match_captures(result);
    } else {
      assume_captures(result);
    }
    measure_offset(result);
    return result;
  }

 private:
  double distance_to_piece(std::size_t sample, std::size_t piece) const {
    return distance_to_segment(samples_[sample].position, pieces_[piece].from, pieces_[piece].to);
  }

  /// Marks the pieces with a flown position, and those between two positions of a piece each.
  std::vector<bool> flown_pieces() const {
    std::vector<bool> is_flown(pieces_.size(), false);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const std::size_t piece = assigned_[i];
      if (distance_to_piece(i, piece) > max_deviation_) continue;
      is_flown[piece] = true;
      if (i == 0 || samples_[i].follows_gap) continue;
      const std::size_t before = assigned_[i - 1];
      double passed = 0.0;
      for (std::size_t j = before + 1; j < piece; ++j) passed += pieces_[j].length();
      if (passed > 2.0 * samples_[i].moved) continue;
      for (std::size_t j = before + 1; j < piece; ++j) {
        is_flown[j] = is_flown[j] || std::min(distance_to_piece(i, j),
                                              distance_to_piece(i - 1, j)) <= max_deviation_;
      }
    }
    return is_flown;
  }

  void measure_legs(std::vector<LegComparison>& legs) const {
    const std::vector<bool> is_flown = flown_pieces();
    // Rotations in place count by their pieces, which have no length.
    constexpr double min_length = 1e-9;
    std::vector<double> total(legs.size()), flown(legs.size());
    for (std::size_t j = 0; j < pieces_.size(); ++j) {
      const double length = std::max(min_length, pieces_[j].length());
      total[pieces_[j].leg] += length;
      if (is_flown[j]) flown[pieces_[j].leg] += length;
    }
    for (std::size_t k = 0; k < legs.size(); ++k) {
      legs[k].flown_fraction = std::min(1.0, flown[k] / total[k]);
      // A log may begin in the air, above the take-off point.
      const bool is_first = k == 0 && legs.size() > 1;
      legs[k].is_flown = is_first || legs[k].flown_fraction >= min_flown_fraction;
    }
    // A flight that leaves a leg early may pass half of it. A flown leg is followed from stop to
    // stop; a log may begin and end in the air.
    for (std::size_t j = 0; j < pieces_.size(); ++j) {
      const bool is_end = j + 1 < pieces_.size() && pieces_[j + 1].leg != pieces_[j].leg;
      const bool is_begin = j > 0 && pieces_[j - 1].leg != pieces_[j].leg;
      if ((is_end || is_begin) && !is_flown[j]) legs[pieces_[j].leg].is_flown = false;
    }
    for (std::size_t k = 0; k < legs.size(); ++k) {
      if (!legs[k].is_flown) continue;
      const auto [first, last] = find_samples(legs, k);
      double weight = 0.0;
      for (std::size_t i = first; i <= last; ++i) {
        const double error = distance_to_leg(samples_[i].position, plan_.legs[k]);
        const double moved = std::max(1e-3, samples_[i].follows_gap ? 0.0 : samples_[i].moved);
        legs[k].max_error = std::max(legs[k].max_error, error);
        legs[k].mean_error += moved * error;
        weight += moved;
      }
      legs[k].mean_error /= weight;
    }
  }

  /// Returns the first and last sample of a flown leg. Next to a leg that was not flown, this is
  /// the sample nearest to the end of the leg, because the vehicle comes from elsewhere or leaves
  /// for elsewhere.
  std::pair<std::size_t, std::size_t> find_samples(const std::vector<LegComparison>& legs,
                                                   std::size_t leg) const {
    const auto leg_of = [&](std::uint32_t piece) { return pieces_[piece].leg; };
    const auto begin = std::ranges::lower_bound(assigned_, leg, {}, leg_of);
    const auto end = std::ranges::upper_bound(assigned_, leg, {}, leg_of);
    auto first = static_cast<std::size_t>(begin - assigned_.begin());
    auto last = static_cast<std::size_t>(end - assigned_.begin()) - 1;
    const std::vector<Vector3d>& points = plan_.legs[leg].points;
    if (leg > 0 && !legs[leg - 1].is_flown) first = find_nearest(first, last, points.front());
    if (leg + 1 < legs.size() && !legs[leg + 1].is_flown) {
      last = find_nearest(first, last, points.back());
    }
    return {first, last};
  }

  std::size_t find_nearest(std::size_t first, std::size_t last, const Vector3d& position) const {
    std::size_t nearest = first;
    for (std::size_t i = first; i <= last; ++i) {
      const bool is_nearer =
          (samples_[i].position - position).norm() < (samples_[nearest].position - position).norm();
      if (is_nearer) nearest = i;
    }
    return nearest;
  }

  /// Sets the times of the flown legs. A leg ends with the stop at its end.
  void measure_times(std::vector<LegComparison>& legs) const {
    std::optional<double> end_before;
    for (std::size_t k = 0; k < legs.size(); ++k) {
      if (!legs[k].is_flown) {
        end_before.reset();
        continue;
      }
      const auto [first, last] = find_samples(legs, k);
      double begin = samples_[first].time, end = samples_[last].time;
      // The time between two flights belongs to no leg.
      if (end_before && !samples_[first].follows_gap) begin = *end_before;
      if (last + 1 < samples_.size()) end = std::max(begin, find_rest_end(track_.states, end));
      legs[k].begin = begin;
      legs[k].duration = end - begin;
      end_before = end;
    }
  }

  void match_captures(RouteComparison& result) const {
    const auto found = align_captures(plan_.captures, track_.captures, max_deviation_);
    std::vector<bool> is_planned(track_.captures.size(), false);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!found[i]) continue;
      is_planned[*found[i]] = true;
      result.captures[i] = make_capture(plan_.captures[i], track_.captures[*found[i]]);
    }
    for (std::size_t j = 0; j < track_.captures.size(); ++j) {
      if (!is_planned[j]) add_other_capture(track_.captures[j], result);
    }
  }

  /// Assumes a capture at each planned position that the track passes in order.
  void assume_captures(RouteComparison& result) const {
    result.are_captures_assumed = true;
    std::size_t first = 0;
    for (std::size_t i = 0; i < plan_.captures.size(); ++i) {
      const PlannedCapture& planned = plan_.captures[i];
      std::optional<std::size_t> nearest;
      double min_distance = max_deviation_;
      for (std::size_t k = first; k < samples_.size(); ++k) {
        const double d = (samples_[k].position - planned.position).norm();
        if (d < min_distance) min_distance = d, nearest = k;
        // The vehicle has left the position for good once it comes near the next one.
        if (nearest && d > 2.0 * max_deviation_) break;
      }
      if (!nearest) continue;
      first = *nearest;
      const auto state = std::ranges::lower_bound(track_.states, samples_[first].time - 1e-6, {},
                                                  &TrackState::time);
      result.captures[i] =
          make_capture(planned, state == track_.states.end() ? track_.states.back() : *state);
    }
  }

  void measure_offset(RouteComparison& result) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < result.captures.size(); ++i) {
      if (!result.captures[i].is_made) continue;
      result.mean_offset += result.captures[i].state.position - plan_.captures[i].position;
      ++count;
    }
    if (count > 0) result.mean_offset /= static_cast<double>(count);
  }

  const PlannedFlight& plan_;
  const FlownTrack& track_;
  double max_deviation_;
  std::vector<Piece> pieces_;
  std::vector<Sample> samples_;
  std::vector<std::uint32_t> assigned_;
};

}  // namespace

PlannedFlight make_planned_flight(const InterpretedRoute& route, const Motion& motion) {
  PlannedFlight flight;
  const FlightScript script = make_flight_script(route, motion);
  std::size_t next_stop = 0, next_pass = 0;
  PlannedLeg leg;
  const auto add_passes = [&](std::size_t stops) {
    for (; next_pass < route.is_fly_through.size() &&
           route.is_fly_through[next_pass].stops_before <= stops;
         ++next_pass) {
      const FlownPass& pass = route.is_fly_through[next_pass];
      flight.captures.push_back({pass.position, pass.yaw_deg, pass.pitch_deg, pass.item});
    }
  };
  for (const ScriptedLeg& part : script) {
    if (leg.points.empty()) {
      leg.points.push_back(part.from);
      leg.from = part.items[0];
    }
    if (part.to != leg.points.back()) leg.points.push_back(part.to);
    leg.duration += part.duration();
    leg.to = part.items[1];
    bool is_end = route.stops.empty();
    while (next_stop < route.stops.size() && route.stops[next_stop].item == part.items[1] &&
           route.stops[next_stop].position.isApprox(part.to)) {
      add_passes(next_stop);
      const InterpretedStop& stop = route.stops[next_stop++];
      flight.captures.push_back({stop.position, stop.yaw_deg, stop.pitch_deg, stop.item});
      is_end = true;
    }
    if (is_end) flight.legs.push_back(std::exchange(leg, {}));
  }
  add_passes(route.stops.size());
  if (!leg.points.empty()) flight.legs.push_back(std::move(leg));
  return flight;
}

void append_flight(PlannedFlight& flight, PlannedFlight next) {
  std::ranges::move(next.legs, std::back_inserter(flight.legs));
  std::ranges::move(next.captures, std::back_inserter(flight.captures));
}

void ComparisonOptions::validate() const {
  if (std::isfinite(max_deviation) && max_deviation > 0.0) return;
  throw Error(ErrorKind::bad_config, "the maximum deviation must be positive");
}

RouteComparison measure_flight(const FlownTrack& track) {
  if (track.states.empty()) throw Error(ErrorKind::bad_file, "contains no position");
  RouteComparison result;
  measure_track(track, result);
  for (const TrackState& capture : track.captures) add_other_capture(capture, result);
  return result;
}

RouteComparison compare_route(const PlannedFlight& plan, const FlownTrack& track,
                              const ComparisonOptions& options) {
  options.validate();
  if (track.states.empty()) throw Error(ErrorKind::bad_file, "contains no position");
  if (plan.legs.empty()) throw Error(ErrorKind::bad_file, "the plan contains no leg");
  return Comparison(plan, track, options).compare();
}

}  // namespace skycap::flight
