/// The interface of every planner: it takes what the sensor measured and says where to look next.
/// Nothing behind it knows whether the sensor is real or simulated.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "geometry/place/pose.h"
#include "geometry/points/point_cloud.h"
#include "geometry/points/scan.h"
#include "survey/survey_limits.h"

namespace skycap::survey {

class CoverageEstimator;

/// Whether views may be at a place; must be safe to call from several threads.
using PlaceCheck = std::function<bool(const Eigen::Vector3d&)>;

/// Time one part of the planner took for one view.
struct PartTime {
  std::string part;  ///< such as "insert"
  double seconds;
};

/// What a planner did with the last scan.
struct PlanningStep {
  std::size_t points_new = 0;           ///< points kept of the scan
  std::size_t frontiers = 0;            ///< places still worth looking at
  std::size_t frontiers_resolved = 0;   ///< that are no longer worth it because of this scan
  std::optional<bool> target_resolved;  ///< whether the place that the view was for is among them
  std::vector<PartTime> times;          ///< in the order of execution; their sum is the planning
};

/// Thrown by a planner that was told to stop while it looked for a view.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

class Planner {
 public:
  virtual ~Planner() = default;

  /// Takes in a scan and proposes the next view; nothing when the survey is complete. The scan may
  /// be from another pose than was proposed. Throws Error{bad_geometry} if the first scan holds no
  /// point of the scene: then there is nothing to plan from.
  virtual std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) = 0;

  /// Takes in a scan that was made on the way to the view that was proposed last, after the first
  /// next_view(). Planners that learn only from the views that they asked for leave it out.
  virtual void pass(const geometry::ScanSpan& /*scan*/) {}

  /// Proposes another view in place of the last one, which cannot be reached; nothing when there
  /// is none left. May be called repeatedly.
  virtual std::optional<geometry::View> next_view_instead() = 0;

  /// Tells the planner where views may be, by what is known when they are proposed. A planner that
  /// does not ask learns it from next_view_instead(), view by view.
  virtual void keep_to(PlaceCheck /*may_be_at*/) {}

  /// Whether the limits that the planner keeps its own views to allow a view that the survey asks
  /// for, such as one of its opening. A planner without such limits allows any.
  virtual bool allows(const geometry::View& /*view*/) { return true; }

  /// Lets a stop end next_view() wherever it is: it then throws Interrupted, and may not be called
  /// again. Planners whose views take no time to speak of need not listen.
  virtual void stop_on(const std::stop_token& /*stop*/) {}

  /// The measurements kept so far.
  virtual const geometry::PointCloud& cloud() const = 0;

  /// Hands them over at the end of the survey. Nothing may be asked of the planner afterwards.
  virtual geometry::PointCloud release_cloud() = 0;

  /// What the last next_view() did.
  virtual const PlanningStep& last_step() const = 0;

  /// Why the last call proposed nothing. A planner that knows limits of the survey says which of
  /// them it would break.
  virtual StopReason stop_reason() const { return StopReason::complete; }

  /// What the planner estimates of the surface; null if it does not.
  virtual const CoverageEstimator* estimator() const { return nullptr; }

 protected:
  Planner() = default;
  Planner(const Planner&) = default;
  Planner& operator=(const Planner&) = default;
};

}  // namespace skycap::survey
