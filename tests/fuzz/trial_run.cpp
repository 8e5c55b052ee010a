#include "tests/fuzz/trial_run.h"

#include <algorithm>
#include <fstream>

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

const Reader* find_reader(std::string_view name) {
  for (const auto readers :
       {surface_readers(), route_readers(), prior_readers(), mission_readers()}) {
    const auto found = std::ranges::find(readers, name, &Reader::name);
    if (found != readers.end()) return &*found;
  }
  return nullptr;
}

}  // namespace skycap::fuzz
