#include "missions/cli/verb_options.h"

#include "geometry/error.h"

namespace skycap::missions::cli {

std::vector<config::KeyOverride> KeyOptions::overrides() const {
  std::vector<config::KeyOverride> all;
  const auto add = [&](const char* option, const char* key, const std::string& value) {
    if (!value.empty()) all.push_back({option, key, value});
  };
  add("--planner", "planner.name", planner);
  add("--seed", "seed", seed);
  add("--threads", "threads", threads);
  add("--max-views", "limits.max_views", max_views);
  add("--dry-run", "scene.model", dry_run);
  for (const std::string& pair : set) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos) {
      throw Error(ErrorKind::bad_usage,
                  "--set " + pair + ": has no '='; give KEY=VALUE, such as seed=2");
    }
    all.push_back({"--set " + pair, pair.substr(0, equals), pair.substr(equals + 1)});
  }
  return all;
}

void add_set_option(CLI::App& verb, KeyOptions& keys) {
  verb.add_option("--set", keys.set,
                  "KEY=VALUE: any key of the mission file, such as "
                  "planner.density=213; may be given again")
      ->type_size(1)
      ->allow_extra_args(false);
}

std::vector<CLI::Option*> add_task_options(CLI::App& verb, TaskOptions& options,
                                           const std::string& item) {
  verb.add_option("--chunk", options.chunk, "Of a task, so many " + item + "s; default 1")
      ->check(CLI::Range(1, 1'000'000));
  std::vector<CLI::Option*> all{
      verb.add_option("--index", options.index,
                      "Run one task: its number from 0 on, or slurm, mpi, kubernetes, parallel or "
                      "auto for the one that the engine's environment says"),
      verb.add_flag("--collect", options.collects, "Make the results of what is complete"),
      verb.add_option("--submit", options.engine,
                      "Have slurm, parallel or mpi run it; writes the job's script")
          ->check(CLI::IsMember({"slurm", "parallel", "mpi"}))};
  for (CLI::Option* one : all) {
    for (CLI::Option* other : all) {
      if (one != other) one->excludes(other);
    }
  }
  return all;
}

CLI::Validator number_between(double least, double most) {
  const CLI::Range range(least, most);
  return {[range](std::string& text) {
            double number = 0.0;
            const bool is_number = CLI::detail::lexical_cast(text, number) && number == number;
            return is_number ? range(text) : text + " is not a number";
          },
          range.get_description()};
}

}  // namespace skycap::missions::cli
