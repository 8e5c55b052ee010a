/// A resolved mission: complete options for each module, and the key values that they were derived
/// from. It is immutable after resolve(). Settings of a single run are in RunOptions.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "missions/evaluation/simulation_options.h"
#include "missions/online/live/live_options.h"
#include "missions/scan/scan_options.h"
#include "missions/session/survey_options.h"
#include "missions/support/identity.h"

namespace skycap::missions::config {

struct MissionDocument;

/// Published results for a scene, printed next to the results of trials.
struct ReferenceResults {
  std::optional<double> views;
  std::optional<double> coverage;       ///< fraction, not percent
  std::optional<double> planning_time;  ///< duration of all planning in a survey [s]
  std::optional<double> distance;
};

struct MissionSetup {
  std::string name;  ///< mission name, used for the results folder
  evaluation::SimulationOptions simulation;
  std::optional<std::string> lidar;  ///< preset or description of the surveying laser scanner
  scan::ScanFlightOptions scan;
  online::LiveOptions live;
  ReferenceResults reference;
  session::RunOptions run;  ///< values from the mission file or from command-line options

  /// All keys that affect the survey, as strings. They must match for an unfinished survey to be
  /// resumed, and they identify equivalent trials.
  std::vector<support::Setting> settings;
  /// Document with all derived values, for results that store the mission.
  std::shared_ptr<const MissionDocument> document;
  struct Source;
  std::shared_ptr<const Source> source;  ///< inputs of resolve(), for with_keys()

  const session::SurveyOptions& survey() const { return simulation.survey; }
  const flight::FlightOptions& flight() const { return simulation.survey.flight; }
  const sim::SurveySensorOptions& sensor() const { return simulation.sensor; }
  const scene::SceneOptions& scene() const { return simulation.scene; }
  const evaluation::EvaluationOptions& evaluation() const { return simulation.evaluation; }
  support::Identity identity() const { return {run.seed, settings}; }
  bool is_live() const { return scene().model.empty() && !scene().is_truth_prior(); }

  /// Returns the value of a key in mission-file notation, or "-" if it has no value. Throws
  /// std::out_of_range for an unknown key.
  std::string text(std::string_view key) const;
};

}  // namespace skycap::missions::config
