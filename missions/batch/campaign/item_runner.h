/// Runs items on this machine. Each result is written whole or not at all; what is finished is not
/// run again.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/batch/benchmark/trial_files.h"
#include "missions/batch/campaign/survey_item.h"

namespace skycap::missions::batch {

/// What a runner tells of, from any thread, one at a time.
struct RunEvents {
  std::function<void(const Item&)> unfinished;  ///< of each that will be run, before any is
  std::function<void(const Setup&)> preparing;  ///< the scene of its mission
  std::function<void(const Item&, const batch::TrialRecord&)> done;  ///< here, and written
  /// Its mission package is staged there: what else belongs beside it may be, too.
  std::function<void(const Item&, geometry::OutputFolder&)> packaged;
  /// Others go on; without this, they stop, and the first failure is thrown.
  std::function<void(const Item&, const Error&)> failed;
};

/// The records of those that are finished.
std::vector<std::optional<batch::TrialRecord>> finished_items(const std::vector<Item>& items);

/// Runs those that are not finished, up to `threads` at a time (zero: all processors), each survey
/// in one thread, and returns the records of all; nothing for those that failed or that `stop` came
/// before. A scene is kept until the last of its items is done. Throws Error, see RunEvents.
std::vector<std::optional<batch::TrialRecord>> run_items(const std::vector<Item>& items,
                                                         unsigned threads,
                                                         const std::stop_token& stop,
                                                         const RunEvents& events);

}  // namespace skycap::missions::batch
