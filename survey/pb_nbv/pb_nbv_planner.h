/// PB-NBV: selects views by projecting ellipsoids that enclose occupied voxels and frontiers.
///
/// Source: Jia, Li, Hao and Zhang, "PB-NBV: Efficient Projection-Based Next-Best-View Planning
/// Framework for Reconstruction of Unknown Objects", IEEE RA-L 2025 (arXiv 2501.10663v2). Written
/// from the text. Reading::released follows the released code where it differs. Missions cannot
/// select this planner yet.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/pose/camera.h"
#include "survey/pb_nbv/ellipsoid.h"
#include "survey/pb_nbv/pb_nbv_config.h"
#include "survey/planner.h"

namespace skycap::survey::pb_nbv {

/// Ellipsoid of one cluster.
struct ScoredEllipsoid {
  Ellipsoid ellipsoid;
  bool is_frontier = false;  ///< encloses frontiers; otherwise occupied voxels
};

/// Returns the score of a view: the sum of the pixels of each projected ellipsoid, weighted by
/// 0.5^rank, positive for frontiers and negative for occupied voxels. The rank is by depth of the
/// centre, beginning with 0 for the nearest.
double compute_score(std::span<const ScoredEllipsoid> ellipsoids, const geometry::View& view,
                     const ScoreImage& image, Reading reading);

/// Has no stopping rule: the number of views is limited by the survey. If no frontier is left, it
/// continues; last_step().frontiers is zero then.
class PbNbvPlanner final : public Planner {
 public:
  /// Throws the errors of config.validate().
  PbNbvPlanner(const PbNbvConfig& config, const geometry::Camera& camera);
  ~PbNbvPlanner() override;

  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_alternative_view() override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud take_cloud() override;
  const PlanningStep& last_step() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::pb_nbv
