/// A map of a description file, such as a sensor's or a vehicle's, read key by key. Every key that
/// is asked for is known; the others are refused. Messages are "FILE:LINE: key KEY WHAT IS WRONG".
#pragma once

#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "missions/support/yaml_tree.h"

namespace skycap::missions::support {

/// As parse_yaml(), of a document that must be a map; `what` it describes, such as "a mission".
YamlNode parse_map(const std::string& text, const std::string& name, const std::string& what);

/// Refers to the tree and to the file's name, which must outlive it. Everything throws
/// Error{bad_config} if a key is missing that has no fallback, or of another type.
class YamlSection {
 public:
  /// `path` goes before the names of keys, such as "beam.".
  YamlSection(const YamlNode& node, std::string path, const std::string& file);

  std::optional<YamlSection> section(const std::string& key);
  std::vector<YamlSection> sections(const std::string& key);  ///< of a list; empty without the key

  bool has(const std::string& key) { return find(key) != nullptr; }
  double number(const std::string& key);
  double number(const std::string& key, double fallback);
  int integer(const std::string& key, int fallback);
  int integer(const std::string& key, int fallback, int least, int most);
  std::vector<double> numbers(const std::string& key);  ///< empty without the key
  std::string text(const std::string& key);
  std::string text(const std::string& key, const std::string& fallback);
  std::vector<std::string> texts(const std::string& key);  ///< of a list; empty without the key
  /// Of a map whose keys are not known beforehand; empty without the key.
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

  /// Refuses a value of a key, of `unit`, that is out of its range or not a number.
  void require_between(const std::string& key, double value, double least, double most,
                       const std::string& unit = "");

  /// Refuses keys that nobody asked for.
  void finish() const;

  /// Complains of a key where it stands, or of the section if it is missing.
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
