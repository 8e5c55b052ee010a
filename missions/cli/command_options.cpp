#include "missions/cli/command_options.h"

#include "geometry/error.h"

namespace skycap::missions::cli {

std::vector<config::KeyOverride> KeyOptions::overrides() const {
  std::vector<config::KeyOverride> all;
  const auto add = [&](const char* option, const char* key, const std::string& value) {
    if (!value.empty()) all.push_back({option, key, value, true});
  };
  if (planner.ends_with(".so") || planner.ends_with(".py")) {
    add("--planner", "planner.name", "external");
    add("--planner", "planner.file", std::filesystem::absolute(planner).string());
  } else {
    add("--planner", "planner.name", planner);
  }
  add("--seed", "seed", seed);
  add("--threads", "threads", threads);
  add("--max-views", "limits.max_views", max_views);
  if (uses_prior_as_truth) add("--use-prior-as-truth", "scene.model", "prior");
  for (const std::string& pair : set) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos) {
      throw Error(ErrorKind::bad_usage,
                  "--set " + pair + ": missing '='; use KEY=VALUE, for example seed=2");
    }
    all.push_back({"--set " + pair, pair.substr(0, equals), pair.substr(equals + 1), true});
  }
  return all;
}

void add_set_option(CLI::App& command, KeyOptions& keys) {
  command
      .add_option(
          "--set", keys.set,
          "Set any key of the mission file: KEY=VALUE, for example planner.density=213; repeatable")
      ->type_size(1)
      ->allow_extra_args(false);
}

std::vector<CLI::Option*> add_task_options(CLI::App& command, TaskOptions& options,
                                           const std::string& item) {
  command.add_option("--chunk", options.chunk, "Number of " + item + "s per task (default: 1)")
      ->check(CLI::Range(1, 1'000'000));
  std::vector<CLI::Option*> all{
      command.add_option("--index", options.index,
                         "Run one task: 0-based index of the task, or slurm, mpi, kubernetes, "
                         "parallel or auto to read the index from the scheduler's environment"),
      command.add_flag("--collect", options.collects, "Merge completed results"),
      command
          .add_option("--submit", options.engine,
                      "Submit to slurm, parallel or mpi and write the job script")
          ->check(CLI::IsMember({"slurm", "parallel", "mpi"}))};
  for (CLI::Option* one : all) {
    for (CLI::Option* other : all) {
      if (one != other) one->excludes(other);
    }
  }
  return all;
}

CLI::Validator number_between(double min, double max) {
  const CLI::Range range(min, max);
  return {[range](std::string& text) {
            double number = 0.0;
            const bool is_number = CLI::detail::lexical_cast(text, number) && number == number;
            return is_number ? range(text) : text + " is not a number";
          },
          range.get_description()};
}

}  // namespace skycap::missions::cli
