/// Many surveys of one mission with different seeds, what they have in common, and those that are
/// finished on disk: what an interrupted run, or another machine, need not run again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "missions/config/mission_setup.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/package.h"
#include "missions/simulation/survey_runner.h"

namespace skycap::missions::batch {

/// What the coverage of a scene's surveys is read against; shared by all of them.
struct SceneTruth {
  std::vector<std::uint8_t> is_visible;  ///< for each of the scene's samples
  std::optional<double> ceiling;         ///< attainable coverage
};

/// Takes seconds to minutes. Of no use once `stop` is requested.
SceneTruth scene_truth(const evaluation::SurveyScene& scene, unsigned threads,
                       const std::stop_token& stop = {});

/// What it took until a frontier that views were aimed at was observed: paper Figure 6.
struct ObservedTarget {
  std::size_t views = 0;  ///< since the last target was observed, this one's included
  double distance = 0.0;  ///< travelled for them
};

/// The figures of one survey.
struct Trial {
  std::uint64_t seed = 0;
  survey::StopReason stop_reason = survey::StopReason::complete;
  package::CoverageFigures coverage;
  std::size_t views = 0;
  std::size_t points = 0;
  double planning_time = 0.0;  ///< [s] of a processor: other work beside it hardly counts
  double distance = 0.0;
  std::vector<double> coverage_after;  ///< each view
  std::vector<double> distance_after;
  std::vector<double> planning_time_after;
  std::vector<double> flown_time_after;  ///< of a vehicle; else empty [s]
  std::optional<double> flown_length;    ///< of a vehicle, from the pad to the last view [m]
  std::size_t frontiers_resolved = 0;    ///< points that ceased to be frontiers
  std::vector<ObservedTarget> targets;   ///< that were observed, in this order

  bool is_flown() const { return !flown_time_after.empty(); }
  /// Of a vehicle, from the pad to the last view [s], see session::FlownSurvey.
  std::optional<double> flown_time() const {
    return is_flown() ? std::optional(flown_time_after.back()) : std::nullopt;
  }
};

/// The figures of a survey that is over.
Trial trial_of(const session::SurveyRecord& record, const SceneTruth& truth);

/// A trial as text and back, to the last bit. Throws Error{bad_file} if the text is not a trial.
std::string trial_json(const Trial& trial);
Trial parse_trial(const std::string& json);

/// Stands for everything that a trial depends on but its seed: version, planner (`contestant`),
/// settings, and the contents of the files that they name. `folder` is where relative paths start.
/// Throws Error{bad_file} if one of them cannot be read.
std::string trial_fingerprint(const config::MissionSetup& mission, const std::string& contestant,
                              const std::filesystem::path& folder);

/// Where a trial ran and what that took: of the machine, not of the trial.
struct TrialRun {
  std::string host;
  double wall_time = 0.0;       ///< [s]
  std::size_t peak_memory = 0;  ///< of the program until then [byte]
};

/// `wall_time` and what the machine says of this program.
TrialRun run_here(double wall_time);

struct TrialRecord {
  Trial trial;
  TrialRun run;
};

/// The trial in a file, if it is there, whole, and of that fingerprint.
std::optional<TrialRecord> finished_trial(const std::filesystem::path& file,
                                          const std::string& fingerprint);

/// The file's text.
std::string trial_record_json(const std::string& fingerprint, const TrialRecord& record);

/// Mean of a figure over the trials, and how sure it is.
struct Statistic {
  double mean = 0.0;
  double deviation = 0.0;      ///< standard deviation, n - 1 in the denominator
  double half_width_95 = 0.0;  ///< of the 95 % confidence interval of the mean, Student's t
};

/// Zero deviation and an infinite half width for one number; `numbers` must not be empty.
Statistic statistic(const std::vector<double>& numbers);

}  // namespace skycap::missions::batch
