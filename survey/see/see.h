/// SEE and SEE++: next best views from the density of the measurements alone, with no mesh and no
/// voxel grid.
///
/// Source: Border and Gammell, "Proactive Estimation of Occlusions and Scene Coverage for Planning
/// Next Best Views in an Unstructured Representation" (SEE++), and Border, Gammell and Newman,
/// "Surface Edge Explorer (SEE)", 2018. Symbols of the paper stand beside our names. Where the
/// paper leaves a choice, each reading is a field of SeeConfig; docs/explanation/see.md tells what
/// each does to the results.
#pragma once

#include <memory>
#include <optional>

#include "geometry/place/camera.h"
#include "survey/planner.h"
#include "survey/see/see_config.h"

namespace skycap::survey::see {

/// SEE++ as configured; with `optimise_views` and `visibility_graph` off it is SEE.
class SeePlanner final : public Planner {
 public:
  /// Throws what config.validate() throws.
  SeePlanner(const SeeConfig& config, const geometry::Camera& camera);
  ~SeePlanner() override;

  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_view_instead() override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud release_cloud() override;
  const PlanningStep& last_step() const override;

  /// d, the distance from a frontier to the view proposed for it.
  double view_distance() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::see
