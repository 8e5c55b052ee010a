// Requests to skycap studio, its edits of mission files, and the update of former names.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "geometry/io/file.h"
#include "missions/config/former_names.h"
#include "missions/config/resolve.h"
#include "missions/studio/mission_edit.h"
#include "missions/studio/service.h"
#include "missions/support/journal_text.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"

namespace skycap::fuzz {
namespace {

namespace fs = std::filesystem;
namespace studio = missions::studio;

/// Removes the first line of a text, without its line end, and returns it.
std::string take_line(std::string& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string line = text.substr(0, end);
  text.erase(0, std::min(end + 1, text.size()));
  return line;
}

bool is_part_of(const std::string& path, const std::string& whole) {
  return path == whole || path.starts_with(whole + ".") || path.starts_with(whole + "[");
}

/// Sets a key of a mission: the key, its value and the mission's text. Other keys must not change.
int run_mission_edit(const std::uint8_t* bytes, std::size_t size) {
  std::string text = bytes_to_string(bytes, size);
  const std::string key = take_line(text), value = take_line(text);
  return run_reader("", [&] {
    const auto before = studio::list_values(text, "m.yaml");
    const auto after = studio::list_values(studio::with_key(text, key, value), "m.yaml");
    for (const auto& [path, old] : before) {
      if (is_part_of(path, key) || is_part_of(key, path)) continue;
      const auto found = after.find(path);
      require(found != after.end() && found->second == old, "another key changes: " + path);
    }
  });
}

/// Returns the text that identifies a mission.
std::string identity_of(const std::string& text) {
  const auto setup = missions::config::parse_mission(text, "m.yaml");
  return missions::support::identity_text(setup.identity(), nlohmann::ordered_json::object());
}

/// Replaces former names in a mission. The result must be the same mission.
int run_rewrite(const std::uint8_t* bytes, std::size_t size) {
  const std::string text = bytes_to_string(bytes, size);
  return run_reader("m.yaml", [&] {
    const std::string current = missions::config::with_current_names(text, "m.yaml");
    const std::string identity = identity_of(text);
    require(identity_of(current) == identity, "a mission that changes");
  });
}

/// Request in the notation of the corpus: METHOD PATH, then KEY=VALUE of the query, one per line,
/// an empty line and the body. TOKEN and FILES in the path are replaced by the tokens.
studio::HttpRequest parse_request(std::string text, const studio::RequestGuard& guard) {
  studio::HttpRequest request;
  const std::string head = take_line(text);
  const std::size_t blank = std::min(head.find(' '), head.size());
  request.method = head.substr(0, blank);
  request.path = head.substr(std::min(blank + 1, head.size()));
  for (const auto& [word, token] :
       {std::pair("TOKEN", guard.page_token()), std::pair("FILES", guard.file_token())}) {
    const std::size_t at = request.path.find(word);
    if (at != std::string::npos) request.path.replace(at, 5, token);
  }
  request.hosts = {"127.0.0.1:80"};
  request.origins = {"http://127.0.0.1:80"};
  while (!text.empty()) {
    const std::string line = take_line(text);
    if (line.empty()) break;
    const std::size_t middle = std::min(line.find('='), line.size());
    request.query[line.substr(0, middle)] = line.substr(std::min(middle + 1, line.size()));
  }
  request.content_type =
      request.query.contains("offset") ? "application/octet-stream" : "application/json";
  request.body = text;
  return request;
}

/// Answers requests, separated by lines "%", for a folder with a mission and a live survey. The
/// pseudo method FILE stores its body in a file, as other programs do. Other folders must not
/// change.
int run_studio(const std::uint8_t* bytes, std::size_t size) {
  const fs::path outside = fresh_folder(), folder = outside / "folder";
  fs::create_directories(folder / "survey");
  std::ofstream(outside / "kept") << "kept";
  std::ofstream(folder / "m.yaml") << "scene: {model: 'builtin:teapot'}\n";
  std::ofstream(folder / "survey/live.journal") << "";
  studio::Service service(studio::WorkFolder(folder), "/bin/true", "m.yaml");
  service.set_port(80);
  const std::string text = bytes_to_string(bytes, size);
  for (std::size_t at = 0, requests = 0; at < text.size() && requests < 8; ++requests) {
    const std::size_t end = std::min(text.find("\n%\n", at), text.size());
    studio::HttpRequest request = parse_request(text.substr(at, end - at), service.guard());
    at = std::min(end + 3, text.size());
    if (request.method == "FILE") {
      const fs::path name = fs::path(request.path).filename();
      if (!name.empty() && name.native().size() < 100) {
        std::ofstream(folder / "survey" / name, std::ios::binary) << request.body;
      }
      continue;
    }
    if (service.reject(request)) continue;
    const studio::HttpAnswer answer = service.answer(request);
    require(answer.status != 500, "an unexpected error: " + answer.body);
    if (!answer.file.empty()) {
      require(answer.file.native().starts_with(fs::canonical(folder).native() + "/"),
              "a file out of the folder: " + answer.file.string());
    }
  }
  service.stop();
  require(geometry::read_file(outside / "kept") == "kept", "another file changes");
  const auto count = std::distance(fs::directory_iterator(outside), fs::directory_iterator());
  require(count == 2, "a file in another folder");
  return 0;
}

constexpr Reader readers[] = {
    {"mission_edit", run_mission_edit}, {"rewrite", run_rewrite}, {"studio", run_studio}};

}  // namespace

std::span<const Reader> studio_readers() { return readers; }

}  // namespace skycap::fuzz
