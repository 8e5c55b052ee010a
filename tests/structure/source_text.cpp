#include "tests/structure/source_text.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>
#include <string_view>
#include <utility>

namespace skycap::structure {
namespace {

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t line_at(const std::string& text, std::size_t offset) {
  return 1 + static_cast<std::size_t>(std::count(
                 text.begin(), text.begin() + static_cast<std::ptrdiff_t>(offset), '\n'));
}

/// Returns the end of a comment or quoted text that begins at `i`, or `i` if there is none.
std::size_t find_words_end(const std::string& text, std::size_t i) {
  const auto after = [&](std::string_view mark, std::size_t from) {
    const std::size_t found = text.find(mark, from);
    return found == std::string::npos ? text.size() : found + mark.size();
  };
  if (text.compare(i, 2, "//") == 0) return after("\n", i) - 1;
  if (text.compare(i, 2, "/*") == 0) return after("*/", i + 2);
  const bool is_line = i == 0 || text[i - 1] == '\n';
  if (is_line && text[i] == '#') return after("\n", i) - 1;
  const char before = i > 0 ? text[i - 1] : ' ';
  if (text[i] == '"' && before == 'R') {
    const std::size_t open = text.find('(', i);
    return after(")" + text.substr(i + 1, open - i - 1) + "\"", open);
  }
  const bool is_digit_mark = text[i] == '\'' && std::isalnum(static_cast<unsigned char>(before));
  if ((text[i] != '"' && text[i] != '\'') || is_digit_mark) return i;
  std::size_t end = i + 1;
  while (end < text.size() && text[end] != text[i]) end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

struct Arguments {
  std::size_t begin = 0;
  std::vector<std::string> texts;
};

/// Returns the arguments in each pair of parentheses, without nested ones.
std::vector<Arguments> argument_lists(const std::string& code) {
  struct Open {
    char bracket;
    std::size_t begin, argument;
    std::vector<std::string> texts;
  };
  std::vector<Open> open;
  std::vector<Arguments> lists;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const char c = code[i];
    if (c == '(' || c == '[' || c == '{') {
      open.push_back({c, i, i + 1, {}});
    } else if (!open.empty() && (c == ',' || c == ')' || c == ']' || c == '}')) {
      open.back().texts.push_back(code.substr(open.back().argument, i - open.back().argument));
      open.back().argument = i + 1;
      if (c == ',') continue;
      if (open.back().bracket == '(') {
        lists.push_back({open.back().begin, std::move(open.back().texts)});
      }
      open.pop_back();
    }
  }
  return lists;
}

/// Returns true if the argument draws a random number: a generator is passed to a distribution, or
/// called.
bool draws(const std::string& argument) {
  static const std::regex draw(R"(\w\((random|generator|engine|dice|draws?)\b\s*[,)])"
                               R"(|\b(random|generator|engine|dice|draws?)(\.\w+)?\s*\()");
  return argument.find('{') == std::string::npos && std::regex_search(argument, draw);
}

}  // namespace

std::string strip_comments(const std::string& text) {
  std::string code = text;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = find_words_end(text, i);
    for (std::size_t k = i; k < end; ++k) {
      if (code[k] != '\n') code[k] = ' ';
    }
    i = std::max(end, i + 1);
  }
  return code;
}

std::vector<std::string> unordered_draws(const std::filesystem::path& root,
                                         const std::vector<SourceFile>& sources) {
  std::vector<std::string> found;
  for (const SourceFile& source : sources) {
    const std::string code = strip_comments(read_text(root / source.path));
    for (const Arguments& list : argument_lists(code)) {
      if (std::ranges::count_if(list.texts, draws) < 2) continue;
      found.push_back(source.path + ":" + std::to_string(line_at(code, list.begin)));
    }
  }
  return found;
}

}  // namespace skycap::structure
