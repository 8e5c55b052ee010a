#include "missions/config/former_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <utility>

#include "geometry/error.h"

namespace skycap::missions::config {
namespace {

using support::YamlEntry;
using support::YamlNode;

/// Former key in its current section, with its current last part. "[]" denotes list items.
struct FormerKey {
  std::string_view path, current;
};

constexpr auto former_keys = std::to_array<FormerKey>({
    {"planner.wanted_coverage", "target_coverage"},
    {"planner.least_gain", "min_gain"},
    {"planner.ideas", "ablation"},
    {"planner.ablation.dose", "coverage_model"},
    {"evaluation.registration_distance", "coverage_distance"},
    {"evaluation.radius", "passage_radius"},
    {"evaluation.ceiling_views", "attainable_views"},
    {"limits.lowest_pitch_deg", "min_pitch_deg"},
    {"limits.highest_pitch_deg", "max_pitch_deg"},
    {"site.lowest_height", "min_height"},
    {"site.highest_height", "max_height"},
    {"site.no_fly[].bottom", "floor"},
    {"site.no_fly[].top", "ceiling"},
    {"flight.unknown_beside", "extra_unknown_boxes"},
    {"flight.free_without_return", "no_return_free_range"},
    {"flight.steepest_pad_deg", "max_pad_slope_deg"},
    {"flight.temperature", "battery_temperature"},
    {"flight.opening", "initial_pattern"},
    {"scan.orbit.lowest", "min_height"},
    {"scan.orbit.highest", "max_height"},
});

/// Former value of a key, given by the key's current path.
struct FormerValue {
  std::string_view path, former, current;
};

constexpr auto former_values = std::to_array<FormerValue>({
    {"planner.still_occluded", "put_off", "defer"},
    {"flight.views", "anew", "replanned"},
    {"flight.fleet_goal", "flown", "total_time"},
    {"flight.style", "pass", "fly-through"},
});

/// Replaced names as they appear in the file.
struct Replacement {
  int line = 1;
  std::string key, current_key;      ///< equal if the key is not former
  std::string value, current_value;  ///< both empty if the value is not former
};

/// Replaces former names in a tree and records the replacements.
class Renaming {
 public:
  explicit Renaming(const std::string& name) : name_(name) {}

  void rename(YamlNode& node, const std::string& path) {
    if (node.kind == YamlNode::Kind::scalar) rename_value(node, path);
    for (YamlNode& item : node.items) rename(item, path + "[]");
    for (YamlEntry& entry : node.entries) {
      const std::string prefix = path.empty() ? "" : path + ".";
      const std::string former = prefix + entry.key;
      const std::string current = current_path(former);
      const std::string key = entry.key;
      if (current != former) {
        // Keys in a former section are relative to the current section.
        entry.key = current.substr(prefix.size());
        require_single(node, entry, former, current);
        names_.push_back({entry.line, former, current});
        replaced_.push_back({entry.line, key, entry.key, "", ""});
      }
      rename(entry.value, current);
    }
  }

  void require_single(const YamlNode& map, const YamlEntry& entry, const std::string& former,
                      const std::string& current) const {
    const auto count = std::ranges::count(map.entries, entry.key, &YamlEntry::key);
    if (count < 2) return;
    throw Error(ErrorKind::bad_config, name_ + ":" + std::to_string(entry.line) + ": key " +
                                           former + " is now " + current +
                                           ", which is also set; remove one of them");
  }

  const std::string& name_;
  std::vector<FormerName> names_;
  std::vector<Replacement> replaced_;

 private:
  void rename_value(YamlNode& node, const std::string& path) {
    for (const FormerValue& known : former_values) {
      if (known.path != path || known.former != node.text) continue;
      names_.push_back({node.line, path + ": " + std::string(known.former),
                        path + ": " + std::string(known.current)});
      replaced_.push_back({node.line, "", "", node.text, std::string(known.current)});
      node.text = known.current;
      return;
    }
  }
};

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
}

/// Returns the position of `word` as a whole word in `line`, from `begin`. A key must be followed
/// by a colon. Returns npos if it is not found.
std::size_t find_word(const std::string& line, const std::string& word, bool is_key,
                      std::size_t begin) {
  for (auto at = line.find(word, begin); at != std::string::npos; at = line.find(word, at + 1)) {
    auto end = at + word.size();
    if ((at > 0 && is_word(line[at - 1])) || (end < line.size() && is_word(line[end]))) continue;
    if (!is_key) return at;
    if (end < line.size() && (line[end] == '"' || line[end] == '\'')) ++end;
    while (end < line.size() && line[end] == ' ') ++end;
    if (end < line.size() && line[end] == ':') return at;
  }
  return std::string::npos;
}

bool are_equal(const YamlNode& a, const YamlNode& b) {
  return a.kind == b.kind && a.line == b.line && a.text == b.text && a.is_quoted == b.is_quoted &&
         std::ranges::equal(a.items, b.items, are_equal) &&
         std::ranges::equal(a.entries, b.entries, [](const YamlEntry& x, const YamlEntry& y) {
           return x.key == y.key && x.line == y.line && are_equal(x.value, y.value);
         });
}

/// Splits text into lines, including their line ends.
std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find('\n', at), text.size() - 1) + 1;
    lines.push_back(text.substr(at, end - at));
    at = end;
  }
  return lines;
}

}  // namespace

std::string current_path(std::string_view path) {
  std::string current;
  for (std::size_t at = 0; at <= path.size();) {
    const auto end = std::min(path.find('.', at), path.size());
    const std::string section = current.empty() ? "" : current + ".";
    current = section + std::string(path.substr(at, end - at));
    const auto known = std::ranges::find(former_keys, current, &FormerKey::path);
    if (known != former_keys.end()) current = section + std::string(known->current);
    at = end + 1;
  }
  return current;
}

std::string_view current_planner(std::string_view name) {
  return name == "omniscient" ? "oracle" : name;
}

std::vector<FormerName> replace_former_names(YamlNode& node, const std::string& path,
                                             const std::string& name) {
  Renaming renaming(name);
  renaming.rename(node, path);
  return std::move(renaming.names_);
}

std::vector<FormerName> replace_former_batch_names(YamlNode& node, const std::string& name) {
  Renaming renaming(name);
  const auto replace_planner = [&](YamlNode& planner) {
    const std::string current(current_planner(planner.text));
    if (planner.text == current) return;
    renaming.names_.push_back({planner.line, planner.text, current});
    planner.text = current;
  };
  for (YamlEntry& entry : node.entries) {
    if (entry.key == "together") {
      entry.key = "merge_distance";
      renaming.require_single(node, entry, "together", entry.key);
      renaming.names_.push_back({entry.line, "together", entry.key});
    } else if (entry.key == "planner") {
      replace_planner(entry.value);
    } else if (entry.key == "planners") {
      std::ranges::for_each(entry.value.items, replace_planner);
    } else if (entry.key == "set") {
      renaming.rename(entry.value, "");
    } else if (entry.key == "variants") {
      for (YamlEntry& variant : entry.value.entries) renaming.rename(variant.value, "");
    }
  }
  return std::move(renaming.names_);
}

std::vector<FormerName> former_names_in(std::span<const KeyOverride> overrides) {
  std::vector<FormerName> names;
  for (const KeyOverride& change : overrides) {
    const std::string current = current_path(change.path);
    if (current != change.path) names.push_back({1, change.path, current});
    YamlNode node = support::parse_yaml(change.value, change.origin);
    std::ranges::move(replace_former_names(node, current, change.origin),
                      std::back_inserter(names));
  }
  return names;
}

std::string with_current_names(const std::string& text, const std::string& name) {
  YamlNode expected = support::parse_yaml(text, name);
  if (expected.kind != YamlNode::Kind::map) {
    throw Error(ErrorKind::bad_config,
                name + ":1: is not a map; a mission must consist of 'key: value' lines");
  }
  Renaming renaming(name);
  renaming.rename(expected, "");
  std::vector<std::string> lines = split_lines(text);
  std::vector<std::size_t> begins(lines.size(), 0);  // start of the part not yet rewritten, by line
  for (const Replacement& one : renaming.replaced_) {
    const auto number = static_cast<std::size_t>(one.line) - 1;
    const bool is_key = one.value.empty();
    const std::string& former = is_key ? one.key : one.value;
    const std::string& current = is_key ? one.current_key : one.current_value;
    if (number >= lines.size()) continue;
    std::string& line = lines[number];
    const auto at = find_word(line, former, is_key, begins[number]);
    if (at == std::string::npos) continue;
    line.replace(at, former.size(), current);
    begins[number] = at + current.size();
  }
  std::string result;
  for (const std::string& line : lines) result += line;
  if (!are_equal(support::parse_yaml(result, name), expected)) {
    throw Error(ErrorKind::bad_config, name +
                                           ": cannot be rewritten, because keys of the same name "
                                           "are on one line; write each key on a separate line");
  }
  return result;
}

std::string to_string(std::span<const FormerName> names) {
  std::string text;
  for (const FormerName& name : names) {
    text += (text.empty() ? "" : ", ") + name.former + " is now " + name.current;
  }
  return text;
}

}  // namespace skycap::missions::config
