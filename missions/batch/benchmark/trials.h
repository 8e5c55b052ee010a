/// Many surveys of one mission with different seeds, and what they have in common.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// Mean of a figure over the trials, and how sure it is.
struct Statistic {
  double mean = 0.0;
  double deviation = 0.0;      ///< standard deviation, n - 1 in the denominator
  double half_width_95 = 0.0;  ///< of the 95 % confidence interval of the mean, Student's t
};

/// Zero deviation and an infinite half width for one number; `numbers` must not be empty.
Statistic statistic(const std::vector<double>& numbers);

/// Whether a table holds planning times. They are of the machine and of what else it did; all else
/// is the same wherever a trial ran.
enum class Times { shown, left_out };

/// trials.csv: a line for each trial.
std::string trials_csv(const std::vector<Trial>& trials, Times times = Times::shown);

/// trials.json: statistics, mean curves (a finished trial keeps its last coverage), each trial,
/// and the mission's reference figures beside them.
std::string trials_json(const config::MissionSetup& mission, const std::vector<Trial>& trials,
                        std::size_t requested, unsigned threads);

/// The table for the terminal: means and half widths, and the mission's reference figures.
std::string trials_table(const config::MissionSetup& mission, const std::vector<Trial>& trials);

}  // namespace skycap::missions::batch
