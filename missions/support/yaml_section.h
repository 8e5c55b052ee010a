/// Reads a map of a description file, such as a sensor or vehicle description, key by key. Keys
/// that are never read are rejected by finish(). Messages have the form "FILE:LINE: key KEY WHAT IS
/// WRONG".
#pragma once

#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "missions/support/yaml_tree.h"

namespace skycap::missions::support {

/// Parses a document that must be a map, as parse_yaml(). `what` is its kind in messages, such as
/// "a mission".
YamlNode parse_map(const std::string& text, const std::string& name, const std::string& what);

/// Section of a YAML tree. The tree and the file name must outlive it. Member functions throw
/// Error{bad_config} if a key without a fallback is missing, or if a value has another type.
class YamlSection {
 public:
  /// `path` is the prefix of key names in messages, such as "beam.".
  YamlSection(const YamlNode& node, std::string path, const std::string& file);

  std::optional<YamlSection> section(const std::string& key);
  /// Returns the sections of a list of maps, or an empty list if the key is missing.
  std::vector<YamlSection> sections(const std::string& key);

  bool has(const std::string& key) { return find(key) != nullptr; }
  double number(const std::string& key);
  double number(const std::string& key, double fallback);
  int integer(const std::string& key, int fallback);
  int integer(const std::string& key, int fallback, int min, int max);
  /// Returns an empty list if the key is missing.
  std::vector<double> numbers(const std::string& key);
  std::string text(const std::string& key);
  std::string text(const std::string& key, const std::string& fallback);
  /// Returns a list of strings, or an empty list if the key is missing.
  std::vector<std::string> texts(const std::string& key);
  /// Returns the entries of a map with arbitrary keys, or an empty list if the key is missing.
  std::vector<YamlEntry> entries(const std::string& key);
  bool boolean(const std::string& key, bool fallback);

  template <typename Value>
  Value choice(const std::string& key,
               std::initializer_list<std::pair<const char*, Value>> choices) {
    const std::string given = text(key);
    std::string known;
    for (const auto& [name, value] : choices) {
      if (given == name) return value;
      known += (known.empty() ? "" : ", ") + std::string(name);
    }
    fail_at(key, "is " + given + "; it must be one of " + known);
  }

  /// Throws Error{bad_config} if a value, in `unit`, is out of range or NaN.
  void require_between(const std::string& key, double value, double min, double max,
                       const std::string& unit = "");

  /// Throws Error{bad_config} if the section contains a key that was not read.
  void finish() const;

  /// Throws Error{bad_config} with the line of the key, or of the section if the key is missing.
  [[noreturn]] void fail_at(const std::string& key, const std::string& what);

 private:
  const YamlNode* find(const std::string& key);
  double to_number(const YamlNode& value, const std::string& key) const;
  [[noreturn]] void fail(int line, const std::string& key, const std::string& what) const;

  const YamlNode& node_;
  std::string path_;
  const std::string& file_;
  std::set<std::string> asked_;
};

}  // namespace skycap::missions::support
