/// Finished trials on disk: what an interrupted run, or another machine, need not run again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "missions/batch/benchmark/trials.h"

namespace skycap::missions::batch {

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

}  // namespace skycap::missions::batch
