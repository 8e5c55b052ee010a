/// A mission as its file says it: which scene, which sensor, which planner, and how the result is
/// judged. Plain data; read_mission() fills it, docs/mission_file.md lists every key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "sim/depth_camera.h"
#include "sim/models/models.h"
#include "survey/see.h"
#include "survey/skycap_planner.h"
#include "survey/volumetric_planner.h"

namespace skycap::missions {

/// Which axis of the model's own frame points up.
enum class UpAxis { z, y };

/// What is surveyed, and how it is put into the world. In this order the model is turned upright,
/// rotated, scaled, and moved so that the middle of the base of its bounding box is at `position`.
struct SceneConfig {
  std::string model;  ///< builtin:NAME, model:NAME, or the path of a mesh
  sim::LevelOfDetail detail = sim::LevelOfDetail::standard;  ///< of a builtin model
  UpAxis up_axis = UpAxis::z;
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad], about x, then y, then z
  std::optional<double> longest_side;                  ///< of the bounding box, after rotation
  std::optional<double> scale;                         ///< factor; only one of the two is given
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  bool ground = false;  ///< whether the sensor also sees a plane under the model
};

enum class SensorPreset {
  d435,             ///< Intel RealSense D435: 848 x 480 pixels, 69.4 x 42.5 degrees
  high_resolution,  ///< 2400 x 1750 pixels, 60 x 40 degrees (paper §IV-A, Radcliffe Camera)
};

struct SensorConfig {
  SensorPreset preset = SensorPreset::d435;
  sim::DepthCameraConfig camera = sim::d435();  ///< its noise's seed is the mission's
};

enum class PlannerName { see_plus_plus, see, skycap, rsv, rse, oa, uv, pc, af, ae };

/// The gain that a volumetric planner goes by; nothing for the others.
std::optional<survey::VolumetricMetric> volumetric_metric(PlannerName name);

enum class PlannerPreset {
  paper,     ///< the published parameters
  building,  ///< what keeps SEE++ from stalling on large scenes: docs/mission_file.md
};

struct PlannerConfig {
  PlannerName name = PlannerName::see_plus_plus;
  PlannerPreset preset = PlannerPreset::paper;
  survey::SeeConfig see;
  survey::StopRule skycap_stop;  ///< of the planner skycap; the rest follows from the other keys
};

/// The first view. Without a position it is drawn at random by the seed.
struct StartConfig {
  std::optional<Eigen::Vector3d> position;
  std::optional<Eigen::Vector3d> look_at;    ///< a point; with a position, either this
  std::optional<Eigen::Vector3d> direction;  ///< or this is given
};

struct LimitsConfig {
  std::size_t max_views = 1000;
  double max_distance = 1e9;               ///< straight lines between views
  std::optional<double> ground_clearance;  ///< least height of a view above `scene.position`
};

struct EvaluationConfig {
  double registration_distance = 0.005;  ///< r_d: a sample this near to a measurement is covered
  std::size_t samples = 100'000;         ///< points spread over the scene's surface
  std::size_t visible_directions = 200;  ///< from which a sample may be seen; for visible coverage
  std::size_t ceiling_views = 100;       ///< views of the attainable coverage; zero leaves it out
};

/// What a publication reports for this scene, printed beside the results of trials.
struct ReferenceConfig {
  std::optional<double> views;
  std::optional<double> coverage;       ///< share, not percent
  std::optional<double> planning_time;  ///< [s] for a survey
  std::optional<double> distance;
};

struct Mission {
  std::string name;  ///< names the results' folder
  SceneConfig scene;
  SensorConfig sensor;
  PlannerConfig planner;
  survey::VolumetricSettings volumetric;  ///< of the planners rsv to ae
  StartConfig start;
  LimitsConfig limits;
  EvaluationConfig evaluation;
  ReferenceConfig paper;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< zero: all processors
};

}  // namespace skycap::missions
