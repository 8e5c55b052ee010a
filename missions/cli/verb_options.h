/// What the options of verbs share. For the source of command_line.h, and CLI11 with it.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "missions/cli/console.h"
#include "missions/cli/former_options.h"
#include "missions/cli/verbs.h"
#include "missions/config/mission_reader.h"

namespace skycap::missions::cli {

/// A verb that is ready to run, once the arguments are read.
using Action = std::function<int()>;

/// Values for keys of the mission file, as given by options.
struct KeyOptions {
  std::string planner, seed, threads, max_views;
  bool uses_prior_as_truth = false;
  std::vector<std::string> set;  ///< KEY=VALUE

  /// Throws Error{bad_usage} if one of `set` has no equals sign.
  std::vector<config::KeyOverride> overrides() const;
};

void add_set_option(CLI::App& verb, KeyOptions& keys);

/// Options of a verb whose work are items, which it calls `item`; all but the chunk exclude each
/// other. Returns those that do.
std::vector<CLI::Option*> add_task_options(CLI::App& verb, TaskOptions& options,
                                           const std::string& item);

/// A number between two others; unlike CLI::Range it takes no NaN for one.
CLI::Validator number_between(double least, double most);

/// Verbs whose options stand in their own sources: a first mission for a site or a model, presets,
/// live surveys (next, serve, finish, fly), campaigns, districts, models, exports.
void add_site(CLI::App& app, const Console& console, Action& action);
void add_live(CLI::App& app, const Console& console, Action& action);
void add_campaign(CLI::App& app, const Console& console, Action& action);
void add_district(CLI::App& app, const Console& console, Action& action);
void add_model(CLI::App& app, const Console& console, Action& action);
void add_export(CLI::App& app, const Console& console, Action& action);
void add_init(CLI::App& app, const Console& console, Action& action);
void add_presets(CLI::App& app, const Console& console, Action& action);

/// The files with keys that a verb is given.
template <class Options>
std::vector<std::filesystem::path> files_of(const Options& options) {
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

/// Makes the verb an action that runs it with the options that are given.
template <class Options>
void run(CLI::App& verb, std::shared_ptr<Options> options,
         int (*run_verb)(const Options&, const Console&), const Console& console, Action& action) {
  verb.callback([=, &console, &action] {
    action = [=, &console] {
      warn_of_former_names(files_of(*options), {}, console);
      return run_verb(*options, console);
    };
  });
}

/// The same with those that are keys of the mission file as its overrides.
template <class Options>
void run_with_keys(CLI::App& verb, std::shared_ptr<Options> options,
                   const std::shared_ptr<KeyOptions>& keys,
                   int (*run_verb)(const Options&, const Console&), const Console& console,
                   Action& action) {
  verb.callback([=, &console, &action] {
    options->overrides = keys->overrides();
    action = [=, &console] {
      warn_of_former_names(files_of(*options), options->overrides, console);
      return run_verb(*options, console);
    };
  });
}

}  // namespace skycap::missions::cli
