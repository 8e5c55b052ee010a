/// The volumetric planners: of views given beforehand on a sphere around the scene, take the one
/// that promises most for its way. docs/explanation/volumetric.md describes them.
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

#include "geometry/place/camera.h"
#include "survey/planner.h"
#include "survey/volumetric/volumetric_config.h"
#include "survey/volumetric/volumetric_map.h"

namespace skycap::survey::volumetric {

/// `count` views of the sphere's centre from places drawn independently, uniformly over the part
/// of the sphere that is not below `least_height`, if that is given. Throws Error{bad_config} if
/// nothing is left.
std::vector<geometry::View> sphere_views(std::size_t count, const Eigen::Vector3d& centre,
                                         double radius, const std::optional<double>& least_height,
                                         std::uint64_t seed);

/// The index of the largest utility, gain / sum of gains - cost_weight * distance / sum of
/// distances, where a sum of zero makes its term zero. The two spans are equally long, and not
/// empty.
std::size_t most_useful(std::span<const double> gains, std::span<const double> distances,
                        double cost_weight, TieRule ties);

/// Takes every candidate at most once and proposes nothing when none is left; it does not notice
/// that a scene is complete.
class VolumetricPlanner final : public Planner {
 public:
  /// Throws what config.validate() and sphere_views() throw.
  VolumetricPlanner(const VolumetricConfig& config, const geometry::Camera& camera);
  ~VolumetricPlanner() override;

  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan) override;
  std::optional<geometry::View> next_view_instead() override;
  void stop_on(const std::stop_token& stop) override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud release_cloud() override;
  const PlanningStep& last_step() const override;

  const VolumetricMap& map() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::volumetric
