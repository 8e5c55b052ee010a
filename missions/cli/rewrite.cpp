#include "missions/cli/rewrite.h"

#include <string>

#include "geometry/io/file.h"
#include "missions/config/former_names.h"
#include "missions/config/mission_reader.h"
#include "missions/support/yaml_tree.h"

namespace skycap::missions::cli {

int rewrite(const std::filesystem::path& mission, const std::filesystem::path& out,
            const Console& console) {
  constexpr std::size_t largest = 1 << 20;  // of a mission file [byte]
  const std::string file = mission.string();
  const std::string text = geometry::read_file(mission, largest);
  const std::string current = config::with_current_names(text, file);
  config::parse_mission_document(current, file);
  support::YamlNode root = support::parse_yaml(text, file);
  const auto names = config::replace_former_names(root, "", file);
  geometry::write_file(out, current);
  console.out << out.string() << ": "
              << (names.empty() ? "all names are current" : config::to_string(names)) << "\n"
              << std::flush;
  return 0;
}

}  // namespace skycap::missions::cli
