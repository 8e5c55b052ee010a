#include "missions/studio/work_folder.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/online/live/live_status.h"
#include "missions/support/sha256.h"

namespace skycap::missions::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_text = std::size_t{4} << 20;  ///< of a mission file [byte]
constexpr std::size_t max_listed = 2000;
constexpr int max_depth = 4;

struct Kind {
  std::string_view name;
  std::array<std::string_view, 13> extensions;
};
constexpr std::array kinds{
    Kind{"mission", {".yaml", ".yml"}},
    Kind{"map",
         {".gml", ".citygml", ".xml", ".json", ".geojson", ".kml", ".gpkg", ".shp", ".osm", ".dxf",
          ".tif", ".tiff", ".jp2"}},
    Kind{"model",
         {".obj", ".ply", ".stl", ".off", ".glb", ".gltf", ".dae", ".fbx", ".ifc", ".3ds"}},
    Kind{"cloud", {".las", ".laz", ".e57", ".pcd", ".xyz"}}};

std::string compute_version(const std::string& text) {
  return support::sha256(std::as_bytes(std::span(text)));
}

bool is_hidden(const fs::path& file) { return file.filename().string().starts_with('.'); }

std::string find_folder_kind(const fs::path& folder) {
  const auto has = [&](const char* name) {
    std::error_code ignored;
    return fs::exists(folder / name, ignored);
  };
  if (has("summary.json") || has("scan.json")) return "package";
  return has(online::live_journal_name) ? "live" : "";
}

bool is_within(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

}  // namespace

std::string find_kind(const fs::path& file) {
  const std::string extension = geometry::lower_extension(file);
  if (extension.empty()) return "";
  for (const Kind& kind : kinds) {
    if (std::ranges::find(kind.extensions, extension) != kind.extensions.end())
      return std::string(kind.name);
  }
  return "";
}

WorkFolder::WorkFolder(const fs::path& folder) {
  std::error_code failure;
  folder_ = fs::canonical(folder, failure);
  if (failure || !fs::is_directory(folder_)) {
    throw Error(ErrorKind::bad_file, folder.string() + ": is not a folder");
  }
}

fs::path WorkFolder::resolve(const std::string& relative) const {
  const auto fail = [&](const std::string& what) -> Error {
    return {ErrorKind::bad_usage,
            "path '" + relative + "' " + what + "; name a file in " + folder_.string()};
  };
  const bool has_control = std::ranges::any_of(
      relative, [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; });
  if (relative.empty() || relative.size() > 1000 || has_control) throw fail("is not a file name");
  const fs::path path(relative);
  if (path.is_absolute()) throw fail("is absolute");
  for (const fs::path& part : path) {
    if (part == ".") continue;
    if (is_hidden(part)) throw fail("has a part that begins with '.'");
  }
  std::error_code failure;
  const fs::path found = fs::weakly_canonical(folder_ / path, failure);
  if (failure || !is_within(found, folder_)) throw fail("is outside the folder");
  return found;
}

Listing WorkFolder::list() const {
  Listing listing;
  std::error_code failure;
  fs::recursive_directory_iterator at(folder_, fs::directory_options::skip_permission_denied,
                                      failure);
  std::size_t visited = 0;
  for (; !failure && at != fs::recursive_directory_iterator(); at.increment(failure)) {
    std::error_code ignored;
    const fs::path& path = at->path();
    const bool is_folder = at->is_directory(ignored) && !at->is_symlink(ignored);
    if (is_hidden(path) || at.depth() >= max_depth) at.disable_recursion_pending();
    if (is_hidden(path)) continue;
    std::string kind = is_folder ? find_folder_kind(path) : find_kind(path);
    if (is_folder && !kind.empty()) at.disable_recursion_pending();
    if (++visited > 10 * max_listed || listing.files.size() >= max_listed) {
      listing.is_complete = false;
      break;
    }
    if (kind.empty()) continue;
    const std::uintmax_t bytes = is_folder ? 0 : at->file_size(ignored);
    listing.files.push_back(
        {path.lexically_relative(folder_).string(), std::move(kind), ignored ? 0 : bytes});
  }
  std::ranges::sort(listing.files, {}, &ListedFile::path);
  return listing;
}

std::vector<ListedFile> WorkFolder::list_package(const std::string& package) const {
  std::vector<ListedFile> files;
  std::error_code failure;
  const fs::path folder = resolve(package);
  for (fs::recursive_directory_iterator at(folder, failure);
       !failure && at != fs::recursive_directory_iterator(); at.increment(failure)) {
    std::error_code ignored;
    if (is_hidden(at->path())) {
      at.disable_recursion_pending();
      continue;
    }
    if (!at->is_regular_file(ignored)) continue;
    files.push_back({at->path().lexically_relative(folder).string(), find_kind(at->path()),
                     at->file_size(ignored)});
    if (files.size() >= max_listed) break;
  }
  std::ranges::sort(files, {}, &ListedFile::path);
  return files;
}

VersionedText WorkFolder::read(const std::string& relative) const {
  std::string text = geometry::read_file(resolve(relative), max_text, max_text);
  std::string version = compute_version(text);
  return {std::move(text), std::move(version)};
}

std::string WorkFolder::save(const std::string& relative, const std::string& text,
                             const std::string& version) const {
  const fs::path file = resolve(relative);
  if (find_kind(file) != "mission") {
    throw Error(ErrorKind::bad_usage, relative + ": a mission file must end in .yaml");
  }
  VersionedText on_disk;
  if (fs::exists(file)) on_disk = read(relative);
  if (on_disk.version != version) throw SaveConflict{std::move(on_disk)};
  geometry::write_file(file, text);
  return compute_version(text);
}

}  // namespace skycap::missions::studio
