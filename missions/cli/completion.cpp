#include "missions/cli/completion.h"

#include <algorithm>
#include <vector>

#include <CLI/App.hpp>

namespace skycap::missions::cli {
namespace {

struct CompletedOption {
  std::string name;  ///< including its dashes
  std::string description;
  bool has_value = false;
};

/// Returns the long options of a command, including --help.
std::vector<CompletedOption> list_options(const CLI::App& command) {
  std::vector<CompletedOption> options;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      options.push_back(
          {"--" + name, option->get_description(), option->get_items_expected_max() > 0});
    }
  }
  return options;
}

std::vector<const CLI::App*> list_subcommands(const CLI::App& app) {
  return app.get_subcommands({});
}

/// Quotes a string for a shell with single quotes. Characters in `escaped` are prefixed with a
/// backslash.
std::string quoted(const std::string& text, const std::string& escaped = "") {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
      continue;
    }
    if (escaped.find(c) != std::string::npos) result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

std::string bash_script(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* command : list_subcommands(app)) {
    names += (names.empty() ? "" : " ") + command->get_name();
    std::string options;
    for (const CompletedOption& option : list_options(*command)) {
      options += (options.empty() ? "" : " ") + option.name;
    }
    cases += "    " + command->get_name() + ") options='" + options + "' ;;\n";
  }
  std::string own;
  for (const CompletedOption& option : list_options(app)) {
    own += (own.empty() ? "" : " ") + option.name;
  }
  return "# Bash completion for skycap: source <(skycap completion bash)\n"
         "_skycap() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} command= options='" +
         own +
         "' word\n"
         "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
         "    [[ $word == -* ]] || { command=$word; break; }\n"
         "  done\n"
         "  case $command in\n" +
         cases +
         "  esac\n"
         "  if [[ $current == -* ]]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$current\")\n"
         "  elif [[ -z $command ]]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W '" +
         names +
         "' -- \"$current\")\n"
         "  else\n"
         "    mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n"
         "    compopt -o filenames\n"
         "  fi\n"
         "}\n"
         "complete -F _skycap skycap ./skycap\n";
}

std::string zsh_script(const CLI::App& app) {
  const auto arguments = [](const CLI::App& command) {
    std::string text;
    for (const CompletedOption& option : list_options(command)) {
      const std::string spec = option.name + (option.has_value ? "=" : "") + "[" +
                               option.description + "]" + (option.has_value ? ":value:_files" : "");
      // Brackets and colons would end the description.
      const auto open = spec.find('['), close = spec.rfind(']');
      std::string description;
      for (const char c : spec.substr(open + 1, close - open - 1)) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') description += '\\';
        description += c;
      }
      text += " \\\n        " + quoted(spec.substr(0, open + 1) + description + spec.substr(close));
    }
    return text;
  };
  std::string names, cases;
  for (const CLI::App* command : list_subcommands(app)) {
    names += "    " + quoted(command->get_name() + ":" + command->get_description()) + "\n";
    cases += "    " + command->get_name() + ")\n      _arguments -s -S" + arguments(*command) +
             " \\\n        '*:file:_files' ;;\n";
  }
  return "#compdef skycap\n"
         "# Zsh completion for skycap: source <(skycap completion zsh), or save this as _skycap in "
         "a\n"
         "# folder of $fpath\n"
         "_skycap() {\n"
         "  local -a commands\n"
         "  commands=(\n" +
         names +
         "  )\n"
         "  if (( CURRENT == 2 )); then\n"
         "    _describe command commands\n"
         "    return\n"
         "  fi\n"
         "  local command=$words[2]\n"
         "  shift words\n"
         "  (( CURRENT-- ))\n"
         "  case $command in\n" +
         cases +
         "  esac\n"
         "}\n"
         "if [[ $funcstack[1] == _skycap ]]; then _skycap \"$@\"; else compdef _skycap skycap; "
         "fi\n";
}

std::string fish_script(const CLI::App& app) {
  std::string text = "# Fish completion for skycap: skycap completion fish | source\n";
  for (const CompletedOption& option : list_options(app)) {
    text += "complete -c skycap -n __fish_use_subcommand -l " + option.name.substr(2) + " -d " +
            quoted(option.description, "\\") + "\n";
  }
  for (const CLI::App* command : list_subcommands(app)) {
    const std::string name = command->get_name();
    text += "complete -c skycap -n __fish_use_subcommand -f -a " + name + " -d " +
            quoted(command->get_description(), "\\") + "\n";
    for (const CompletedOption& option : list_options(*command)) {
      text += "complete -c skycap -n '__fish_seen_subcommand_from " + name + "' -l " +
              option.name.substr(2) + (option.has_value ? " -r" : "") + " -d " +
              quoted(option.description, "\\") + "\n";
    }
  }
  return text;
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash_script(app);
  return shell == "zsh" ? zsh_script(app) : fish_script(app);
}

}  // namespace skycap::missions::cli
