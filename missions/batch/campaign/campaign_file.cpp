#include "missions/batch/campaign/campaign_file.h"

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/batch/benchmark/methods.h"
#include "missions/config/former_names.h"
#include "missions/config/mission_keys.h"
#include "missions/config/unknown_key.h"
#include "missions/support/flow_text.h"
#include "missions/support/key_text.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using support::YamlNode;
using support::YamlSection;

// [byte]; sufficient for 100,000 missions.
constexpr std::size_t largest_file = std::size_t{16} << 20;
constexpr int max_list_size = 100'000;

/// Description of valid names, for messages.
const std::string plain_names =
    "use at most 100 bytes, without / \\ , \" | and without a leading dot";

/// Returns the mission title: the stem of the mission file.
std::string mission_title(const std::string& path) { return fs::path(path).stem().string(); }

[[noreturn]] void fail(const std::string& file, int line, const std::string& key,
                       const std::string& what) {
  throw Error(ErrorKind::bad_config,
              file + ":" + std::to_string(line) + ": key " + support::about_key(key, what));
}

/// Reads the keys of a campaign in the order of the manual.
class CampaignReader {
 public:
  CampaignReader(const YamlNode& root, const std::string& name)
      : root_(root, "", name), file_(name) {}

  CampaignFile read() {
    campaign_.folder = fs::path(file_).parent_path();
    campaign_.name = read_name(root_, file_);
    read_missions();
    read_planners();
    campaign_.seeds = static_cast<std::size_t>(root_.integer("seeds", 10, 1, max_list_size));
    campaign_.first_seed =
        static_cast<std::uint64_t>(root_.integer("first_seed", 1, 0, 1'000'000'000));
    read_variants();
    if (root_.has("results")) {
      campaign_.results = root_.choice<ItemResults>(
          "results", {{"figures", ItemResults::figures}, {"package", ItemResults::package}});
    }
    root_.finish();
    require_bounded();
    return campaign_;
  }

 private:
  void read_missions() {
    campaign_.missions = root_.texts("missions");
    if (campaign_.missions.empty()) {
      root_.fail_at("missions", "is missing or empty; list mission files");
    }
    std::map<std::string, std::string> paths_by_title;
    for (const std::string& path : campaign_.missions) {
      const std::string title = mission_title(path);
      if (!is_plain(title)) {
        root_.fail_at("missions",
                      path + " must have a name that can be used in tables; " + plain_names);
      }
      const auto [known, is_new] = paths_by_title.emplace(title, path);
      if (is_new) continue;
      root_.fail_at("missions", known->second + " and " + path +
                                    " have the same name; use files with different names");
    }
  }

  void read_planners() {
    try {
      for (const auto* method : methods_by_name(root_.texts("planners"))) {
        if (!method->file.empty()) {
          root_.fail_at("planners", method->file.filename().string() +
                                        " is code, which campaigns do not execute; compare it "
                                        "with skycap benchmark --planners");
        }
        campaign_.planners.push_back(method->name);
      }
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::bad_usage) throw;  // already includes the location
      root_.fail_at("planners", error.what());
    }
  }

  void read_variants() {
    const std::vector<config::KeyOverride> common_overrides =
        changes_in(root_.entries("set"), "set.");
    std::vector<Variant> variants;
    for (const support::YamlEntry& entry : root_.entries("variants")) {
      const std::string key = "variants." + entry.key;
      if (!is_plain(entry.key)) {
        fail(file_, entry.line, key, "is not a valid folder name; " + plain_names);
      }
      if (entry.value.kind == YamlNode::Kind::list || entry.value.kind == YamlNode::Kind::scalar) {
        fail(file_, entry.line, key, "must be a map of mission keys");
      }
      Variant variant{entry.key, common_overrides};
      for (auto& change : changes_in(entry.value.entries, key + ".")) {
        variant.changes.push_back(std::move(change));
      }
      variants.push_back(std::move(variant));
    }
    if (variants.empty()) variants.push_back({"", common_overrides});
    campaign_.variants = std::move(variants);
  }

  std::vector<config::KeyOverride> changes_in(const std::vector<support::YamlEntry>& entries,
                                              const std::string& path) const {
    static const FollowingKeys following{
        {"name", "seed", "threads", "planner.name"},
        "the campaign; set name, planners, seeds or first_seed of the campaign instead"};
    return key_changes(entries, path, file_, following);
  }

  void require_bounded() {
    const double items = static_cast<double>(campaign_.missions.size()) *
                         static_cast<double>(campaign_.variants.size()) *
                         static_cast<double>(std::max<std::size_t>(1, campaign_.planners.size())) *
                         static_cast<double>(campaign_.seeds);
    if (items <= static_cast<double>(max_items)) return;
    root_.fail_at(
        "missions",
        "the number of runs (missions x variants x planners x seeds) exceeds the limit of " +
            std::to_string(max_items) + "; use fewer");
  }

  YamlSection root_;
  const std::string& file_;
  CampaignFile campaign_;
};

const std::string& named(const std::string& planner) {
  static const std::string own = "own";  // reserved, so no contestant has this name
  return planner.empty() ? own : planner;
}

/// Appends the changes in `entries`. `section` is the prefix of their keys.
void add_changes(const std::vector<support::YamlEntry>& entries, const std::string& section,
                 const std::string& path, const std::string& file, const FollowingKeys& following,
                 std::vector<config::KeyOverride>& changes) {
  for (const support::YamlEntry& entry : entries) {
    const std::string key = section + entry.key;
    if (following.contains(key)) {
      fail(file, entry.line, path + key, "follows from " + following.alternative);
    }
    if (config::find_key(key) != nullptr) {
      changes.push_back(
          {file + ":" + std::to_string(entry.line), key, support::flow_text(entry.value)});
    } else if (entry.value.kind == YamlNode::Kind::map) {
      add_changes(entry.value.entries, key + ".", path, file, following, changes);
    } else {
      fail(file, entry.line, path + key, config::unknown_key_message(key, config::mission_keys()));
    }
  }
}

}  // namespace

CampaignFile parse_campaign(const std::string& text, const std::string& name) {
  support::YamlNode root = support::parse_map(text, name, "a campaign");
  config::replace_former_batch_names(root, name);
  return CampaignReader(root, name).read();
}

CampaignFile read_campaign(const fs::path& file) {
  return parse_campaign(geometry::read_file(file, largest_file), file.string());
}

bool is_plain(std::string_view name) {
  const auto is_special = [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f ||
           std::string_view("/\\,\"|").find(c) != std::string_view::npos;
  };
  return !name.empty() && name.size() <= 100 && name.front() != '.' &&
         std::ranges::none_of(name, is_special);
}

std::string read_name(YamlSection& root, const std::string& file) {
  std::string name = root.text("name", fs::path(file).stem().string());
  if (!is_plain(name)) root.fail_at("name", "is not a valid folder name; " + plain_names);
  return name;
}

bool FollowingKeys::contains(const std::string& key) const {
  return std::ranges::any_of(keys, [&](const std::string& own) {
    return own == key || (own.ends_with('.') && key.starts_with(own));
  });
}

std::vector<config::KeyOverride> key_changes(const std::vector<support::YamlEntry>& entries,
                                             const std::string& path, const std::string& file,
                                             const FollowingKeys& following) {
  std::vector<config::KeyOverride> changes;
  add_changes(entries, "", path, file, following, changes);
  return changes;
}

fs::path ManifestLine::folder() const {
  return fs::path("items") / entry.title / named(entry.planner) / ("seed_" + std::to_string(seed));
}

std::string ManifestLine::json() const {
  Json set = Json::object();
  for (const config::KeyOverride& change : entry.variant->changes) set[change.path] = change.value;
  const Json line{{"item", number},
                  {"mission", entry.mission},
                  {"variant", entry.variant->name},
                  {"planner", named(entry.planner)},
                  {"seed", seed},
                  {"set", set},
                  {"folder", folder().generic_string()}};
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::size_t Manifest::planners() const { return std::max<std::size_t>(1, file_.planners.size()); }

std::size_t Manifest::entries() const {
  return file_.missions.size() * file_.variants.size() * planners();
}

ManifestEntry Manifest::entry(std::size_t index) const {
  const std::size_t entries_per_mission = file_.variants.size() * planners();
  const std::string& mission = file_.missions[index / entries_per_mission];
  const Variant& variant = file_.variants[index % entries_per_mission / planners()];
  const std::string title = mission_title(mission);
  return {.mission = mission,
          .title = variant.name.empty() ? title : title + "/" + variant.name,
          .planner = file_.planners.empty() ? "" : file_.planners[index % planners()],
          .variant = &variant};
}

ManifestLine Manifest::line(std::size_t number) const {
  return {number, entry(number % entries()), file_.first_seed + number / entries()};
}

std::vector<std::size_t> Manifest::entry_run_numbers(std::size_t index,
                                                     const ItemRange& range) const {
  std::vector<std::size_t> numbers;
  for (std::size_t round = range.first / entries(); round * entries() < range.end; ++round) {
    const std::size_t number = round * entries() + index;
    if (number >= range.first && number < range.end) numbers.push_back(number);
  }
  return numbers;
}

std::string Manifest::text() const {
  std::string lines;
  for (std::size_t number = 0; number < size(); ++number) lines += line(number).json() + "\n";
  return lines;
}

}  // namespace skycap::missions::batch
