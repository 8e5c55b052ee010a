#include "missions/support/yaml_tree.h"

#include <cstddef>
#include <map>
#include <sstream>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include "geometry/error.h"

namespace skycap::missions::support {
namespace {

constexpr std::size_t deepest_nesting = 16;

/// Builds the tree from parser events. Unlike yaml-cpp nodes, it stores the line of every key,
/// detects duplicate keys, and never expands aliases.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& name) : name_(name) {}

  YamlNode take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    reject_anchor(mark, anchor);
    add(node_at(mark, YamlNode::Kind::null));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    fail(line_number(mark),
         "aliases ('*name') are not supported in mission files; write the value out");
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    reject_anchor(mark, anchor);
    const bool is_quoted = tag == "!";  // tag that the parser assigns to quoted scalars
    if (!is_quoted) reject_tag(mark, tag);
    YamlNode node = node_at(mark, YamlNode::Kind::scalar);
    node.text = value;
    node.is_quoted = is_quoted;
    add(std::move(node));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::list);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::map);
  }
  void OnMapEnd() override { close(); }

 private:
  /// List or map being parsed.
  struct Open {
    YamlNode node;
    bool awaits_value = false;         // whether the last key of the map has no value yet
    std::map<std::string, int> lines;  // lines of the map's keys, for fast detection of duplicates
  };

  [[noreturn]] void fail(int line, const std::string& what) const {
    throw Error(ErrorKind::bad_config, name_ + ":" + std::to_string(line) + ": " + what);
  }

  static int line_number(const YAML::Mark& mark) { return mark.line + 1; }

  static YamlNode node_at(const YAML::Mark& mark, YamlNode::Kind kind) {
    YamlNode node;
    node.kind = kind;
    node.line = line_number(mark);
    return node;
  }

  void reject_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) const {
    if (anchor == YAML::NullAnchor) return;
    fail(line_number(mark),
         "anchors ('&name') are not supported in mission files; remove the anchor");
  }

  void reject_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (tag.empty() || tag == "?") return;
    fail(line_number(mark),
         "tags ('" + tag + "') are not supported in mission files; remove the tag");
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            YamlNode::Kind kind) {
    reject_anchor(mark, anchor);
    reject_tag(mark, tag);
    if (open_.size() == deepest_nesting) {
      fail(line_number(mark),
           "lists and maps are nested more than 16 levels deep; a mission file has at most 3 "
           "levels");
    }
    open_.push_back({node_at(mark, kind), false, {}});
  }

  void close() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    add(std::move(node));
  }

  /// Adds a complete node to the innermost open list or map.
  void add(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
    } else if (open_.back().node.kind == YamlNode::Kind::list) {
      open_.back().node.items.push_back(std::move(node));
    } else if (open_.back().awaits_value) {
      open_.back().node.entries.back().value = std::move(node);
      open_.back().awaits_value = false;
    } else {
      add_key(node);
      open_.back().awaits_value = true;
    }
  }

  void add_key(const YamlNode& key) {
    if (key.kind != YamlNode::Kind::scalar) fail(key.line, "a key must be a plain scalar");
    constexpr std::size_t longest = 1000;
    if (key.text.size() > longest) fail(key.line, "a key has more than 1000 characters");
    const auto [same, is_new] = open_.back().lines.emplace(key.text, key.line);
    if (!is_new) {
      fail(key.line, "key " + key.text + " is set twice, first in line " +
                         std::to_string(same->second) + "; keep one");
    }
    open_.back().node.entries.push_back({key.text, key.line, {}});
  }

  const std::string& name_;
  YamlNode root_;
  std::vector<Open> open_;
};

}  // namespace

YamlNode parse_yaml(const std::string& text, const std::string& name) {
  std::istringstream stream(text);
  TreeBuilder builder(name);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    YamlNode root = builder.take_root();
    TreeBuilder rest(name);
    if (parser.HandleNextDocument(rest)) {
      throw Error(
          ErrorKind::bad_config,
          name + ":1: contains more than one YAML document; a mission is a single document");
    }
    return root;
  } catch (const YAML::Exception& failure) {
    const int line = failure.mark.is_null() ? 1 : failure.mark.line + 1;
    throw Error(ErrorKind::bad_config, name + ":" + std::to_string(line) + ": is not valid YAML (" +
                                           failure.msg +
                                           "); check the line's indentation, colons and brackets");
  }
}

}  // namespace skycap::missions::support
