/// Finished trials on disk, so that an interrupted run goes on where it was.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "missions/benchmark/trials.h"

namespace skycap::missions::benchmark {

/// Stands for everything that a trial depends on but its seed and the model's file; `contestant` is
/// who plans.
std::string trial_fingerprint(const file::Mission& mission, const std::string& contestant);

/// The trial in a file, if it is there, whole, and of that fingerprint.
std::optional<Trial> finished_trial(const std::filesystem::path& file,
                                    const std::string& fingerprint);

/// Throws Error{bad_file}.
void write_trial(const std::filesystem::path& file, const std::string& fingerprint,
                 const Trial& trial);

/// Runs `count` surveys with the mission's seed and those after it, up to `threads` at a time, each
/// in one thread. The trials are those that separate runs would give. Each is written to a file in
/// `folder` as it ends; those that an earlier run of the same mission has left there are not run
/// again. Trials that have not begun when `stop` is requested are left out, interrupted ones too.
/// `report` is told of each that ends here, from any thread, one at a time. Throws Error{bad_file}.
std::vector<Trial> run_trials(const file::Mission& mission, const scene::SurveyScene& scene,
                              std::size_t count, unsigned threads,
                              const std::filesystem::path& folder, std::stop_token stop,
                              const std::function<void(const Trial&)>& report);

}  // namespace skycap::missions::benchmark
