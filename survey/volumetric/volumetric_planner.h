/// Volumetric planners: select views from a fixed set on a sphere around the scene by predicted
/// gain and path length. See docs/explanation/volumetric.md.
///
/// Source: Delmerico et al., Autonomous Robots 42 (2018), whose evaluation code the SEE++ paper
/// compares with (§IV).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/camera.h"
#include "survey/planner.h"
#include "survey/volumetric/volumetric_config.h"
#include "survey/volumetric/volumetric_map.h"

namespace skycap::survey::volumetric {

/// Returns `count` views of the sphere's centre. Their positions are distributed independently and
/// uniformly over the sphere, without the part below `min_height`, if given. Throws
/// Error{bad_config} if the whole sphere is below it.
std::vector<geometry::View> sphere_views(std::size_t count, const Eigen::Vector3d& centre,
                                         double radius, const std::optional<double>& min_height,
                                         std::uint64_t seed);

/// Returns the index with the maximum utility: gain / sum of gains - cost_weight * distance / sum
/// of distances. A term with a zero sum is zero. Both spans must have the same size and not be
/// empty.
std::size_t select_best(std::span<const double> gains, std::span<const double> distances,
                        double cost_weight, TieRule ties);

/// Uses every candidate at most once and ends when none is left. It does not detect that a scene is
/// complete.
class VolumetricPlanner final : public Planner {
 public:
  /// Throws the errors of config.validate() and sphere_views().
  VolumetricPlanner(const VolumetricConfig& config, const geometry::Camera& camera);
  ~VolumetricPlanner() override;

  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_alternative_view() override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud take_cloud() override;
  const PlanningStep& last_step() const override;

  const VolumetricMap& map() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::volumetric
