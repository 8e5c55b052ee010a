#include "missions/cli/former_options.h"

#include <array>
#include <string_view>
#include <utility>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/config/former_names.h"
#include "missions/support/yaml_tree.h"

namespace skycap::missions::cli {
namespace {

struct FormerOption {
  std::string_view command, former, current;
};

constexpr auto former_options = std::to_array<FormerOption>({
    {"check", "--return-height", "--return-altitude"},
    {"fly-test", "--return-height", "--return-altitude"},
    {"next", "--on-way", "--en-route"},
    {"next", "--lens", "--intrinsics"},
    {"next", "--until", "--max-frames"},
    {"fly", "--lens", "--intrinsics"},
});

constexpr const char* until = "; version 0.3 will not accept former names";

}  // namespace

std::vector<std::string> with_current_options(std::vector<std::string> arguments,
                                              const Console& console) {
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    std::string& argument = arguments[i];
    for (const auto& [command, former, current] : former_options) {
      const bool is_whole = argument == former;
      if (arguments[0] != command ||
          !(is_whole || argument.starts_with(std::string(former) + "="))) {
        continue;
      }
      warn(console, std::string(former) + " is now " + std::string(current) + until);
      argument.replace(0, former.size(), current);
      break;
    }
    const bool is_parted =
        argument == "--dry-run" && i + 1 < arguments.size() && arguments[i + 1] == "prior";
    if (arguments[0] != "plan" || !(is_parted || argument == "--dry-run=prior")) continue;
    warn(console, std::string("--dry-run prior is now --use-prior-as-truth") + until);
    argument = "--use-prior-as-truth";
    if (is_parted) arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
  return arguments;
}

void warn_deprecated_names(std::span<const std::filesystem::path> files,
                           std::span<const config::KeyOverride> overrides, const Console& console) {
  constexpr std::size_t largest = std::size_t{16} << 20;  // of a campaign or district file [byte]
  for (const std::filesystem::path& file : files) {
    if (file.extension() != ".yaml" && file.extension() != ".yml") continue;
    try {
      support::YamlNode root =
          support::parse_yaml(geometry::read_file(file, largest), file.string());
      std::vector<config::FormerName> names =
          config::replace_former_batch_names(root, file.string());
      const bool is_mission = names.empty();
      if (is_mission) names = config::replace_former_names(root, "", file.string());
      if (names.empty()) continue;
      warn(console, file.string() + ":" + std::to_string(names.front().line) +
                        ": uses names of version 0.1: " + config::to_string(names) +
                        (is_mission ? "; skycap check " + file.string() +
                                          " --rewrite FILE writes a file with the current names"
                                    : "; use the current names") +
                        until);
    } catch (const Error&) {
      continue;  // the command reports that it is unreadable
    }
  }
  try {
    const auto names = config::former_names_in(overrides);
    if (!names.empty()) warn(console, "--set: " + config::to_string(names) + until);
  } catch (const Error&) {
    return;  // the command reports the error
  }
}

}  // namespace skycap::missions::cli
