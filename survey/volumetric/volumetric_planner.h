/// The volumetric planners: of views given beforehand on a sphere around the scene, take the one
/// that promises most for its way. docs/volumetric.md describes them.
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
#include <Eigen/Geometry>

#include "geometry/place/camera.h"
#include "survey/planner.h"
#include "survey/volumetric/volumetric_gain.h"

namespace skycap::survey::volumetric {

/// Which of equally useful candidates is taken.
enum class TieRule {
  first,    ///< in the order in which they were drawn
  nearest,  ///< to the sensor
};

/// What a mission file may set about a volumetric planner. The defaults are those with which the
/// evaluation code gives the SEE++ paper's figures, as far as the paper lets one tell.
struct VolumetricSettings {
  std::optional<std::size_t> view_limit;  ///< V; a comparison takes SEE's largest number of views
  double candidates_per_view = 2.4;       ///< candidates are V times this (paper §IV-B)
  std::optional<Eigen::Vector3d> sphere_centre;  ///< of the candidates; world frame
  std::optional<double> sphere_radius;

  double cost_weight = 1.0;  ///< of the way, against the gain; both are shares of their sums
  TieRule ties = TieRule::first;
  GainSettings gain;
  RayPattern rays;
  std::optional<double> ray_depth;      ///< where rays end; the sphere's radius
  std::optional<double> shadow_length;  ///< s, of the shadows behind measurements; 18 voxels
  bool thinned = false;           ///< the map takes only points that are kept, not whole scans
  bool carve_no_returns = false;  ///< the map takes pixels without return as free up to ray_depth
};

struct VolumetricConfig {
  VolumetricMetric metric = VolumetricMetric::occlusion_aware;
  double resolution = 0.017;       ///< width of a voxel; the paper takes SEE's radius r
  double spacing = 0.00261711877;  ///< epsilon, least distance of kept points; rho^(-1/2)
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are dropped first
  std::size_t candidates = 312;
  Eigen::Vector3d sphere_centre = Eigen::Vector3d::Zero();
  double sphere_radius = 1.0;
  std::optional<double> least_height;  ///< no candidate is lower
  std::uint64_t seed = 1;              ///< of the candidates
  VolumetricSettings settings;
  unsigned threads = 1;  ///< for scoring; zero: all processors. Never changes a result

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

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

  std::optional<geometry::View> next_view(const geometry::Scan& scan) override;
  std::optional<geometry::View> next_view_instead() override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud release_cloud() override;
  const PlanningStep& last_step() const override;

  const VolumetricMap& map() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::volumetric
