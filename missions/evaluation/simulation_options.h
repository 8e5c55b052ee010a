/// Options for simulated surveys and their evaluation.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "missions/scene/scene_options.h"
#include "missions/session/survey_options.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::evaluation {

struct EvaluationOptions {
  /// r_d: maximum distance of a measurement from a covered sample [m].
  double registration_distance = 0.005;
  std::size_t samples = 100'000;         ///< number of samples on the scene's surface
  std::size_t visible_directions = 200;  ///< directions tested for the visibility of a sample
  std::size_t attainable_views = 100;    ///< views for the attainable coverage; zero: not computed
  /// Radius of a sphere that must fit through paths to views [m]. Default: minimum distance of
  /// views from surfaces according to the limits.
  std::optional<double> radius;
};

/// Stop criterion of the oracle, a reference planner with access to the ground truth.
struct OracleOptions {
  std::size_t max_views = 1000;
  /// Minimum coverage gain per view, as a fraction of the visible surface.
  double min_gain = 0.003;
};

struct SimulationOptions {
  scene::SceneOptions scene;
  sim::SurveySensorOptions sensor;
  session::SurveyOptions survey;
  EvaluationOptions evaluation;
  OracleOptions oracle;
  /// Keys and values that determine the visible and attainable surface. Their checksum identifies
  /// the results in the user's cache.
  std::string attainable_inputs;

  /// Returns the box around the scene; empty: unlimited.
  Eigen::AlignedBox3d scene_box() const {
    return survey.planner.scene_box.value_or(Eigen::AlignedBox3d());
  }
};

}  // namespace skycap::missions::evaluation
