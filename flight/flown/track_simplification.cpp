#include "flight/flown/track_simplification.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "flight/clearance/segment_distance.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

double distance_from(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  return std::sqrt(nearest(Segment{from, to}, point).squared_distance);
}

/// Returns how far an angle is from an even rotation between two others [deg]. 0 if one is unknown.
double turn_from(double angle, double from, double to, double fraction) {
  if (!std::isfinite(angle) || !std::isfinite(from) || !std::isfinite(to)) return 0.0;
  const double even = from + fraction * std::remainder(to - from, 360.0);
  return std::abs(std::remainder(angle - even, 360.0));
}

/// Divides a track at the samples that must remain.
class Division {
 public:
  Division(const std::vector<TrackSample>& samples, double tolerance, double max_turn)
      : samples_(samples), tolerance_(tolerance), max_turn_(max_turn), is_kept_(samples.size()) {}

  std::vector<std::size_t> divide() {
    std::size_t begin = 0;
    is_kept_.front() = is_kept_.back() = true;
    for (std::size_t i = 1; i < samples_.size(); ++i) {
      if (!samples_[i].is_kept && i + 1 < samples_.size()) continue;
      is_kept_[i] = true;
      divide(begin, i);
      begin = i;
    }
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < is_kept_.size(); ++i) {
      if (is_kept_[i]) kept.push_back(i);
    }
    return kept;
  }

 private:
  void divide(std::size_t first, std::size_t last) {
    std::vector<std::pair<std::size_t, std::size_t>> open{{first, last}};
    while (!open.empty()) {
      const auto [begin, end] = open.back();
      open.pop_back();
      std::size_t worst = begin;
      double max_ratio = 1.0;
      for (std::size_t i = begin + 1; i < end; ++i) {
        const double ratio = compute_ratio(begin, i, end);
        if (ratio > max_ratio) max_ratio = ratio, worst = i;
      }
      if (worst == begin) continue;
      is_kept_[worst] = true;
      open.emplace_back(worst, end);
      open.emplace_back(begin, worst);
    }
  }

  /// Returns the largest ratio of a deviation of sample `i` to its limit.
  double compute_ratio(std::size_t begin, std::size_t i, std::size_t end) const {
    const TrackSample &from = samples_[begin], &to = samples_[end], &sample = samples_[i];
    const double duration = to.time - from.time;
    const double fraction = duration > 0.0 ? (sample.time - from.time) / duration : 0.0;
    const double turn =
        std::max(turn_from(sample.yaw_deg, from.yaw_deg, to.yaw_deg, fraction),
                 turn_from(sample.pitch_deg, from.pitch_deg, to.pitch_deg, fraction));
    return std::max(distance_from(sample.position, from.position, to.position) / tolerance_,
                    turn / max_turn_);
  }

  const std::vector<TrackSample>& samples_;
  double tolerance_, max_turn_;
  std::vector<bool> is_kept_;
};

double compute_deviation(const std::vector<TrackSample>& samples,
                         const std::vector<std::size_t>& kept) {
  double deviation = 0.0;
  std::size_t next = 0;  // index in `kept` of the first waypoint at or after the sample
  for (std::size_t i = 0; i < samples.size(); ++i) {
    while (next + 1 < kept.size() && kept[next] < i) ++next;
    const Vector3d& to = samples[kept[next]].position;
    const Vector3d& from = samples[kept[next > 0 ? next - 1 : 0]].position;
    deviation = std::max(deviation, distance_from(samples[i].position, from, to));
  }
  return deviation;
}

}  // namespace

void SimplificationOptions::validate() const {
  const auto require = [](double value, const char* name) {
    if (value > 0.0 && std::isfinite(value)) return;
    throw Error(ErrorKind::bad_config,
                std::string(name) + " is " + std::to_string(value) + "; it must be positive");
  };
  require(tolerance, "tolerance");
  require(max_turn_deg, "max_turn_deg");
}

SimplifiedTrack simplify_track(const std::vector<TrackSample>& samples,
                               const SimplificationOptions& options) {
  options.validate();
  SimplifiedTrack track;
  if (samples.empty()) return track;
  // A waypoint that is omitted has a representative within this distance, or, if that is omitted
  // for a capture, within twice the distance. The points of both segments move no farther.
  const double same = std::min(0.01, 0.1 * options.tolerance);
  Division division(samples, options.tolerance - 2.0 * same, options.max_turn_deg);
  const auto is_same = [&](const TrackSample& a, const TrackSample& b) {
    constexpr double begin = 0.0;
    return (a.position - b.position).norm() <= same &&
           turn_from(b.yaw_deg, a.yaw_deg, a.yaw_deg, begin) <= options.max_turn_deg &&
           turn_from(b.pitch_deg, a.pitch_deg, a.pitch_deg, begin) <= options.max_turn_deg;
  };
  for (const std::size_t i : division.divide()) {
    if (!track.kept.empty() && is_same(samples[track.kept.back()], samples[i])) {
      if (!samples[i].is_kept) continue;
      if (!samples[track.kept.back()].is_kept) track.kept.pop_back();
    }
    track.kept.push_back(i);
  }
  track.deviation = compute_deviation(samples, track.kept);
  return track;
}

}  // namespace skycap::flight
