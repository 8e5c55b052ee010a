/// How a survey is evaluated, and all that a simulated survey works with.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "missions/scene/scene_options.h"
#include "missions/session/survey_options.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::evaluation {

struct EvaluationOptions {
  double registration_distance = 0.005;  ///< r_d: a sample this near to a measurement is covered
  std::size_t samples = 100'000;         ///< points spread over the scene's surface
  std::size_t visible_directions = 200;  ///< from which a sample may be seen; for visible coverage
  std::size_t ceiling_views = 100;       ///< views of the attainable coverage; zero leaves it out
  /// That fits through the ways to places that count; else what the limits keep from surfaces.
  std::optional<double> radius;
};

/// When a survey by the oracle ends, which knows the scene and which planners are compared with.
struct OracleOptions {
  std::size_t max_views = 1000;
  double least_gain = 0.003;  ///< share of the visible surface that every further view adds
};

struct SimulationOptions {
  scene::SceneOptions scene;
  sim::SurveySensorOptions sensor;
  session::SurveyOptions survey;
  EvaluationOptions evaluation;
  OracleOptions oracle;
  /// The text of all keys that decide what of a scene is visible and attainable, which is kept in
  /// the user's cache under a checksum of it.
  std::string attainable_inputs;

  /// The box around the scene; empty: everything.
  Eigen::AlignedBox3d scene_box() const {
    return survey.planner.scene_box.value_or(Eigen::AlignedBox3d());
  }
};

}  // namespace skycap::missions::evaluation
