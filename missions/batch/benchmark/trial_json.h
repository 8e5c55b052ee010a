/// What JSON files say of trials: the same in results.json and trials.json.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "missions/batch/benchmark/trials.h"

namespace skycap::missions::batch {

/// {"mean", "standard_deviation", "half_width_95"}; of one number the half width is null.
nlohmann::ordered_json statistic_json(const Statistic& statistic);

/// {"views", "planning_time_s", "distance_m", "flown_s"}: the mean coverage over the trials along
/// each, as {"x", "coverage", "standard_deviation"}; lists are empty for what no trial has.
nlohmann::ordered_json curves_json(const std::vector<Trial>& trials);

/// Of each trial {"seed", "stop_reason", "views", "coverage", "distance_m", "planning_time_s"}.
nlohmann::ordered_json each_trial_json(const std::vector<Trial>& trials);

}  // namespace skycap::missions::batch
