/// A mission's scene made ready: the truth that the simulated sensor measures, and what the
/// evaluation needs to know of it. Shared, unchanged, by all trials of a mission.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/pose.h"
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
  /// Loads and places the mission's model; `folder` is where relative paths start. The file `kept`
  /// keeps for other programs what of the scene can be reached, and whoever names it answers for it
  /// being of the same mission and model; without it everybody finds that out anew, when it is
  /// first asked for. Throws what scene::load_model() and scene::place_model() throw.
  SurveyScene(const SimulationOptions& options, const std::filesystem::path& folder,
              unsigned threads, const std::filesystem::path& kept = {});

  const geometry::Mesh& model() const { return model_; }  ///< as placed, by itself
  const sim::Scene& scene() const { return scene_; }  ///< with what is beside it, such as ground
  const geometry::SurfaceSamples& samples() const { return samples_; }  ///< of the model

  /// d: as the mission gives it, or from its camera and density.
  double view_distance() const { return view_distance_; }

  const survey::ViewSphere& view_sphere() const { return view_sphere_; }

  /// The first view of the survey with that seed: of its opening, as the mission gives it, or at
  /// random on the view sphere, within the mission's limits and reachable, looking at the sphere's
  /// centre. Throws Error{bad_config} if there is no such view.
  geometry::View first_view(std::uint64_t seed) const;

  /// For each sample, 1 if an admissible sensor position sees it. Takes a second or more, but is
  /// kept in the user's cache as attainable() is; of no use once `stop` is requested.
  std::vector<std::uint8_t> visible(unsigned threads, const std::stop_token& stop = {}) const;

  /// For each sample, 1 if it is attainable with the mission's sensor and spacing, see
  /// attainable_samples(). Takes seconds to minutes; kept in the user's cache under a
  /// checksum of everything it depends on. Nothing if the mission leaves it out, or if stopped.
  std::optional<std::vector<std::uint8_t>> attainable(const std::vector<std::uint8_t>& is_visible,
                                                      unsigned threads,
                                                      const std::stop_token& stop = {}) const;

  /// Where the mission lets the sensor look at the scene from; refers to this scene.
  Admissible admissible() const;

  /// Whether the sensor can get to a place at all, whoever wants it there: not into sealed rooms.
  /// How near it may be to surfaces is not asked.
  bool is_reachable(const Eigen::Vector3d& place) const;

 private:
  /// Made when they are first asked for, by any thread: a survey may need neither.
  struct Lazily {
    std::once_flag reached_once, distance_once;
    std::optional<ReachableSpace> reached;
    std::optional<geometry::MeshDistance> distance;
  };

  std::string ceiling_key() const;
  const ReachableSpace& reachable() const;
  ReachableSpace reachable_space() const;
  const geometry::MeshDistance& truth() const;
  bool is_in_sight(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  SimulationOptions options_;
  unsigned threads_;
  geometry::Mesh model_;
  sim::Scene scene_;
  geometry::SurfaceSamples samples_;
  double view_distance_;
  survey::ViewSphere view_sphere_;
  double radius_;  ///< that has to fit through ways
  std::filesystem::path kept_;
  std::shared_ptr<Lazily> lazily_ = std::make_shared<Lazily>();
};

/// The mission's mesh as surveyed: loaded and placed, or as its prior data has it; without ground.
geometry::Mesh placed_model(const scene::SceneOptions& options,
                            const std::filesystem::path& folder);

}  // namespace skycap::missions::evaluation
