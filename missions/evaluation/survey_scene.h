/// Prepared scene of a mission: the ground truth measured by the simulated sensor, and data for the
/// evaluation. It is immutable and shared by all trials of a mission.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/evaluation/evaluation.h"
#include "missions/evaluation/reachable_space.h"
#include "missions/evaluation/simulation_options.h"
#include "sim/scene/scene.h"
#include "survey/planners/planner_options.h"

namespace skycap::missions::evaluation {

class SurveyScene {
 public:
  /// Loads and places the mission's model. `folder` is the base of relative paths. `kept` is a file
  /// that shares the reachable space with other programs; the caller must use one file per mission
  /// and model. Without it, the reachable space is computed on first use. Throws the errors of
  /// scene::load_model() and scene::place_model().
  SurveyScene(const SimulationOptions& options, const std::filesystem::path& folder,
              unsigned threads, const std::filesystem::path& kept = {});

  const geometry::Mesh& model() const { return model_; }  ///< placed model without its surroundings
  /// Scene with surroundings, such as the ground.
  const sim::Scene& scene() const { return scene_; }
  /// Samples of the model's surface.
  const geometry::SurfaceSamples& samples() const { return samples_; }

  /// Returns d [m]: the mission's value, or the value derived from camera and density.
  double view_distance() const { return view_distance_; }

  const survey::ViewSphere& view_sphere() const { return view_sphere_; }

  /// Returns the first view of a survey. It is taken from the initial pattern, the mission or the
  /// flown pattern, or drawn from the view sphere by `seed`. A drawn view is reachable, within the
  /// limits, and looks at the sphere's centre. Throws Error{bad_config} if no such view exists.
  geometry::View first_view(std::uint64_t seed) const {
    return first_view(seed, options_.survey.planner);
  }
  /// Returns the first view of a survey by another planner of the same mission.
  geometry::View first_view(std::uint64_t seed, const survey::PlannerOptions& planner) const;

  /// Returns 1 for each sample visible from an admissible position. The computation takes a second
  /// or more; the result is cached as for attainable(). It is invalid once `stop` is requested.
  std::vector<std::uint8_t> visible(unsigned threads, const std::stop_token& stop = {}) const;

  /// Returns 1 for each sample attainable with the mission's sensor and spacing, see
  /// attainable_samples(). The computation takes seconds to minutes. The result is stored in the
  /// user's cache under a checksum of all its inputs. Returns nullopt if the mission disables it or
  /// if stopped.
  std::optional<std::vector<std::uint8_t>> attainable(const std::vector<std::uint8_t>& is_visible,
                                                      unsigned threads,
                                                      const std::stop_token& stop = {}) const;

  /// Returns the permitted sensor poses. The result refers to this object.
  Admissible admissible() const;

  /// Returns the target of a pattern that specifies none: the horizontal convex hull and the
  /// heights of the true surface within the scene box. Nullopt for other planners.
  std::optional<survey::patterns::PatternTarget> pattern_target(
      const survey::PlannerOptions& planner) const;

  /// Returns whether the sensor can reach a position, for example not inside closed rooms. The
  /// distance from surfaces is not tested.
  bool is_reachable(const Eigen::Vector3d& position) const;

 private:
  /// Data computed on first use by any thread, because a survey may require neither.
  struct Lazily {
    std::once_flag reached_once, distance_once;
    std::optional<ReachableSpace> reached;
    std::optional<geometry::MeshDistance> distance;
  };

  std::string attainable_key() const;
  const ReachableSpace& reachable() const;
  ReachableSpace reachable_space() const;
  const geometry::MeshDistance& truth() const;
  std::optional<geometry::View> first_pattern_view(const survey::PlannerOptions& planner) const;
  bool has_line_of_sight(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  SimulationOptions options_;
  unsigned threads_;
  geometry::Mesh model_;
  sim::Scene scene_;
  geometry::SurfaceSamples samples_;
  double view_distance_;
  survey::ViewSphere view_sphere_;
  double radius_;  ///< sphere radius for reachability [m]
  std::filesystem::path kept_;
  std::shared_ptr<Lazily> lazily_ = std::make_shared<Lazily>();
};

/// Returns the mission's surveyed mesh without the ground: loaded and placed, or from prior data.
geometry::Mesh placed_model(const scene::SceneOptions& options,
                            const std::filesystem::path& folder);

}  // namespace skycap::missions::evaluation
