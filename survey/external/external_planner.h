/// Planner of a user (survey/own_planner.h) as a planner of Skycap.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "geometry/pose/camera.h"
#include "survey/kept_points.h"
#include "survey/own_planner.h"
#include "survey/planner.h"

namespace skycap::survey::external {

/// Created planner.
struct LoadedPlanner {
  std::unique_ptr<OwnPlanner> planner;
  /// Returns the processor time of other processes for the last call [s]. Empty: none.
  std::function<double()> processor_time_elsewhere{};
  /// Sets the token of stop requests. Empty: calls are not interrupted.
  std::function<void(const std::stop_token&)> stop_on{};
};

struct ExternalConfig {
  std::string file;  ///< file of the planner, for messages
  /// Creates the planner. Throws Error if the file is missing or is not a planner.
  std::function<LoadedPlanner(const OwnPlannerTask&)> make;
  OwnPlannerTask task;

  /// Throws Error{bad_config} if no file is set.
  void validate() const;
};

class ExternalPlanner final : public Planner {
 public:
  /// Throws the errors of config.validate() and config.make().
  explicit ExternalPlanner(const ExternalConfig& config);

  /// Throws Error{bad_file} with the file for an exception of the user's planner and for a view
  /// that is not finite or has no direction.
  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_alternative_view() override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override { return kept_.cloud(); }
  geometry::PointCloud take_cloud() override { return kept_.take(); }
  const PlanningStep& last_step() const override { return step_; }

 private:
  template <typename Call>
  std::optional<geometry::View> call(const Call& planner_call);

  std::string file_;
  KeptPoints kept_;
  LoadedPlanner loaded_;
  PlanningStep step_;
};

}  // namespace skycap::survey::external
