/// Trials: surveys of one mission with different seeds. Completed trials are stored on disk, so
/// that a resumed run or another machine does not repeat them.
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

/// Ground truth for the coverage of a scene, shared by all its surveys.
struct SceneTruth {
  std::vector<std::uint8_t> is_visible;       ///< visibility of each surface sample of the scene
  std::optional<double> attainable_coverage;  ///< attainable coverage, if computed
};

/// Computes the ground truth of a scene, which takes seconds to minutes. The result is invalid once
/// `stop` is requested.
SceneTruth scene_truth(const evaluation::SurveyScene& scene, unsigned threads,
                       const std::stop_token& stop = {});

/// Effort until a targeted frontier was observed (Figure 6 of the paper).
struct ObservedTarget {
  /// Views since the previous target was observed, including the observing view.
  std::size_t views = 0;
  double distance = 0.0;  ///< distance travelled for these views [m]
};

/// Results of one survey.
struct Trial {
  std::uint64_t seed = 0;
  survey::StopReason stop_reason = survey::StopReason::complete;
  package::CoverageFigures coverage;
  std::size_t views = 0;
  std::size_t points = 0;
  double planning_time = 0.0;  ///< processor time [s], almost independent of the machine's load
  double distance = 0.0;
  std::vector<double> coverage_after;  ///< coverage after each view
  std::vector<double> distance_after;
  std::vector<double> planning_time_after;
  /// Flight time after each view [s]; empty without a vehicle.
  std::vector<double> flight_time_after;
  /// Flight length from the pad to the last view [m], with a vehicle.
  std::optional<double> flight_length;
  /// Measures of protocol_g.h. Nullopt for results of other programs and of earlier versions.
  std::optional<double> grid_coverage, grid_coverage_visible, chamfer_distance;
  std::size_t frontiers_resolved = 0;   ///< points that ceased to be frontiers
  std::vector<ObservedTarget> targets;  ///< observed targets in chronological order

  bool has_vehicle() const { return !flight_time_after.empty(); }
  /// Returns the vehicle's flight time from the pad to the last view [s], see
  /// session::FlightRecord. Returns nullopt without a vehicle.
  std::optional<double> flight_time() const {
    return has_vehicle() ? std::optional(flight_time_after.back()) : std::nullopt;
  }
};

/// Computes the results of a completed survey of `scene`.
Trial make_trial(const session::SurveyRecord& record, const evaluation::SurveyScene& scene,
                 const SceneTruth& truth);

/// Convert a trial to JSON and back without loss. parse_trial() throws Error{bad_file} if the
/// string is not a trial.
std::string trial_json(const Trial& trial);
Trial parse_trial(const std::string& json);

/// Returns a fingerprint of all inputs of a trial except its seed: version, planner (`method`),
/// settings, and contents of the files they name. `folder` is the base of relative paths. Throws
/// Error{bad_file} if a file cannot be read.
std::string trial_fingerprint(const config::MissionSetup& mission, const std::string& method,
                              const std::filesystem::path& folder);

/// Host, duration and memory of a run. These depend on the machine and are not part of the trial.
struct TrialRun {
  std::string host;
  double wall_time = 0.0;       ///< elapsed time [s]
  std::size_t peak_memory = 0;  ///< peak memory of the process up to the end of the run [byte]
};

/// Returns `wall_time` with the current host name and the peak memory of this process.
TrialRun run_here(double wall_time);

struct TrialRecord {
  Trial trial;
  TrialRun run;
};

/// Reads a trial from a file. Returns nullopt if the file is missing or incomplete, or has another
/// fingerprint.
std::optional<TrialRecord> finished_trial(const std::filesystem::path& file,
                                          const std::string& fingerprint);

/// Returns the contents of a trial file.
std::string trial_record_json(const std::string& fingerprint, const TrialRecord& record);

/// Mean of a figure over the trials with its uncertainty.
struct Statistic {
  double mean = 0.0;
  double deviation = 0.0;  ///< sample standard deviation (denominator n - 1)
  /// Half width of the 95% confidence interval of the mean (Student's t).
  double half_width_95 = 0.0;
};

/// Computes the statistic of `numbers`, which must not be empty. For a single number, the deviation
/// is zero and the half width infinite.
Statistic statistic(const std::vector<double>& numbers);

}  // namespace skycap::missions::batch
