#include "tests/fuzz/trial_run.h"

#include <algorithm>
#include <fstream>

#include "geometry/io/e57/pages.h"
#include "tests/fuzz/readers.h"
#include "tests/support/temporary_folder.h"

namespace skycap::fuzz {
namespace {

namespace fs = std::filesystem;

const fs::path& scratch() {
  static const testing_support::TemporaryFolder folder;
  return folder.path();
}

}  // namespace

fs::path fresh_folder() {
  const fs::path folder = scratch() / "fresh";
  fs::remove_all(folder);
  fs::create_directory(folder);
  return folder;
}

fs::path file_with(std::string_view name, std::string_view bytes) {
  const fs::path path = scratch() / name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

std::string sealed_e57(const std::string& pages) {
  std::string content;
  for (std::size_t begin = 0; begin < pages.size(); begin += geometry::e57::page_size) {
    content += pages.substr(begin, geometry::e57::page_content);
  }
  return geometry::e57::sealed(content);
}

std::vector<Reader> all_readers() {
  std::vector<Reader> all;
  for (const auto readers :
       {surface_readers(), route_readers(), table_readers(), prior_readers(), link_readers(),
        record_readers(), mission_readers(), studio_readers()}) {
    all.insert(all.end(), readers.begin(), readers.end());
  }
#ifdef SKYCAP_ROS2_READERS
  const auto ros2 = ros2_readers();
  all.insert(all.end(), ros2.begin(), ros2.end());
#endif
  return all;
}

Reader find_reader(std::string_view name) {
  const std::vector<Reader> all = all_readers();
  const auto found = std::ranges::find(all, name, &Reader::name);
  return found == all.end() ? Reader{} : *found;
}

}  // namespace skycap::fuzz
