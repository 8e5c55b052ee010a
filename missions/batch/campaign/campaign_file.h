/// A campaign file: which missions are surveyed, by which planners, with which seeds and changes.
/// docs/reference/batch-files.md is the manual of the format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "missions/config/key_override.h"

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

/// Whether a name can stand in folders and tables: no hidden file, no other column.
bool is_plain(std::string_view name);

/// What to give instead, for messages.
inline constexpr std::string_view plain_names =
    "use at most 100 bytes without / \\ , \" | and no leading dot";

/// The name of a mission among the campaign's: its file's, without folder and ending.
std::string mission_title(const std::string& path);

/// Reads the file but none of the missions. Throws Error{bad_file} if it cannot be read, and
/// Error{bad_config}, "FILE:LINE: key KEY WHAT IS WRONG; what would be right".
CampaignFile read_campaign(const std::filesystem::path& file);

/// The same of a text; `name` stands for the file in messages.
CampaignFile parse_campaign(const std::string& text, const std::string& name);

}  // namespace skycap::missions::batch
