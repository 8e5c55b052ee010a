/// Runs surveys on this machine, for trials, benchmarks, campaigns and districts. Each result is
/// written atomically. Completed surveys are not run again.
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
#include "missions/batch/benchmark/methods.h"
#include "missions/batch/benchmark/trials.h"
#include "missions/batch/campaign/campaign_file.h"
#include "missions/config/key_override.h"
#include "missions/config/resolve.h"

namespace skycap::missions::batch {

/// Mission with the contestant that surveys it.
struct Setup {
  std::filesystem::path file;  ///< mission file
  std::string title;           ///< title in tables; setups with the same title share a scene
  const Method* method = nullptr;
  config::MissionSetup mission;
  std::string kind;         ///< kind of survey; surveys of one kind have similar durations
  std::string fingerprint;  ///< trial_fingerprint() of this setup
  /// Cache file of the scene's ground truth, shared with other tasks; empty: no cache.
  std::filesystem::path truth_file = {};

  /// Returns the base folder of the mission's relative paths.
  std::filesystem::path folder() const { return file.parent_path(); }
  /// Updates `kind` and `fingerprint`. Call it after changing any other member.
  void name_kind_and_fingerprint();
};

/// Creates a setup for a mission that is already read, with the mission's planner.
Setup own_setup(const std::filesystem::path& file, const config::MissionSetup& mission);

/// Reads a mission for a contestant, or for the mission's planner if `method` is null. `origin`
/// is the option named in messages about the planner. Throws the errors of config::read_mission().
Setup read_setup(const std::filesystem::path& file, const Method* method, const std::string& origin,
                 std::vector<config::KeyOverride> overrides, const config::Report& report = {});

/// Storage form of an item's result.
enum class ItemOutput {
  file,     ///< record file only, in a folder that no other program writes to
  folder,   ///< record file in its own folder, which one program at a time locks
  package,  ///< record file and mission package in the same folder
};

/// Survey to be run.
struct BatchItem {
  std::shared_ptr<const Setup> setup;
  std::uint64_t seed = 0;
  std::filesystem::path record;  ///< record file of the result, see finished_trial()
  ItemOutput form = ItemOutput::file;
  std::size_t number = 0;  ///< index in a manifest
};

/// Records in the order of the items; nullopt for missing results.
using Records = std::vector<std::optional<TrialRecord>>;

/// Callbacks of a runner. They are called from any thread, but never concurrently.
struct RunEvents {
  /// Called for each pending item before any item is run.
  std::function<void(const BatchItem&)> unfinished;
  std::function<void(const Setup&)> preparing;  ///< called before the scene is loaded
  /// Called after an item was run and its record written.
  std::function<void(const BatchItem&, const TrialRecord&)> done;
  /// Called when the mission package is staged, so that further files can be staged with it.
  std::function<void(geometry::OutputFolder&)> packaged;
  /// Called for each failure; other items continue. Without this callback, the run stops and the
  /// first failure is thrown.
  std::function<void(const Error&)> failed;
};

/// Returns the records of completed items.
Records finished_items(const std::vector<BatchItem>& items);

/// Runs the pending items, each survey in one thread, and returns all records. Up to `threads`
/// surveys run concurrently; zero selects the number of processors. Items that failed or were
/// stopped have no record. A scene is released after its last item. Throws Error as described in
/// RunEvents.
Records run_items(const std::vector<BatchItem>& items, unsigned threads,
                  const std::stop_token& stop, const RunEvents& events);

/// Callbacks of for_each_batch().
struct BatchEvents {
  /// Receives items adjacent in mission, variant, planner and seed, in this order.
  std::function<void(const std::vector<BatchItem>&)> work;
  /// Called if a mission cannot be read; `items` is the number of affected items in the range.
  std::function<void(const Error&, std::size_t items)> failed;
  config::Report reading{};  ///< progress of reading a mission
};

/// Passes the items of a manifest range to `events.work` in batches. Batches limit memory, since
/// each mission may have prior data of a whole town. `out` is the results folder.
void for_each_batch(const Manifest& manifest, const std::filesystem::path& out,
                    const ItemRange& range, const BatchEvents& events);

}  // namespace skycap::missions::batch
