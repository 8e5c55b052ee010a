// Paths of requests below the page's token:
//
//     GET  /                        page; also /studio.js and /studio.css
//     GET  /api/state               folder, file to open, tokens, jobs
//     GET  /api/files               files of the work folder
//     GET  /api/package?path=       files of a results folder
//     GET  /api/progress?path=&from=&points=&stride= views and points of a survey that is being
//     planned, from its journal and preview
//     GET  /api/live?path=          status of a running live survey, and whether it is held
//     POST /api/live {path, held}   holds or resumes a live survey
//     GET  /api/schema              JSON Schema of mission files
//     GET  /api/mission?path=       text, version and values; version= : nothing if unchanged
//     POST /api/edit                {text, key, value}: text with the key set, and its values
//     POST /api/save                {path, text, version}: 409 if the file has changed
//     POST /api/uploads             {name, bytes, replace}: starts an upload; 409 if the file
//     exists POST /api/uploads/N?offset=   appends the content to the file POST /api/uploads/N/end
//     publishes the complete file POST /api/uploads/N/cancel POST /api/jobs {command, options,
//     draft}: starts a command GET  /api/jobs/N?from=        state and output lines of a job GET
//     /api/jobs/N/events       the same as server-sent events POST /api/jobs/N/cancel
//
// Below the token for files: GET /PATH, or /PATH?download=1.
#include "missions/studio/service.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/io/record_log.h"
#include "missions/config/mission_keys.h"
#include "missions/online/live/live_status.h"
#include "missions/simulation/survey_journal.h"
#include "missions/studio/command_table.h"
#include "missions/studio/mission_edit.h"
#include "missions/studio/page_parts.h"
#include "missions/version.h"

namespace skycap::missions::studio {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int max_streams = 16;                      ///< open event streams; each occupies a thread
constexpr std::chrono::seconds max_stream_time(60);  ///< the browser then reconnects

// The page loads nothing but its own parts, and no other page can show it in a frame.
constexpr const char* page_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; frame-src "
    "'self'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
// Files of the folder may come from anywhere. Their scripts run without access to the studio.
constexpr const char* file_policy =
    "sandbox allow-scripts allow-downloads allow-modals; connect-src 'none'; form-action 'none'; "
    "frame-ancestors 'self'";

HttpAnswer with_headers(HttpAnswer answer, const char* policy) {
  answer.headers.insert(answer.headers.end(), {{"Content-Security-Policy", policy},
                                               {"X-Content-Type-Options", "nosniff"},
                                               {"Referrer-Policy", "no-referrer"},
                                               {"Cache-Control", "no-store"},
                                               {"Cross-Origin-Resource-Policy", "same-origin"}});
  return answer;
}

/// Bytes that are not UTF-8 are replaced, because file names and outputs may contain any.
HttpAnswer json_answer(const Json& json, int status = 200) {
  return {.status = status,
          .body = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

HttpAnswer error_answer(int status, const std::string& message) {
  return json_answer({{"error", message}}, status);
}

HttpAnswer not_found() { return error_answer(404, "not found"); }

Json to_json(const std::vector<ListedFile>& files) {
  Json list = Json::array();
  for (const ListedFile& file : files)
    list.push_back({{"path", file.path}, {"kind", file.kind}, {"bytes", file.bytes}});
  return list;
}

Json to_json(const JobState& state) {
  Json json{{"id", state.id},
            {"title", state.title},
            {"running", state.is_running},
            {"seconds", state.seconds}};
  json["exit_code"] = state.exit_code ? Json(*state.exit_code) : Json();
  if (!state.lines.empty()) json["from"] = state.first_line, json["lines"] = state.lines;
  return json;
}

Json mission_json(const VersionedText& mission, const std::string& name) {
  Json json{{"path", name}, {"text", mission.text}, {"version", mission.version}};
  try {
    json["values"] = list_values(mission.text, name);
  } catch (const Error& error) {
    json["error"] = error.what();
  }
  return json;
}

/// Reads the records of a file of at most 64 MiB.
std::vector<std::string> read_progress(const fs::path& file) {
  constexpr std::uintmax_t max_bytes = std::uintmax_t{64} << 20;
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored) && fs::file_size(file, ignored) > max_bytes) {
    throw Error(ErrorKind::bad_file, file.string() + ": has more than 64 MiB");
  }
  return geometry::read_records(file).records;
}

/// Views in the journal of an interrupted or running survey, at most 500. There is no journal
/// before the first view and after the end.
Json survey_progress(const fs::path& results, std::size_t from) {
  constexpr std::size_t max_views = 500;
  Json views = Json::array();
  const std::vector<std::string> records = read_progress(results / simulation::journal_name);
  // The first record identifies the survey.
  for (std::size_t i = from + 1; i < records.size() && views.size() < max_views; ++i) {
    const Json record = geometry::parse_json<Json>(records[i]);
    views.push_back({{"position", record.at("position")},
                     {"direction", record.at("direction")},
                     {"points", record.at("points")}});
  }
  return {{"from", from}, {"views", std::move(views)}};
}

/// Points in the preview of a survey that is being planned, in millimetres, from number `from` on.
/// All points if the stride has changed. Empty without a preview.
Json survey_points(const fs::path& results, std::size_t from, std::size_t stride) {
  const std::vector<std::string> records = read_progress(results / simulation::preview_name);
  Json points = Json::array();
  if (records.empty()) return {{"stride", 0}, {"from", 0}, {"points", std::move(points)}};
  const auto present = geometry::parse_json<Json>(records[0]).at("stride").get<std::size_t>();
  if (present != stride) from = 0;
  std::size_t number = 0;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const auto record = geometry::parse_json<Json>(records[i]).get<std::vector<std::int64_t>>();
    for (std::size_t k = 0; k + 3 <= record.size(); k += 3, ++number) {
      if (number < from || number >= simulation::max_preview_points) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) points.push_back(record[k + axis]);
    }
  }
  return {{"stride", present}, {"from", from}, {"points", std::move(points)}};
}

/// Status of a live survey. A status file that is not written any more belongs to a killed program.
Json live_status(const WorkFolder& folder, const std::string& survey) {
  constexpr std::size_t max_status = std::size_t{1} << 20;
  constexpr std::chrono::seconds max_age(5);
  std::error_code failure;
  const fs::path file = folder.resolve(survey + "/" + online::status_name);
  const auto written = fs::last_write_time(file, failure);
  const bool is_running = !failure && fs::file_time_type::clock::now() - written < max_age;
  Json json{{"running", is_running},
            {"hold", fs::exists(folder.resolve(survey + "/" + online::hold_name))}};
  if (is_running)
    json["status"] = geometry::parse_json<Json>(geometry::read_file(file, max_status));
  return json;
}

std::string find_query(const HttpRequest& request, const std::string& name) {
  const auto found = request.query.find(name);
  return found == request.query.end() ? "" : found->second;
}

template <class Number>
std::optional<Number> to_number(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number)
                                                                  : std::nullopt;
}

std::string media_type(const fs::path& file) {
  constexpr std::array<std::pair<std::string_view, const char*>, 10> types{
      {{".html", "text/html; charset=utf-8"},
       {".json", "application/json"},
       {".txt", "text/plain; charset=utf-8"},
       {".md", "text/plain; charset=utf-8"},
       {".yaml", "text/plain; charset=utf-8"},
       {".csv", "text/plain; charset=utf-8"},
       {".png", "image/png"},
       {".jpg", "image/jpeg"},
       {".geojson", "application/json"},
       {".kmz", "application/vnd.google-earth.kmz"}}};
  const std::string extension = file.extension().string();
  for (const auto& [name, type] : types) {
    if (name == extension) return type;
  }
  return "application/octet-stream";
}

/// Returns a file name for a header: quotes, backslashes and other bytes are replaced.
std::string header_name(const fs::path& file) {
  std::string name = file.filename().string();
  for (char& c : name) {
    if (c < ' ' || c > '~' || c == '"' || c == '\\') c = '_';
  }
  return name;
}

/// Text field of a request. Throws nlohmann::json::exception if it is missing.
std::string text_of(const Json& json, const char* name) { return json.at(name).get<std::string>(); }

OptionValues read_options(const Json& json) {
  OptionValues values;
  for (const auto& [name, value] : json.items()) {
    std::vector<std::string>& list = values[name];
    if (value.is_array()) {
      for (const Json& item : value) list.push_back(item.get<std::string>());
    } else if (value.is_boolean()) {
      if (value.get<bool>()) list.emplace_back();
    } else {
      list.push_back(value.get<std::string>());
    }
  }
  return values;
}

}  // namespace

Service::Service(WorkFolder folder, fs::path program, std::string opened)
    : folder_(std::move(folder)),
      program_(std::move(program)),
      opened_(std::move(opened)),
      guard_(make_token(), make_token()),
      uploads_(folder_.path()) {}

std::optional<HttpAnswer> Service::reject(const HttpRequest& head) const {
  std::optional<HttpAnswer> rejection = guard_.reject(head);
  if (rejection) *rejection = with_headers(std::move(*rejection), page_policy);
  return rejection;
}

HttpAnswer Service::answer(const HttpRequest& request) {
  const std::size_t end = request.path.find('/', 1);
  const std::string path = end == std::string::npos ? "" : request.path.substr(end);
  const std::optional<Realm> realm = guard_.find_realm(request.path);
  try {
    if (!realm) return not_found();  // rejected before
    if (*realm == Realm::files) return with_headers(answer_file(path, request), file_policy);
    return with_headers(answer_page(path, request), page_policy);
  } catch (const Error& error) {
    return with_headers(error_answer(400, error.what()), page_policy);
  } catch (const nlohmann::json::exception&) {
    return with_headers(error_answer(400, "the request is not valid JSON for this function"),
                        page_policy);
  } catch (const std::exception& error) {
    return with_headers(error_answer(500, error.what()), page_policy);
  }
}

HttpAnswer Service::answer_page(const std::string& path, const HttpRequest& request) {
  if (path.empty()) return {.status = 303, .headers = {{"Location", request.path + "/"}}};
  if (path == "/") return {.type = "text/html; charset=utf-8", .body = std::string(page_html())};
  if (path == "/studio.css") return {.type = "text/css", .body = std::string(page_style())};
  if (path == "/studio.js")
    return {.type = "text/javascript; charset=utf-8", .body = std::string(page_script())};
  return request.method == "POST" ? answer_post(path, request) : answer_get(path, request);
}

HttpAnswer Service::answer_file(const std::string& path, const HttpRequest& request) const {
  const fs::path file = folder_.resolve(path.empty() ? "" : path.substr(1));
  std::error_code failure;
  if (!fs::is_regular_file(file, failure)) return not_found();
  HttpAnswer answer{.type = media_type(file), .file = file};
  if (request.query.contains("download")) {
    answer.headers.emplace_back("Content-Disposition",
                                "attachment; filename=\"" + header_name(file) + "\"");
  }
  return answer;
}

HttpAnswer Service::answer_get(const std::string& path, const HttpRequest& request) {
  if (path == "/api/state") {
    Json jobs = Json::array();
    for (const JobState& state : jobs_.states()) jobs.push_back(to_json(state));
    return json_answer({{"version", version},
                        {"folder", folder_.path().string()},
                        {"opened", opened_},
                        {"files", guard_.file_token()},
                        {"jobs", jobs}});
  }
  if (path == "/api/files") {
    const Listing listing = folder_.list();
    return json_answer({{"files", to_json(listing.files)}, {"complete", listing.is_complete}});
  }
  if (path == "/api/package")
    return json_answer({{"files", to_json(folder_.list_package(find_query(request, "path")))}});
  if (path == "/api/progress") {
    const fs::path results = folder_.resolve(find_query(request, "path"));
    if (!fs::is_directory(results)) return not_found();
    const auto number = [&](const char* name) {
      return to_number<std::size_t>(find_query(request, name)).value_or(0);
    };
    Json progress = survey_progress(results, number("from"));
    progress["preview"] = survey_points(results, number("points"), number("stride"));
    return json_answer(progress);
  }
  if (path == "/api/live") {
    const std::string survey = find_query(request, "path");
    require_live(survey);
    return json_answer(live_status(folder_, survey));
  }
  if (path == "/api/schema") return {.body = config::mission_json_schema()};
  if (path == "/api/mission") {
    const std::string name = find_query(request, "path");
    const VersionedText mission = folder_.read(name);
    if (mission.version == find_query(request, "version"))
      return json_answer({{"version", mission.version}});
    return json_answer(mission_json(mission, name));
  }
  constexpr std::string_view prefix = "/api/jobs/";
  if (!path.starts_with(prefix)) return not_found();
  const std::string rest = path.substr(prefix.size());
  const bool is_stream = rest.ends_with("/events");
  const std::optional<int> id = to_number<int>(rest.substr(0, rest.find('/')));
  const std::shared_ptr<Job> job = id ? jobs_.find(*id) : nullptr;
  if (!job) return not_found();
  if (is_stream) return stream_job(job);
  const std::optional<int> first = to_number<int>(find_query(request, "from"));
  return json_answer(to_json(job->state(static_cast<std::size_t>(std::max(0, first.value_or(0))))));
}

HttpAnswer Service::stream_job(const std::shared_ptr<Job>& job) {
  const std::shared_ptr<void> count(nullptr, [this](void*) { --streams_; });
  if (++streams_ > max_streams) return error_answer(503, "too many pages are open; close some");
  struct Progress {
    std::size_t next = 0;
    bool is_over = false;
    std::chrono::steady_clock::time_point end = std::chrono::steady_clock::now() + max_stream_time;
  };
  const auto progress = std::make_shared<Progress>();
  return {
      .type = "text/event-stream",
      .next_piece = [this, job, progress, count]() -> std::optional<std::string> {
        if (progress->is_over || is_stopped_ || std::chrono::steady_clock::now() > progress->end) {
          return std::nullopt;
        }
        job->wait_for_line(progress->next, std::chrono::seconds(1));
        const JobState state = job->state(progress->next);
        progress->next = state.first_line + state.lines.size();
        progress->is_over = !state.is_running;
        return "data: " +
               to_json(state).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
               "\n\n";
      }};
}

HttpAnswer Service::answer_post(const std::string& path, const HttpRequest& request) {
  if (path == "/api/jobs") return start_job(request.body);
  if (path.starts_with("/api/uploads")) return answer_upload(path, request);
  if (path.starts_with("/api/jobs/") && path.ends_with("/cancel")) {
    const std::string rest = path.substr(std::string_view("/api/jobs/").size());
    const std::optional<int> id = to_number<int>(rest.substr(0, rest.find('/')));
    const std::shared_ptr<Job> job = id ? jobs_.find(*id) : nullptr;
    if (!job) return not_found();
    job->cancel();
    return json_answer(to_json(job->state(0)));
  }
  const Json json = Json::parse(request.body);
  if (path == "/api/live") {
    const std::string survey = text_of(json, "path");
    require_live(survey);
    const fs::path hold = folder_.resolve(survey + "/" + online::hold_name);
    if (json.at("held").get<bool>()) {
      geometry::write_file(hold, "The survey is held. Remove this file to resume it.\n");
    } else {
      fs::remove(hold);
    }
    return json_answer(live_status(folder_, survey));
  }
  if (path == "/api/edit") {
    std::string text = text_of(json, "text");
    const std::string key = text_of(json, "key");
    if (!key.empty()) text = with_key(text, key, text_of(json, "value"));
    return json_answer({{"text", text}, {"values", list_values(text, "mission")}});
  }
  if (path == "/api/save") {
    const std::string name = text_of(json, "path"), text = text_of(json, "text");
    try {
      return json_answer({{"version", folder_.save(name, text, text_of(json, "version"))}});
    } catch (const SaveConflict& conflict) {
      Json answer = mission_json(conflict.on_disk, name);
      answer["conflict"] = true;
      return json_answer(answer, 409);
    }
  }
  return not_found();
}

void Service::require_live(const std::string& name) const {
  if (!fs::is_regular_file(folder_.resolve(name) / online::live_journal_name))
    throw Error(ErrorKind::bad_usage, name + ": contains no live survey");
}

HttpAnswer Service::answer_upload(const std::string& path, const HttpRequest& request) {
  try {
    if (path == "/api/uploads") {
      const Json json = Json::parse(request.body);
      if (!json.at("bytes").is_number_unsigned())
        return error_answer(400, "the number of bytes must be an integer");
      const int id =
          uploads_.begin(folder_, text_of(json, "name"), json.at("bytes").get<std::uint64_t>(),
                         json.at("replace").get<bool>());
      return json_answer({{"id", id}}, 201);
    }
    const std::string rest = path.substr(std::string_view("/api/uploads/").size());
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::optional<int> id = to_number<int>(rest.substr(0, slash));
    const std::string action = rest.substr(slash);
    if (!id) return not_found();
    if (action.empty()) {
      const auto offset = to_number<std::uint64_t>(find_query(request, "offset"));
      if (!offset) return error_answer(400, "the piece of a file requires its offset");
      uploads_.add(*id, *offset, request.body);
      return json_answer({{"received", *offset + request.body.size()}});
    }
    if (action == "/end") return json_answer({{"path", uploads_.end(*id)}});
    if (action != "/cancel") return not_found();
    uploads_.cancel(*id);
    return json_answer({{"cancelled", *id}});
  } catch (const UploadConflict& conflict) {
    return json_answer({{"conflict", true}, {"path", conflict.name}}, 409);
  }
}

HttpAnswer Service::start_job(const std::string& body) {
  const Json json = Json::parse(body);
  const std::string command = text_of(json, "command");
  OptionValues options = read_options(json.value("options", Json::object()));
  JobRequest request{.program = program_, .folder = folder_.path()};
  request.title = shell_text(make_arguments(command, options, folder_));
  if (json.contains("draft")) {  // a mission text that has not been saved
    const std::string mission = options["mission"].at(0);
    const fs::path file = folder_.resolve(mission);
    // Next to the mission, because its file names are relative.
    const std::string name =
        "." + file.stem().string() + ".draft" + std::to_string(++drafts_) + ".yaml";
    const fs::path draft = file.parent_path() / name;
    geometry::write_file(draft, text_of(json, "draft"));
    request.at_end = [draft] {
      std::error_code ignored;
      fs::remove(draft, ignored);
    };
    request.arguments = {command, draft.lexically_relative(folder_.path()).string()};
    request.hidden_text = request.arguments[1];
    request.shown_text = mission;
  } else {
    request.arguments = make_arguments(command, options, folder_);
  }
  request.arguments.insert(request.arguments.end(), {"--progress", "plain"});
  return json_answer(to_json(jobs_.start(std::move(request))->state(0)), 201);
}

void Service::stop() {
  is_stopped_ = true;
  jobs_.cancel_all();
}

}  // namespace skycap::missions::studio
