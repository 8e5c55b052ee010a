/// A mission ready to be run: one options struct for each part of the program, complete, and the
/// texts of the keys that they came from. It is not changed after resolve(); what belongs to one
/// run is in RunOptions.
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

/// What a publication reports for a scene, printed beside the results of trials.
struct ReferenceResults {
  std::optional<double> views;
  std::optional<double> coverage;       ///< share, not percent
  std::optional<double> planning_time;  ///< [s] for a survey
  std::optional<double> distance;
};

struct MissionSetup {
  std::string name;  ///< names the results' folder
  evaluation::SimulationOptions simulation;
  std::optional<std::string> lidar;  ///< the preset or description of the scanner that surveys
  scan::FlownScanOptions scan;
  online::LiveOptions live;
  ReferenceResults reference;
  session::RunOptions run;  ///< as the mission gives them, or an option of the command line

  /// All keys that decide how a survey goes, as texts: what an unfinished survey has to be
  /// continued with, and what makes two trials the same.
  std::vector<support::Setting> settings;
  /// What the keys say, completed: for results that keep them.
  std::shared_ptr<const MissionDocument> document;
  struct Source;
  std::shared_ptr<const Source> source;  ///< what it was resolved from, see with_keys()

  const session::SurveyOptions& survey() const { return simulation.survey; }
  const flight::FlightOptions& flight() const { return simulation.survey.flight; }
  const sim::SurveySensorOptions& sensor() const { return simulation.sensor; }
  const scene::SceneOptions& scene() const { return simulation.scene; }
  const evaluation::EvaluationOptions& evaluation() const { return simulation.evaluation; }
  support::Identity identity() const { return {run.seed, settings}; }
  bool is_live() const { return scene().model.empty() && !scene().is_truth_prior(); }

  /// The value of a key as a mission file would say it; "-" where it has none. Throws
  /// std::out_of_range for what is no key.
  std::string text(std::string_view key) const;
};

}  // namespace skycap::missions::config
