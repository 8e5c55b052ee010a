#include "missions/support/yaml_section.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "geometry/error.h"
#include "missions/support/key_text.h"

namespace skycap::missions::support {

YamlNode parse_map(const std::string& text, const std::string& name, const std::string& what) {
  YamlNode root = parse_yaml(text, name);
  if (root.kind == YamlNode::Kind::map) return root;
  throw Error(ErrorKind::bad_config, name + ":" + std::to_string(root.line) + ": is not a map; " +
                                         what + " must consist of 'key: value' lines");
}

YamlSection::YamlSection(const YamlNode& node, std::string path, const std::string& file)
    : node_(node), path_(std::move(path)), file_(file) {
  if (node.kind != YamlNode::Kind::map) {
    fail(node.line, path_.empty() ? "name" : path_.substr(0, path_.size() - 1),
         "must be a map of keys");
  }
}

std::optional<YamlSection> YamlSection::section(const std::string& key) {
  const YamlNode* value = find(key);
  if (value == nullptr) return std::nullopt;
  return YamlSection(*value, path_ + key + ".", file_);
}

std::vector<YamlSection> YamlSection::sections(const std::string& key) {
  const YamlNode* value = find(key);
  std::vector<YamlSection> result;
  if (value == nullptr) return result;
  if (value->kind != YamlNode::Kind::list) fail(value->line, path_ + key, "must be a list");
  for (std::size_t i = 0; i < value->items.size(); ++i) {
    result.emplace_back(value->items[i], path_ + key + "[" + std::to_string(i) + "].", file_);
  }
  return result;
}

double YamlSection::number(const std::string& key) {
  const YamlNode* value = find(key);
  if (value == nullptr) fail(node_.line, path_ + key, "is missing");
  return to_number(*value, path_ + key);
}

double YamlSection::number(const std::string& key, double fallback) {
  return has(key) ? number(key) : fallback;
}

int YamlSection::integer(const std::string& key, int fallback) {
  if (!has(key)) return fallback;
  const double value = number(key);
  if (value != std::round(value) || std::abs(value) > 1e9) {
    fail(find(key)->line, path_ + key, "must be an integer");
  }
  return static_cast<int>(value);
}

int YamlSection::integer(const std::string& key, int fallback, int min, int max) {
  const int value = integer(key, fallback);
  require_between(key, value, min, max);
  return value;
}

void YamlSection::require_between(const std::string& key, double value, double min, double max,
                                  const std::string& unit) {
  if (value >= min && value <= max) return;
  fail_at(key, fmt::format("is {:.10g}{}; it must be from {:.10g} to {:.10g}", value,
                           unit.empty() ? "" : " " + unit, min, max));
}

std::vector<double> YamlSection::numbers(const std::string& key) {
  const YamlNode* value = find(key);
  std::vector<double> result;
  if (value == nullptr) return result;
  if (value->kind != YamlNode::Kind::list) fail(value->line, path_ + key, "must be a list");
  for (const YamlNode& item : value->items) result.push_back(to_number(item, path_ + key));
  return result;
}

std::string YamlSection::text(const std::string& key) {
  const YamlNode* value = find(key);
  if (value == nullptr) fail(node_.line, path_ + key, "is missing");
  if (value->kind != YamlNode::Kind::scalar) fail(value->line, path_ + key, "must be a string");
  return value->text;
}

std::string YamlSection::text(const std::string& key, const std::string& fallback) {
  return has(key) ? text(key) : fallback;
}

std::vector<std::string> YamlSection::texts(const std::string& key) {
  const YamlNode* value = find(key);
  std::vector<std::string> result;
  if (value == nullptr) return result;
  if (value->kind != YamlNode::Kind::list) fail(value->line, path_ + key, "must be a list");
  for (const YamlNode& item : value->items) {
    if (item.kind != YamlNode::Kind::scalar) {
      fail(item.line, path_ + key, "must be a list of strings");
    }
    result.push_back(item.text);
  }
  return result;
}

std::vector<YamlEntry> YamlSection::entries(const std::string& key) {
  const YamlNode* value = find(key);
  if (value == nullptr) return {};
  if (value->kind != YamlNode::Kind::map) fail(value->line, path_ + key, "must be a map");
  return value->entries;
}

bool YamlSection::boolean(const std::string& key, bool fallback) {
  return has(key) ? choice<bool>(key, {{"true", true}, {"false", false}}) : fallback;
}

void YamlSection::finish() const {
  for (const YamlEntry& entry : node_.entries) {
    if (asked_.contains(entry.key)) continue;
    std::string known;
    for (const std::string& key : asked_) known += (known.empty() ? "" : ", ") + key;
    fail(entry.line, path_ + entry.key, "is unknown; expected one of: " + known);
  }
}

void YamlSection::fail_at(const std::string& key, const std::string& what) {
  const YamlNode* value = find(key);
  fail(value ? value->line : node_.line, path_ + key, what);
}

const YamlNode* YamlSection::find(const std::string& key) {
  asked_.insert(key);
  for (const YamlEntry& entry : node_.entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

double YamlSection::to_number(const YamlNode& value, const std::string& key) const {
  double result = 0.0;
  const char* const end = value.text.data() + value.text.size();
  const auto [stop, error] = std::from_chars(value.text.data(), end, result);
  if (value.kind != YamlNode::Kind::scalar || error != std::errc() || stop != end ||
      !std::isfinite(result)) {
    fail(value.line, key, "must be a number");
  }
  return result;
}

void YamlSection::fail(int line, const std::string& key, const std::string& what) const {
  throw Error(ErrorKind::bad_config,
              file_ + ":" + std::to_string(line) + ": key " + about_key(key, what));
}

}  // namespace skycap::missions::support
