/// Runs surveys on this machine: the one runner of trials, benchmarks, campaigns and districts.
/// Each result is written whole or not at all; what is finished is not run again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/batch/benchmark/contestants.h"
#include "missions/batch/benchmark/trials.h"
#include "missions/batch/campaign/campaign_file.h"
#include "missions/config/key_override.h"
#include "missions/config/resolve.h"

namespace skycap::missions::batch {

/// A mission as one of the contestants surveys it.
struct Setup {
  std::filesystem::path file;  ///< of the mission
  std::string title;           ///< in tables; setups of the same title have the same scene
  const Contestant* contestant = nullptr;
  config::MissionSetup mission;
  std::string kind;         ///< of its surveys, which take about as long as each other
  std::string fingerprint;  ///< trial_fingerprint() of all this
  /// Keeps the scene's truth for other tasks; empty: nothing does.
  std::filesystem::path truth_file = {};

  /// Where the mission's relative paths start.
  std::filesystem::path folder() const { return file.parent_path(); }
  /// To be called when any of the others has changed.
  void name_kind_and_fingerprint();
};

/// A mission that was read already, by its own planner.
Setup own_setup(const std::filesystem::path& file, const config::MissionSetup& mission);

/// Reads a mission for a contestant; null: for its own planner. `origin` is what messages call the
/// choice of planners. Throws what config::read_mission() throws.
Setup read_setup(const std::filesystem::path& file, const Contestant* contestant,
                 const std::string& origin, std::vector<config::KeyOverride> overrides,
                 const config::Report& report = {});

/// How the result of an item is kept.
enum class ItemForm {
  file,     ///< the record alone, in a folder that nobody else writes to
  folder,   ///< the record in a folder of its own, which one program at a time may fill
  package,  ///< and the mission package beside it
};

/// A survey that is to be run.
struct Item {
  std::shared_ptr<const Setup> setup;
  std::uint64_t seed = 0;
  std::filesystem::path record;  ///< of its result, see finished_trial()
  ItemForm form = ItemForm::file;
  std::size_t number = 0;  ///< in a manifest
};

/// Of items, in their order; nothing for those without a result.
using Records = std::vector<std::optional<TrialRecord>>;

/// What a runner tells of, from any thread, one at a time.
struct RunEvents {
  std::function<void(const Item&)> unfinished;  ///< of each that will be run, before any is
  std::function<void(const Setup&)> preparing;  ///< the scene of its mission
  std::function<void(const Item&, const TrialRecord&)> done;  ///< here, and written
  /// Its mission package is staged there: what else belongs beside it may be, too.
  std::function<void(geometry::OutputFolder&)> packaged;
  /// Others go on; without this, they stop, and the first failure is thrown.
  std::function<void(const Error&)> failed;
};

/// The records of those that are finished.
Records finished_items(const std::vector<Item>& items);

/// Runs those that are not finished, up to `threads` at a time (zero: all processors), each survey
/// in one thread, and returns the records of all; nothing for those that failed or that `stop` came
/// before. A scene is kept until the last of its items is done. Throws Error, see RunEvents.
Records run_items(const std::vector<Item>& items, unsigned threads, const std::stop_token& stop,
                  const RunEvents& events);

/// What for_each_batch() tells of.
struct BatchEvents {
  /// Items that are next to each other by mission, variant, planner and seed, in this order.
  std::function<void(const std::vector<Item>&)> work;
  /// A mission cannot be read, and so many of the range's items not be run.
  std::function<void(const Error&, std::size_t items)> failed;
  config::Report reading{};  ///< what of a mission is read
};

/// Hands on all items of a range of a manifest, whose results are in `out`; some at a time, since
/// missions may hold prior data of a whole town each.
void for_each_batch(const Manifest& manifest, const std::filesystem::path& out,
                    const ItemRange& range, const BatchEvents& events);

}  // namespace skycap::missions::batch
