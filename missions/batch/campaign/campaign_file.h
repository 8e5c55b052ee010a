/// A campaign file: which missions are surveyed, by which planners, with which seeds and changes;
/// and its items, numbered. docs/reference/batch-files.md is the manual of the format.
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

/// Changes to missions, under one name.
struct Variant {
  std::string name;  ///< empty: the missions as `set` leaves them
  std::vector<config::KeyOverride> changes;
};

/// What an item leaves in its folder.
enum class ItemResults {
  figures,  ///< what tables and curves need
  package,  ///< the mission package, too
};

struct CampaignFile {
  std::string name;
  std::filesystem::path folder;            ///< where the missions' paths start
  std::vector<std::string> missions;       ///< as the file has them
  std::vector<std::string> planners = {};  ///< of batch::contestants(); empty: each its own
  std::size_t seeds = 10;
  std::uint64_t first_seed = 1;
  std::vector<Variant> variants = {{}};  ///< at least one; each with what `set` gives to all
  ItemResults results = ItemResults::figures;
};

/// No campaign has more items.
inline constexpr std::size_t most_items = 1'000'000;

/// Reads the file but none of the missions. Throws Error{bad_file} if it cannot be read, and
/// Error{bad_config}, "FILE:LINE: key KEY WHAT IS WRONG; what would be right".
CampaignFile read_campaign(const std::filesystem::path& file);

/// The same of a text; `name` stands for the file in messages.
CampaignFile parse_campaign(const std::string& text, const std::string& name);

/// Whether a name can stand in folders and tables: no hidden file, no other column.
bool is_plain(std::string_view name);

/// The key `name`, default the stem of `file`, which must be a name that is_plain().
std::string read_name(support::YamlSection& root, const std::string& file);

/// Keys that follow from the file that makes changes to missions, and what to give in their place.
struct FollowingKeys {
  std::vector<std::string> keys;  ///< one that ends with a dot stands for its section
  std::string instead;            ///< "the campaign; give ..."

  bool holds(const std::string& key) const;
};

/// The changes in `entries` of the file `file`, each key written out or nested as in a mission
/// file; `path`, such as "set.", goes before them in messages. Throws Error{bad_config},
/// "FILE:LINE: key KEY ...", for one that is unknown or `following`.
std::vector<config::KeyOverride> key_changes(const std::vector<support::YamlEntry>& entries,
                                             const std::string& path, const std::string& file,
                                             const FollowingKeys& following);

/// What the items of all seeds share.
struct ManifestEntry {
  std::string mission;  ///< path as the campaign has it
  std::string title;    ///< in tables and folders: the mission's, and the variant's behind a slash
  std::string planner;  ///< a contestant's name; empty: the mission's own
  const Variant* variant = nullptr;

  /// What progress tells apart, see batch::Setup.
  std::string kind() const { return title + " " + planner; }
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

/// Items [first, end) of a manifest.
struct ItemRange {
  std::size_t first = 0;
  std::size_t end = 0;

  std::size_t size() const { return end - first; }
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
  /// The numbers of a range that belong to an entry, ascending.
  std::vector<std::size_t> numbers_of_entry(std::size_t index, const ItemRange& range) const;

  /// manifest.jsonl: all lines.
  std::string text() const;

 private:
  std::size_t planners() const;

  CampaignFile file_;
};

}  // namespace skycap::missions::batch
