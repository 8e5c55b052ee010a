#include "flight/fleet/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "flight/clearance/segment_distance.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Rounding bound of positions and distances [m], for coordinates below 10 km. Positions result
/// from a few multiplications.
constexpr double rounding = 1e-6;
/// Minimum span to subdivide [s]. A vehicle at 20 m/s moves 0.2 mm in it.
constexpr double shortest_span = 1e-5;
constexpr double precision = 1e-3;  ///< Precision of verified_distance() [m].

struct Span {
  double begin = 0.0, end = 0.0;

  double length() const { return end - begin; }
  double middle() const { return 0.5 * (begin + end); }
};

/// Motion along a leg, or the wait at its end.
struct TimedSegment {
  const ScriptedLeg* leg;
  Span span;         ///< In timetable time.
  double leg_begin;  ///< Start of the leg [s].
  double jerk;

  Vector3d at(double time) const {
    return set_point(*leg, jerk, std::clamp(time, span.begin, span.end) - leg_begin).position;
  }
  Segment between(const Span& part) const { return {at(part.begin), at(part.end)}; }
};

std::vector<TimedSegment> timed_segments(const TimedFlight& flight) {
  std::vector<TimedSegment> segments;
  double now = flight.start;
  for (const ScriptedLeg& leg : flight.script) {
    const double rest = now + leg.moving, end = now + leg.duration();
    if (leg.moving > 0.0) segments.push_back({&leg, {now, rest}, now, flight.jerk});
    segments.push_back({&leg, {rest, end}, now, flight.jerk});
    now = end;
  }
  return segments;
}

/// Search for the closest encounter of two flights.
class Search {
 public:
  /// The flights' own times differ by at most `lag` [s]. Encounters at `up_to` [m] or more are
  /// ignored. With `stops_at_first`, the first closer encounter ends the search.
  Search(double lag, double up_to, bool stops_at_first)
      : lag_(lag), stops_at_first_(stops_at_first) {
    nearest_.distance = up_to;
    bound_ = up_to;
  }

  void run(const TimedFlight& first, const TimedFlight& second) {
    const std::vector<TimedSegment> others = timed_segments(second);
    for (const TimedSegment& segment : timed_segments(first)) {
      for (const TimedSegment& other : others) {
        search(segment, segment.span, other, other.span);
        if (is_done()) return;
      }
    }
  }

  const Encounter& nearest() const { return nearest_; }
  bool has_found() const { return has_found_; }
  double bound() const { return bound_; }

 private:
  bool is_done() const { return stops_at_first_ && has_found_; }

  void search(const TimedSegment& one, Span span, const TimedSegment& other, Span window) {
    if (is_done()) return;
    // Restricts both spans to times that can coincide.
    window = {std::max(window.begin, span.begin - lag_), std::min(window.end, span.end + lag_)};
    if (window.end < window.begin) return;
    span = {std::max(span.begin, window.begin - lag_), std::min(span.end, window.end + lag_)};
    const double bound =
        std::sqrt(flight::nearest(one.between(span), other.between(window)).squared_distance);
    const double required = stops_at_first_ ? nearest_.distance : nearest_.distance - precision;
    if (bound - rounding >= required) {
      bound_ = std::min(bound_, bound - rounding);
      return;
    }
    meet(one, span.middle(), other, window);
    if (is_done()) return;
    if (std::max(span.length(), window.length()) <= shortest_span) {
      settle(one, span, other, window, bound);
    } else if (span.length() >= window.length()) {
      search(one, {span.begin, span.middle()}, other, window);
      search(one, {span.middle(), span.end}, other, window);
    } else {
      search(one, span, other, {window.begin, window.middle()});
      search(one, span, other, {window.middle(), window.end});
    }
  }

  /// Evaluates a possible encounter: one vehicle at a fixed time, the other within the lag of it.
  void meet(const TimedSegment& one, double time, const TimedSegment& other, const Span& window) {
    const Span together{std::max(window.begin, time - lag_), std::min(window.end, time + lag_)};
    if (together.end < together.begin) return;
    const Vector3d position = one.at(time);
    record_encounter(time, flight::nearest(other.between(together), position));
  }

  /// Counts a span that is too short for a decision as an encounter.
  void settle(const TimedSegment& one, const Span& span, const TimedSegment& other,
              const Span& window, double bound) {
    bound_ = std::min(bound_, bound - rounding);
    if (!stops_at_first_) return;
    const NearestPoints points = flight::nearest(other.between(window), one.between(span));
    nearest_ = {bound, span.middle(), points.on_other, points.on_segment};
    has_found_ = true;
  }

  void record_encounter(double time, const NearestPoints& points) {
    const double distance = std::sqrt(points.squared_distance);
    if (distance >= nearest_.distance) return;
    nearest_ = {distance, time, points.on_other, points.on_segment};
    has_found_ = true;
  }

  double lag_;
  bool stops_at_first_, has_found_ = false;
  Encounter nearest_;
  double bound_ = 0.0;
};

}  // namespace

std::optional<Encounter> too_near(const TimedFlight& first, const TimedFlight& second,
                                  const SeparationRule& rule) {
  Search search(2.0 * rule.tolerance, rule.distance, true);
  search.run(first, second);
  return search.has_found() ? std::optional(search.nearest()) : std::nullopt;
}

double verified_distance(const TimedFlight& first, const TimedFlight& second, double tolerance,
                         double up_to) {
  Search search(2.0 * tolerance, up_to, false);
  search.run(first, second);
  return std::max(0.0, search.bound());
}

double distance_from(const FlightScript& script, const Vector3d& position) {
  double min_distance = std::numeric_limits<double>::infinity();
  for (const ScriptedLeg& leg : script) {
    min_distance = std::min(min_distance, nearest({leg.from, leg.to}, position).squared_distance);
  }
  return std::sqrt(min_distance);
}

}  // namespace skycap::flight
