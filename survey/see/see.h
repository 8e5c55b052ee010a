/// SEE and SEE++: next best views based on the density of the measurements, without mesh or voxel
/// grid.
///
/// Sources: Border and Gammell, "Proactive Estimation of Occlusions and Scene Coverage for Planning
/// Next Best Views in an Unstructured Representation" (SEE++); Border, Gammell and Newman, "Surface
/// Edge Explorer (SEE)", 2018. Comments relate identifiers to the symbols of the paper. Where the
/// paper is ambiguous, the interpretation is a field of SeeConfig; docs/explanation/see.md
/// describes its effect on the results.
#pragma once

#include <memory>
#include <optional>

#include "geometry/pose/camera.h"
#include "survey/planner.h"
#include "survey/see/see_config.h"

namespace skycap::survey::see {

/// SEE++ planner. With `optimise_views` and `visibility_graph` off, it is SEE.
class SeePlanner final : public Planner {
 public:
  /// Throws the errors of config.validate().
  SeePlanner(const SeeConfig& config, const geometry::Camera& camera);
  ~SeePlanner() override;

  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_alternative_view() override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud take_cloud() override;
  const PlanningStep& last_step() const override;

  /// Returns d, the distance between a frontier and its proposed view [m].
  double view_distance() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::see
