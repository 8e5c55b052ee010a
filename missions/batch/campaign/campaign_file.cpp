#include "missions/batch/campaign/campaign_file.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/batch/benchmark/contestants.h"
#include "missions/batch/campaign/key_changes.h"
#include "missions/config/former_names.h"
#include "missions/support/key_text.h"
#include "missions/support/yaml_section.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;
using support::YamlSection;

constexpr std::size_t largest_file = std::size_t{16} << 20;  // [byte]; 100,000 missions
constexpr int most_of_a_list = 100'000;

/// Reads the keys of a campaign in the order of the manual.
class CampaignReader {
 public:
  CampaignReader(const support::YamlNode& root, const std::string& name)
      : root_(root, "", name), file_(name) {}

  CampaignFile read() {
    campaign_.folder = fs::path(file_).parent_path();
    read_name();
    read_missions();
    read_planners();
    campaign_.seeds = static_cast<std::size_t>(whole_number("seeds", 10, 1, most_of_a_list));
    campaign_.first_seed =
        static_cast<std::uint64_t>(whole_number("first_seed", 1, 0, 1'000'000'000));
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
  void read_name() {
    campaign_.name = root_.text("name", fs::path(file_).stem().string());
    if (!is_plain(campaign_.name)) {
      root_.fail_at("name", "is not a valid folder name; " + std::string(plain_names));
    }
  }

  void read_missions() {
    campaign_.missions = root_.texts("missions");
    if (campaign_.missions.empty()) {
      root_.fail_at("missions", "is missing or empty; list mission files");
    }
    std::map<std::string, std::string> path_of;
    for (const std::string& path : campaign_.missions) {
      const std::string title = mission_title(path);
      if (!is_plain(title)) {
        root_.fail_at("missions", path + " has a name that cannot be used in tables; " +
                                      std::string(plain_names));
      }
      const auto [known, is_new] = path_of.emplace(title, path);
      if (is_new) continue;
      root_.fail_at("missions", known->second + " and " + path +
                                    " have the same name; use files with different names");
    }
  }

  void read_planners() {
    try {
      for (const auto* contestant : batch::contestants_named(root_.texts("planners"))) {
        campaign_.planners.push_back(contestant->name);
      }
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::bad_usage) throw;  // which says where already
      root_.fail_at("planners", error.what());
    }
  }

  int whole_number(const std::string& key, int fallback, int least, int most) {
    const int number = root_.integer(key, fallback);
    if (number < least || number > most) {
      root_.fail_at(key, "is " + std::to_string(number) + "; it must be from " +
                             std::to_string(least) + " to " + std::to_string(most));
    }
    return number;
  }

  void read_variants() {
    const std::vector<config::KeyOverride> of_all = changes_in(root_.entries("set"), "set.");
    std::vector<Variant> variants;
    for (const support::YamlEntry& entry : root_.entries("variants")) {
      const std::string key = "variants." + entry.key;
      if (!is_plain(entry.key)) {
        fail(entry.line, key, "is not a valid folder name; " + std::string(plain_names));
      }
      if (entry.value.kind == support::YamlNode::Kind::list ||
          entry.value.kind == support::YamlNode::Kind::scalar) {
        fail(entry.line, key, "must be a map of mission keys");
      }
      Variant variant{entry.key, of_all};
      for (auto& change : changes_in(entry.value.entries, key + ".")) {
        variant.changes.push_back(std::move(change));
      }
      variants.push_back(std::move(variant));
    }
    if (variants.empty()) variants.push_back({"", of_all});
    campaign_.variants = std::move(variants);
  }

  std::vector<config::KeyOverride> changes_in(const std::vector<support::YamlEntry>& entries,
                                              const std::string& path) const {
    static const FollowingKeys following{
        {"name", "seed", "threads", "planner.name"},
        "the campaign; set its own name, planners, seeds or first_seed"};
    return key_changes(entries, path, file_, following);
  }

  void require_bounded() {
    const double items = static_cast<double>(campaign_.missions.size()) *
                         static_cast<double>(campaign_.variants.size()) *
                         static_cast<double>(std::max<std::size_t>(1, campaign_.planners.size())) *
                         static_cast<double>(campaign_.seeds);
    if (items <= static_cast<double>(most_items)) return;
    root_.fail_at("missions", "together with variants, planners and seeds more than " +
                                  std::to_string(most_items) + " runs; use fewer");
  }

  std::string place(int line) const { return file_ + ":" + std::to_string(line); }

  [[noreturn]] void fail(int line, const std::string& key, const std::string& what) const {
    throw Error(ErrorKind::bad_config, place(line) + ": key " + support::about_key(key, what));
  }

  YamlSection root_;
  const std::string& file_;
  CampaignFile campaign_;
};

}  // namespace

bool is_plain(std::string_view name) {
  const auto is_special = [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f ||
           std::string_view("/\\,\"|").find(c) != std::string_view::npos;
  };
  return !name.empty() && name.size() <= 100 && name.front() != '.' &&
         std::ranges::none_of(name, is_special);
}

std::string mission_title(const std::string& path) { return fs::path(path).stem().string(); }

CampaignFile parse_campaign(const std::string& text, const std::string& name) {
  support::YamlNode root = support::parse_yaml(text, name);
  if (root.kind != support::YamlNode::Kind::map) {
    throw Error(ErrorKind::bad_config, name + ":" + std::to_string(root.line) +
                                           ": is not a map; a campaign is a list of 'key: value'");
  }
  config::replace_former_batch_names(root, name);
  return CampaignReader(root, name).read();
}

CampaignFile read_campaign(const fs::path& file) {
  return parse_campaign(geometry::read_file(file, largest_file), file.string());
}

}  // namespace skycap::missions::batch
