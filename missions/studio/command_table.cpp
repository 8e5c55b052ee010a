#include "missions/studio/command_table.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "geometry/error.h"

namespace skycap::missions::studio {
namespace {

enum class ValueKind {
  text,
  path,    ///< file or folder in the work folder
  preset,  ///< name of a preset, or a file in the work folder
  flag,
  setting,  ///< KEY=VALUE of a variant, see `settings`
};

struct CommandOption {
  std::string_view name;  ///< positional arguments have no dashes
  ValueKind kind = ValueKind::text;
};

struct Command {
  std::string_view name;
  std::array<CommandOption, 16> options;  ///< unused ones have no name
};

using enum ValueKind;

constexpr std::array commands{
    Command{"site",
            {{{"map", path},
              {"--id", text},
              {"--at", text},
              {"--attribute", text},
              {"--crs", text},
              {"--vertical", text},
              {"--base", text},
              {"--height", text},
              {"--terrain", path},
              {"--obstacle", path},
              {"--vehicle", preset},
              {"--sensor", preset},
              {"--gsd", text},
              {"--out", path}}}},
    Command{"init",
            {{{"target", preset},
              {"--sensor", preset},
              {"--vehicle", preset},
              {"--gsd", text},
              {"--out", path}}}},
    Command{"check", {{{"mission", path}, {"--route", path}}}},
    Command{"plan",
            {{{"mission", path},
              {"--out", path},
              {"--max-views", text},
              {"--resume", flag},
              {"--use-prior-as-truth", flag},
              {"--planner", setting},
              {"--set", setting}}}},
    Command{"scan", {{{"mission", path}, {"--route", path}, {"--out", path}, {"--resume", flag}}}},
    Command{"evaluate",
            {{{"--cloud", path}, {"--mesh", path}, {"--model", preset}, {"--distance", text}}}},
    Command{"export",
            {{{"package", path},
              {"--format", text},
              {"--out", path},
              {"--route", path},
              {"--simplify", text},
              {"--repair", flag}}}},
    Command{"fly-test", {{{"package", path}, {"--flights", text}}}},
    Command{"view", {{{"what", path}, {"--out", path}, {"--background", path}}}},
    Command{"presets", {{{"--json", flag}}}}};

/// Variants of a mission. Other keys are set in the mission file, where the user sees them.
constexpr std::array<std::string_view, 12> settings{"flight.order=survey",
                                                    "flight.views=survey",
                                                    "flight.views=replanned",
                                                    "flight.style=stop",
                                                    "flight.style=fly-through",
                                                    "skycap",
                                                    "nadir",
                                                    "oblique",
                                                    "dome",
                                                    "facade",
                                                    "rings",
                                                    "corridor"};

bool is_preset_name(const std::string& value) {
  constexpr std::string_view permitted =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_:";
  return value.find_first_not_of(permitted) == std::string::npos;
}

/// Returns a value that cannot be taken for an option and names no file outside of the folder.
std::string checked_value(const CommandOption& option, const std::string& value,
                          const WorkFolder& folder) {
  const bool is_file = option.kind == path || (option.kind == preset && !is_preset_name(value));
  if (is_file) {
    folder.resolve(value);
    return value.starts_with('-') ? "./" + value : value;
  }
  if (option.kind == setting && std::ranges::find(settings, value) == settings.end()) {
    throw Error(ErrorKind::bad_usage, std::string(option.name) + ": unknown variant '" +
                                          value.substr(0, 100) + "'; set the key in the mission");
  }
  if (value.size() > 1000 || value.find('\0') != std::string::npos) {
    throw Error(ErrorKind::bad_usage,
                std::string(option.name) + " must have fewer than 1000 bytes");
  }
  return value;
}

}  // namespace

std::vector<std::string> make_arguments(const std::string& command, const OptionValues& values,
                                        const WorkFolder& folder) {
  const auto found = std::ranges::find(commands, command, &Command::name);
  if (found == commands.end()) {
    throw Error(ErrorKind::bad_usage, "unknown command '" + command + "'");
  }
  for (const auto& [name, ignored] : values) {
    if (std::ranges::find(found->options, name, &CommandOption::name) == found->options.end())
      throw Error(ErrorKind::bad_usage, command + ": unknown option '" + name + "'");
  }
  std::vector<std::string> arguments{command};
  for (const CommandOption& option : found->options) {
    if (option.name.empty()) break;
    const auto given = values.find(std::string(option.name));
    const bool is_positional = !option.name.starts_with("--");
    if (given == values.end() || given->second.empty()) {
      if (is_positional) {
        throw Error(ErrorKind::bad_usage,
                    command + ": missing argument: " + std::string(option.name));
      }
      continue;
    }
    for (const std::string& value : given->second) {
      if (option.kind == flag) {
        arguments.emplace_back(option.name);
        break;
      }
      const std::string checked = checked_value(option, value, folder);
      // "--id=-7" is one word, so that a value is never taken for an option.
      arguments.push_back(is_positional ? checked : std::string(option.name) + "=" + checked);
    }
  }
  return arguments;
}

std::string shell_text(const std::vector<std::string>& arguments) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./:,+=@%";
  std::string text = "skycap";
  for (const std::string& word : arguments) {
    text += ' ';
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += '\'';
  }
  return text;
}

}  // namespace skycap::missions::studio
