#include "missions/support/flow_text.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <fmt/format.h>

namespace skycap::missions::support {
namespace {

/// Returns a scalar without quotes if it is unambiguous, otherwise with quotes.
std::string scalar_text(const std::string& text, bool is_quoted) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '+' ||
           c == '-' || c == '/';
  };
  const auto is_alnum = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  const bool needs_quotes =
      is_quoted || !std::ranges::any_of(text, is_alnum) || !std::ranges::all_of(text, is_plain);
  return needs_quotes ? yaml_quoted(text) : text;
}

}  // namespace

std::string yaml_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') result += '\\';
    result += byte < 0x20 || byte == 0x7f ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
  }
  return result + "\"";
}

std::string flow_text(const YamlNode& node) {
  using Kind = YamlNode::Kind;
  if (node.kind == Kind::null) return "~";
  if (node.kind == Kind::scalar) return scalar_text(node.text, node.is_quoted);
  std::string inside;
  for (const YamlNode& item : node.items) {
    inside += (inside.empty() ? "" : ", ") + flow_text(item);
  }
  for (const YamlEntry& entry : node.entries) {
    inside += (inside.empty() ? "" : ", ") + yaml_quoted(entry.key) + ": " + flow_text(entry.value);
  }
  return node.kind == Kind::list ? "[" + inside + "]" : "{" + inside + "}";
}

}  // namespace skycap::missions::support
