/// The items of a campaign, numbered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "missions/batch/campaign/campaign_file.h"

namespace skycap::missions::batch {

/// What the items of all seeds share.
struct ManifestEntry {
  std::string mission;  ///< path as the campaign has it
  std::string title;    ///< in tables and folders: the mission's, and the variant's behind a slash
  std::string planner;  ///< a contestant's name; empty: the mission's own
  const Variant* variant = nullptr;
};

/// A line of the manifest, which the item's result follows from.
struct ManifestLine {
  std::size_t number = 0;
  ManifestEntry entry;
  std::uint64_t seed = 0;

  /// Relative to the campaign's results.
  std::filesystem::path folder() const;
  /// One JSON object without line breaks: all but the entry's own file.
  std::string json() const;
};

/// Items from 0 on. Seeds are outermost: more seeds append items and renumber none, and whoever
/// stops early has some of everything. Then come missions and variants as in the file, and planners
/// as in tables.
class Manifest {
 public:
  explicit Manifest(CampaignFile file) : file_(std::move(file)) {}
  Manifest(const Manifest&) = delete;  // entries refer to it
  Manifest& operator=(const Manifest&) = delete;

  const CampaignFile& file() const { return file_; }
  std::size_t entries() const;
  std::size_t size() const { return entries() * file_.seeds; }

  ManifestEntry entry(std::size_t index) const;
  ManifestLine line(std::size_t number) const;

  /// manifest.jsonl: all lines.
  std::string text() const;

 private:
  std::size_t planners() const;

  CampaignFile file_;
};

}  // namespace skycap::missions::batch
