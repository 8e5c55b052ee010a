#include "missions/studio/mission_edit.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "geometry/error.h"
#include "missions/support/flow_text.h"
#include "missions/support/yaml_tree.h"

namespace skycap::missions::studio {
namespace {

using support::YamlEntry;
using support::YamlNode;

/// Returns a value in one line. Values inside lists and maps are quoted where their characters have
/// a meaning there.
std::string value_text(const YamlNode& node, bool is_nested = false) {
  using Kind = YamlNode::Kind;
  if (node.kind == Kind::null) return is_nested ? "~" : "";
  if (node.kind == Kind::scalar) {
    const bool needs_quotes =
        node.is_quoted ||
        (is_nested && node.text.find_first_of(",[]{}#:&*!|>'\"%@`") != node.text.npos);
    return needs_quotes ? support::yaml_quoted(node.text) : node.text;
  }
  std::string text;
  for (const YamlNode& item : node.items)
    text += (text.empty() ? "" : ", ") + value_text(item, true);
  for (const YamlEntry& entry : node.entries) {
    text += (text.empty() ? "" : ", ") + entry.key + ": " + value_text(entry.value, true);
  }
  return node.kind == Kind::list ? "[" + text + "]" : "{" + text + "}";
}

void collect(const YamlNode& node, const std::string& prefix,
             std::map<std::string, std::string>& values) {
  for (const YamlEntry& entry : node.entries) {
    const std::string path = prefix + entry.key;
    if (entry.value.kind == YamlNode::Kind::map) {
      collect(entry.value, path + ".", values);
    } else {
      values[path] = value_text(entry.value);
    }
  }
}

bool are_equal(const YamlNode& a, const YamlNode& b) {
  return a.kind == b.kind && a.text == b.text && a.is_quoted == b.is_quoted &&
         std::ranges::equal(a.items, b.items, are_equal) &&
         std::ranges::equal(a.entries, b.entries, [](const YamlEntry& x, const YamlEntry& y) {
           return x.key == y.key && are_equal(x.value, y.value);
         });
}

/// Equal maps regardless of the order of their keys, because an edit may insert a key anywhere.
YamlNode sorted(YamlNode node) {
  for (YamlNode& item : node.items) item = sorted(item);
  for (YamlEntry& entry : node.entries) entry.value = sorted(entry.value);
  std::ranges::sort(node.entries, {}, &YamlEntry::key);
  if (node.entries.empty() && node.kind == YamlNode::Kind::map) node.kind = YamlNode::Kind::null;
  return node;
}

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

YamlEntry* find_entry(YamlNode& node, const std::string& key) {
  const auto found = std::ranges::find(node.entries, key, &YamlEntry::key);
  return found == node.entries.end() ? nullptr : &*found;
}

/// Returns whether a key is the only one in its map.
bool is_only_entry(const YamlNode& root, const std::vector<std::string>& path) {
  const YamlNode* node = &root;
  for (std::size_t depth = 0; depth + 1 < path.size(); ++depth) {
    const auto found = std::ranges::find(node->entries, path[depth], &YamlEntry::key);
    if (found == node->entries.end()) return false;
    node = &found->value;
  }
  return node->entries.size() == 1 && node->entries[0].key == path.back();
}

/// Sets a value in the tree. nullopt removes the key.
void set_value(YamlNode& node, const std::vector<std::string>& path, std::size_t depth,
               const std::optional<YamlNode>& value) {
  YamlEntry* entry = find_entry(node, path[depth]);
  if (depth + 1 == path.size() && !value) {
    std::erase_if(node.entries, [&](const YamlEntry& each) { return each.key == path[depth]; });
    return;
  }
  if (entry == nullptr) {
    node.kind = YamlNode::Kind::map;
    entry = &node.entries.emplace_back(YamlEntry{path[depth], 1, {}});
  }
  if (depth + 1 == path.size()) {
    entry->value = *value;
  } else {
    set_value(entry->value, path, depth + 1, value);
  }
}

/// Value of a key in the text. A value may continue on further lines.
struct ValueRange {
  std::size_t begin = 0, end = 0;
  bool is_block = false;              ///< the value begins on the line after the key
  std::vector<std::string> comments;  ///< within the value, without "#" and spaces around
};

std::string trimmed_comment(const std::string& text, std::size_t begin, std::size_t end) {
  while (begin < end && (text[begin] == '#' || text[begin] == ' ')) ++begin;
  while (end > begin && (text[end - 1] == ' ' || text[end - 1] == '\r')) --end;
  return text.substr(begin, end - begin);
}

bool is_comment(const std::string& text, std::size_t at) {
  return text[at] == '#' && (at == 0 || text[at - 1] == ' ' || text[at - 1] == '\n');
}

/// Returns the position after a quoted string that begins at `at`.
std::size_t quote_end(const std::string& text, std::size_t at) {
  const char quote = text[at];
  for (++at; at < text.size() && text[at] != '\n'; ++at) {
    if (text[at] == '\\' && quote == '"') {
      ++at;
    } else if (text[at] == quote) {
      if (quote == '"' || at + 1 >= text.size() || text[at + 1] != quote) return at + 1;
      ++at;
    }
  }
  return std::min(at, text.size());
}

/// Returns the end of a list or map in brackets.
ValueRange find_flow(const std::string& text, std::size_t begin) {
  ValueRange range{.begin = begin, .end = begin, .comments = {}};
  int depth = 0;
  for (std::size_t at = begin; at < text.size(); ++at) {
    if (text[at] == '"' || text[at] == '\'') {
      at = quote_end(text, at) - 1;
    } else if (is_comment(text, at)) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      range.comments.push_back(trimmed_comment(text, at, end));
      at = end - 1;
    } else if (text[at] == '[' || text[at] == '{') {
      ++depth;
    } else if ((text[at] == ']' || text[at] == '}') && --depth == 0) {
      range.end = at + 1;
      return range;
    }
  }
  return range;
}

/// Returns the lines after `begin`, the end of the line of a key at the column `indent`, that
/// belong to the key.
ValueRange find_block(const std::string& text, std::size_t begin, std::size_t indent) {
  ValueRange range{.begin = begin, .end = begin, .is_block = true, .comments = {}};
  std::vector<std::string> comments;  // those after the last value belong to the next key
  for (std::size_t line = begin; line < text.size();) {
    const std::size_t end = std::min(text.find('\n', line + 1), text.size());
    const std::size_t first = std::min(text.find_first_not_of(" \r", line + 1), end);
    if (first < end && !is_comment(text, first)) {
      const std::size_t column = first - line - 1;
      if (column < indent || (column == indent && text[first] != '-')) break;
      range.end = end;
      range.comments.insert(range.comments.end(), comments.begin(), comments.end());
      comments.clear();
    }
    for (std::size_t at = first; at < end; ++at) {
      if (text[at] == '"' || text[at] == '\'') {
        at = quote_end(text, at) - 1;
      } else if (is_comment(text, at)) {
        auto& list = first < at ? range.comments : comments;
        list.push_back(trimmed_comment(text, at, end));
        break;
      }
    }
    line = end;
  }
  return range;
}

/// Returns the value that begins at `at`, which is not a space. `indent` is the column of the key.
ValueRange find_value(const std::string& text, std::size_t at, bool is_in_flow,
                      std::size_t indent) {
  const std::size_t line_end = std::min(text.find('\n', at), text.size());
  if (at == line_end || is_comment(text, at)) {
    if (is_in_flow) return {.begin = at, .end = at, .comments = {}};
    return find_block(text, line_end, indent);
  }
  if (text[at] == '[' || text[at] == '{') return find_flow(text, at);
  if (text[at] == '"' || text[at] == '\'')
    return {.begin = at, .end = quote_end(text, at), .comments = {}};
  std::size_t end = at;
  while (end < line_end && !is_comment(text, end)) {
    if (is_in_flow && (text[end] == ',' || text[end] == '}')) break;
    ++end;
  }
  while (end > at && (text[end - 1] == ' ' || text[end - 1] == '\r')) --end;
  return {.begin = at, .end = end, .comments = {}};
}

std::size_t line_start(const std::string& text, int line) {
  std::size_t at = 0;
  for (int i = 1; i < line && at != std::string::npos; ++i) {
    at = text.find('\n', at);
    if (at != std::string::npos) ++at;
  }
  return std::min(at, text.size());
}

/// Returns the position of "KEY:" in a line, or nullopt unless there is exactly one.
std::optional<std::size_t> find_key(const std::string& text, const YamlEntry& entry) {
  const std::size_t begin = line_start(text, entry.line);
  const std::size_t end = std::min(text.find('\n', begin), text.size());
  std::optional<std::size_t> found;
  for (std::size_t at = text.find(entry.key + ":", begin); at < end;
       at = text.find(entry.key + ":", at + 1)) {
    const bool is_word =
        at == begin || text[at - 1] == ' ' || text[at - 1] == '{' || text[at - 1] == ',';
    if (!is_word) continue;
    if (found) return std::nullopt;
    found = at;
  }
  return found;
}

bool is_in_flow(const std::string& text, std::size_t begin, std::size_t at) {
  return std::count(text.begin() + static_cast<std::ptrdiff_t>(begin),
                    text.begin() + static_cast<std::ptrdiff_t>(at),
                    '{') > std::count(text.begin() + static_cast<std::ptrdiff_t>(begin),
                                      text.begin() + static_cast<std::ptrdiff_t>(at), '}');
}

/// Replaces or removes the value of an existing key.
std::optional<std::string> replace_value(const std::string& text, const YamlEntry& entry,
                                         const std::string& value) {
  const std::optional<std::size_t> key = find_key(text, entry);
  if (!key) return std::nullopt;
  const std::size_t line = line_start(text, entry.line);
  const bool is_flow = is_in_flow(text, line, *key);
  std::size_t begin = *key + entry.key.size() + 1;
  while (begin < text.size() && text[begin] == ' ') ++begin;
  const ValueRange range = find_value(text, begin, is_flow, *key - line);
  std::size_t end = range.end;
  if (!value.empty()) {
    // Comments within the value are kept before the line, because the new value is one line.
    std::string comments;
    const std::string indent(is_flow ? text.find_first_not_of(' ', line) - line : *key - line, ' ');
    for (const std::string& comment : range.comments) comments += indent + "# " + comment + "\n";
    const std::string before = text.substr(0, line) + comments;
    if (range.is_block) {
      const std::size_t colon = *key + entry.key.size() + 1;
      return before + text.substr(line, colon - line) + " " + value +
             text.substr(colon, range.begin - colon) + text.substr(end);
    }
    const std::string space = text[begin - 1] == ':' ? " " : "";
    return before + text.substr(line, begin - line) + space + value + text.substr(end);
  }
  if (!is_flow) {
    const std::size_t next = end < text.size() ? text.find('\n', end) : std::string::npos;
    return text.substr(0, line) + (next == std::string::npos ? "" : text.substr(next + 1));
  }
  begin = *key;
  while (end < text.size() && text[end] == ' ') ++end;
  if (end < text.size() && text[end] == ',') {
    ++end;
    while (end < text.size() && text[end] == ' ') ++end;
  } else {
    while (begin > 0 && (text[begin - 1] == ' ' || text[begin - 1] == ',')) --begin;
  }
  return text.substr(0, begin) + text.substr(end);
}

/// Returns missing sections and the key as block text, indented by `indent` spaces.
std::string block_text(const std::vector<std::string>& path, std::size_t depth, std::size_t indent,
                       const std::string& value) {
  std::string text;
  for (; depth < path.size(); ++depth, indent += 2) {
    text += std::string(indent, ' ') + path[depth] + ":";
    text += depth + 1 == path.size() ? " " + value + "\n" : "\n";
  }
  return text;
}

/// Inserts a missing key into the deepest existing section.
std::optional<std::string> insert_key(const std::string& text, YamlNode& root,
                                      const std::vector<std::string>& path,
                                      const std::string& value) {
  YamlEntry* section = nullptr;
  std::size_t depth = 0;
  for (YamlNode* node = &root; depth + 1 < path.size(); ++depth) {
    YamlEntry* const next = find_entry(*node, path[depth]);
    if (next == nullptr) break;
    section = next;
    node = &next->value;
  }
  if (section == nullptr) {
    const bool needs_line = !text.empty() && text.back() != '\n';
    return text + (needs_line ? "\n" : "") + block_text(path, 0, 0, value);
  }
  const std::optional<std::size_t> key = find_key(text, *section);
  if (!key) return std::nullopt;
  std::size_t begin = *key + section->key.size() + 1;
  while (begin < text.size() && text[begin] == ' ') ++begin;
  if (begin < text.size() && text[begin] == '{') {
    std::string flow = path.back() + ": " + value;
    for (std::size_t i = path.size() - 1; i-- > depth;) flow = path[i] + ": {" + flow + "}";
    const std::string comma = section->value.entries.empty() ? "" : ", ";
    return text.substr(0, begin + 1) + flow + comma + text.substr(begin + 1);
  }
  const std::size_t line = line_start(text, section->line);
  std::size_t indent = *key - line + 2;
  if (!section->value.entries.empty()) {
    const YamlEntry& first = section->value.entries.front();
    const std::optional<std::size_t> first_key = find_key(text, first);
    if (!first_key) return std::nullopt;
    indent = *first_key - line_start(text, first.line);
  }
  const std::size_t end = text.find('\n', begin);
  const std::string block = block_text(path, depth, indent, value);
  if (end == std::string::npos) return text + "\n" + block;
  return text.substr(0, end + 1) + block + text.substr(end + 1);
}

/// Parses one value in YAML notation.
YamlNode parse_value(const std::string& key, const std::string& value) {
  const bool is_line = value.find('\n') == std::string::npos;
  if (is_line) {
    const YamlNode node = support::parse_yaml("value: " + value + "\n", key);
    if (node.entries.size() == 1 && node.entries[0].value.kind != YamlNode::Kind::null)
      return node.entries[0].value;
  }
  throw Error(ErrorKind::bad_config, "key " + key + " must be one value in one line");
}

}  // namespace

std::map<std::string, std::string> list_values(const std::string& text, const std::string& name) {
  std::map<std::string, std::string> values;
  collect(support::parse_yaml(text, name), "", values);
  return values;
}

std::string with_key(const std::string& text, const std::string& key, const std::string& value) {
  std::vector<std::string> path = split_path(key);
  YamlNode root = support::parse_yaml(text, "mission");
  // A map that would be empty is removed, except the sections at the top.
  while (value.empty() && path.size() > 2 && is_only_entry(root, path)) path.pop_back();
  YamlNode expected = root;
  set_value(expected, path, 0,
            value.empty() ? std::nullopt : std::optional(parse_value(key, value)));
  const YamlEntry* entry = nullptr;
  YamlNode* node = &root;
  for (const std::string& part : path) {
    entry = node == nullptr ? nullptr : find_entry(*node, part);
    node = entry == nullptr ? nullptr : const_cast<YamlNode*>(&entry->value);
  }
  if (entry == nullptr && value.empty()) return text;
  const std::optional<std::string> edited =
      entry != nullptr ? replace_value(text, *entry, value) : insert_key(text, root, path, value);
  if (edited) {
    try {
      if (are_equal(sorted(support::parse_yaml(*edited, "mission")), sorted(expected)))
        return *edited;
    } catch (const Error&) {
      // reported below: the edit does not fit the layout of the file
    }
  }
  throw Error(ErrorKind::bad_config,
              "key " + key +
                  " cannot be changed in the form, because of the layout of the file; "
                  "edit the text");
}

}  // namespace skycap::missions::studio
