/// Helpers for command-line options shared by several commands. Only sources that define options
/// include it, because it includes CLI11.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "missions/cli/commands.h"
#include "missions/cli/console.h"
#include "missions/cli/former_options.h"
#include "missions/config/mission_reader.h"

namespace skycap::missions::cli {

/// Command with parsed arguments, ready to run.
using Action = std::function<int()>;

/// Mission keys set by command-line options.
struct KeyOptions {
  std::string planner, seed, threads, max_views;
  bool uses_prior_as_truth = false;
  std::vector<std::string> set;  ///< entries of the form KEY=VALUE

  /// Returns the options as overrides. Throws Error{bad_usage} if an entry of `set` has no equals
  /// sign.
  std::vector<config::KeyOverride> overrides() const;
};

void add_set_option(CLI::App& command, KeyOptions& keys);

/// Adds the options of a command that processes items; `item` is the noun in the help. All options
/// except the chunk size are mutually exclusive. Returns the mutually exclusive options.
std::vector<CLI::Option*> add_task_options(CLI::App& command, TaskOptions& options,
                                           const std::string& item);

/// Returns a validator for numbers in a closed interval. Unlike CLI::Range, it rejects NaN.
CLI::Validator number_between(double min, double max);

/// Add commands whose options are defined in their own source files.
void add_site(CLI::App& app, const Console& console, Action& action);
void add_live(CLI::App& app, const Console& console, Action& action);
void add_campaign(CLI::App& app, const Console& console, Action& action);
void add_district(CLI::App& app, const Console& console, Action& action);
void add_model(CLI::App& app, const Console& console, Action& action);
void add_export(CLI::App& app, const Console& console, Action& action);
void add_init(CLI::App& app, const Console& console, Action& action);
void add_presets(CLI::App& app, const Console& console, Action& action);
void add_studio(CLI::App& app, const Console& console, Action& action);

/// Returns the input files that may contain mission keys.
template <class Options>
std::vector<std::filesystem::path> collect_files(const Options& options) {
  if constexpr (requires { options.missions; }) {
    return options.missions;
  } else if constexpr (requires { options.mission; }) {
    return {options.mission};
  } else if constexpr (requires { options.what; }) {
    return {options.what};
  } else if constexpr (requires { options.file; }) {
    return {options.file};
  } else {
    return {};
  }
}

/// Registers a callback that runs the command with the parsed options.
template <class Options>
void run(CLI::App& command, std::shared_ptr<Options> options,
         int (*run_command)(const Options&, const Console&), const Console& console,
         Action& action) {
  command.callback([=, &console, &action] {
    action = [=, &console] {
      warn_deprecated_names(collect_files(*options), {}, console);
      return run_command(*options, console);
    };
  });
}

/// Registers a callback as run() and passes mission-key options as overrides.
template <class Options>
void run_with_keys(CLI::App& command, std::shared_ptr<Options> options,
                   const std::shared_ptr<KeyOptions>& keys,
                   int (*run_command)(const Options&, const Console&), const Console& console,
                   Action& action) {
  command.callback([=, &console, &action] {
    options->overrides = keys->overrides();
    action = [=, &console] {
      warn_deprecated_names(collect_files(*options), options->overrides, console);
      return run_command(*options, console);
    };
  });
}

}  // namespace skycap::missions::cli
