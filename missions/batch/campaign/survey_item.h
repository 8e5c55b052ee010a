/// A survey that is to be run: what a mission's items share, and the items.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "missions/batch/benchmark/contestants.h"
#include "missions/config/key_override.h"
#include "missions/config/resolve.h"

namespace skycap::missions::batch {

/// A mission as one of the contestants surveys it.
struct Setup {
  std::filesystem::path file;  ///< of the mission
  std::string title;           ///< in tables; setups of the same title have the same scene
  const batch::Contestant* contestant = nullptr;
  config::MissionSetup mission;
  std::string fingerprint;  ///< fingerprint_of() all this
  /// Keeps the scene's truth for other tasks; empty: nothing does.
  std::filesystem::path truth_file = {};

  /// Where the mission's relative paths start.
  std::filesystem::path folder() const { return file.parent_path(); }
};

/// See batch::trial_fingerprint().
std::string fingerprint_of(const Setup& setup);

/// A mission that was read already, by its own planner.
Setup own_setup(const std::filesystem::path& file, const config::MissionSetup& mission);

/// Reads a mission for a contestant; null: for its own planner. `origin` is what messages call the
/// choice of planners. Throws what config::read_mission() throws.
Setup read_setup(const std::filesystem::path& file, const batch::Contestant* contestant,
                 const std::string& origin, std::vector<config::KeyOverride> overrides,
                 const config::Report& report = {});

/// How the result of an item is kept.
enum class ItemForm {
  file,     ///< the record alone, in a folder that nobody else writes to
  folder,   ///< the record in a folder of its own, which one program at a time may fill
  package,  ///< and the mission package beside it
};

struct Item {
  std::shared_ptr<const Setup> setup;
  std::uint64_t seed = 0;
  std::filesystem::path record;  ///< of its result (benchmark/trial_files.h)
  ItemForm form = ItemForm::file;
};

}  // namespace skycap::missions::batch
