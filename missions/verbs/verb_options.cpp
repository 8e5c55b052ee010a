#include "missions/verbs/verb_options.h"

#include "geometry/error.h"

namespace skycap::missions::verbs {

std::vector<file::KeyOverride> KeyOptions::overrides() const {
  std::vector<file::KeyOverride> all;
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

CLI::Validator number_between(double least, double most) {
  const CLI::Range range(least, most);
  return {[range](std::string& text) {
            double number = 0.0;
            const bool is_number = CLI::detail::lexical_cast(text, number) && number == number;
            return is_number ? range(text) : text + " is not a number";
          },
          range.get_description()};
}

}  // namespace skycap::missions::verbs
