/// Campaign files specify missions, planners, seeds and changes to keys. Each combination is a
/// numbered item. docs/reference/batch-files.md documents the format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "missions/config/key_override.h"
#include "missions/support/yaml_section.h"

namespace skycap::missions::batch {

/// Named set of changes to mission keys.
struct Variant {
  std::string name;  ///< name of the variant; empty: missions with the changes of `set` only
  std::vector<config::KeyOverride> changes;
};

/// Files written for each item.
enum class ItemResults {
  figures,  ///< figures required for tables and curves
  package,  ///< figures and the mission package
};

struct CampaignFile {
  std::string name;
  std::filesystem::path folder;       ///< base folder of mission paths
  std::vector<std::string> missions;  ///< mission paths as in the file
  /// Names of batch::methods(); empty: the planner of each mission.
  std::vector<std::string> planners = {};
  std::size_t seeds = 10;
  std::uint64_t first_seed = 1;
  std::vector<Variant> variants = {{}};  ///< at least one; each includes the changes of `set`
  ItemResults results = ItemResults::figures;
};

/// Maximum number of items in a campaign.
inline constexpr std::size_t max_items = 1'000'000;

/// Reads a campaign file without reading its missions. Throws Error{bad_file} if it cannot be read.
/// Throws Error{bad_config} with "FILE:LINE: key KEY WHAT IS WRONG; what would be right".
CampaignFile read_campaign(const std::filesystem::path& file);

/// Parses a campaign from a string. `name` is the file name in messages. Throws Error{bad_config}
/// as read_campaign().
CampaignFile parse_campaign(const std::string& text, const std::string& name);

/// Returns whether a name is valid in folder names and tables: not a hidden file, and without
/// column separators.
bool is_plain(std::string_view name);

/// Returns the key `name`, or the stem of `file` if it is missing. The name must satisfy
/// is_plain().
std::string read_name(support::YamlSection& root, const std::string& file);

/// Mission keys that are set by a batch file and cannot be changed, and the suggested alternative.
struct FollowingKeys {
  std::vector<std::string> keys;  ///< key paths; a trailing dot denotes a whole section
  std::string alternative;        ///< suggestion in messages, "the campaign; give ..."

  bool contains(const std::string& key) const;
};

/// Reads changes to mission keys from `entries` of `file`. Keys may be full paths or nested as in a
/// mission file. `path`, such as "set.", is the prefix in messages. Throws Error{bad_config} with
/// "FILE:LINE: key KEY ..." for unknown keys and keys in `following`.
std::vector<config::KeyOverride> key_changes(const std::vector<support::YamlEntry>& entries,
                                             const std::string& path, const std::string& file,
                                             const FollowingKeys& following);

/// Properties shared by the items of all seeds.
struct ManifestEntry {
  std::string mission;  ///< mission path as in the campaign file
  /// Title in tables and folder names: mission title, then "/" and the variant's name.
  std::string title;
  std::string planner;  ///< name of a contestant; empty: the mission's planner
  const Variant* variant = nullptr;

  /// Returns the kind of survey for progress estimates, see batch::Setup.
  std::string kind() const { return title + " " + planner; }
};

/// Line of the manifest, which fully determines an item's result.
struct ManifestLine {
  std::size_t number = 0;
  ManifestEntry entry;
  std::uint64_t seed = 0;

  /// Returns the item's folder, relative to the campaign's results.
  std::filesystem::path folder() const;
  /// Returns the line as a JSON object without line breaks.
  std::string json() const;
};

/// Half-open range [first, end) of manifest items.
struct ItemRange {
  std::size_t first = 0;
  std::size_t end = 0;

  std::size_t size() const { return end - first; }
};

/// Numbered items of a campaign, from 0. Seeds form the outer loop, so that more seeds append items
/// without renumbering. An interrupted campaign thus contains trials of every combination. The
/// inner loops are missions and variants in file order, and planners in table order.
class Manifest {
 public:
  explicit Manifest(CampaignFile file) : file_(std::move(file)) {}
  Manifest(const Manifest&) = delete;  // entries contain pointers into this object
  Manifest& operator=(const Manifest&) = delete;

  const CampaignFile& file() const { return file_; }
  std::size_t entries() const;
  std::size_t size() const { return entries() * file_.seeds; }

  ManifestEntry entry(std::size_t index) const;
  ManifestLine line(std::size_t number) const;
  /// Returns the numbers within a range that belong to an entry, in ascending order.
  std::vector<std::size_t> entry_run_numbers(std::size_t index, const ItemRange& range) const;

  /// Returns manifest.jsonl, with one line per item.
  std::string text() const;

 private:
  std::size_t planners() const;

  CampaignFile file_;
};

}  // namespace skycap::missions::batch
