/// Interface of all planners: a planner receives scans and proposes the next view. Real and
/// simulated sensors are treated alike.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "geometry/points/point_cloud.h"
#include "geometry/points/scan.h"
#include "geometry/pose/pose.h"
#include "survey/survey_limits.h"

namespace skycap::survey {

class CoverageEstimator;

/// Returns whether views at a position are allowed. Must be thread-safe.
using PositionCheck = std::function<bool(const Eigen::Vector3d&)>;

/// Computing time of one part of the planner for one view.
struct PartTime {
  std::string part;  ///< such as "insert"
  double seconds;
};

/// Effects of the last scan on the planner.
struct PlanningStep {
  std::size_t points_new = 0;  ///< points kept from the scan
  std::size_t frontiers = 0;   ///< open frontiers; for Skycap's own planner unobserved patches
  std::size_t frontiers_resolved = 0;   ///< frontiers that this scan resolved
  std::optional<bool> target_resolved;  ///< whether the frontier of the proposed view was resolved
  std::vector<PartTime> times;          ///< in order of execution; the sum is the planning time [s]
  double processor_time_elsewhere = 0.0;  ///< processor time of other processes [s]
};

/// Views of a planner that flies a pattern.
struct PatternRecord {
  std::size_t planned = 0;  ///< Views of the pattern, without those that are passed en route.
  std::size_t flown = 0;    ///< Views that were taken, including moved ones.
  std::size_t moved = 0;    ///< Views taken from farther away than planned.
  /// Views that are outside the limits or that the vehicle cannot reach, as planned.
  std::vector<geometry::View> dropped{};
};

/// Thrown by a planner when a stop request ends the search for a view.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

class Planner {
 public:
  virtual ~Planner() = default;

  /// Processes a scan and returns the next view, or nullopt if the survey is complete. The pose of
  /// the scan may differ from the proposed view. Throws Error{bad_geometry} if the first scan
  /// contains no point of the scene, because planning needs at least one.
  virtual std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) = 0;

  /// Processes a scan taken en route to the last proposed view. Must not be called before the first
  /// next_view(). Planners that learn only from proposed views ignore such scans.
  virtual void pass(const geometry::ScanSpan& /*scan*/) {}

  /// Returns another view instead of the last one, which is unreachable, or nullopt if there are no
  /// more. May be called repeatedly.
  virtual std::optional<geometry::View> next_alternative_view() = 0;

  /// Restricts proposals to positions allowed by `may_be_at` at the time of the proposal. Planners
  /// that ignore it receive next_alternative_view() for each rejected view.
  virtual void keep_to(PositionCheck /*may_be_at*/) {}

  /// Returns whether the planner's own limits allow a view chosen by the survey, such as one of the
  /// initial pattern. A planner without limits allows all views.
  virtual bool allows(const geometry::View& /*view*/) { return true; }

  /// Sets the token of stop requests. A stop request lets next_view() throw Interrupted; the
  /// planner must not be used afterwards. Planners with negligible computing time may ignore it.
  virtual void stop_on(const std::stop_token& /*stop*/) {}

  /// Returns all points kept so far.
  virtual const geometry::PointCloud& cloud() const = 0;

  /// Moves the cloud out of the planner at the end of the survey. No other member function may be
  /// called afterwards.
  virtual geometry::PointCloud take_cloud() = 0;

  /// Returns the effects of the last next_view().
  virtual const PlanningStep& last_step() const = 0;

  /// Returns why the last call proposed no view. A planner with limits of its own names the limit
  /// that another view would exceed.
  virtual StopReason stop_reason() const { return StopReason::complete; }

  /// Returns the coverage estimator, or null if the planner has none.
  virtual const CoverageEstimator* estimator() const { return nullptr; }

  /// Returns the views of the pattern so far, or nullopt for planners without a pattern.
  virtual std::optional<PatternRecord> pattern() const { return std::nullopt; }

 protected:
  Planner() = default;
  Planner(const Planner&) = default;
  Planner& operator=(const Planner&) = default;
};

}  // namespace skycap::survey
