/// Functions of the studio's page. Paths of requests below the page's token:
///
///     GET  /                        page; also /studio.js and /studio.css
///     GET  /api/state               folder, file to open, tokens, jobs
///     GET  /api/files               files of the work folder
///     GET  /api/package?path=       files of a results folder
///     GET  /api/schema              JSON Schema of mission files
///     GET  /api/mission?path=       text, version and values
///     POST /api/edit                {text, key, value}: text with the key set, and its values
///     POST /api/save                {path, text, version}: 409 if the file has changed
///     POST /api/jobs                {command, options, draft}: starts a command
///     GET  /api/jobs/N?from=        state and output lines of a job
///     GET  /api/jobs/N/events       the same as server-sent events
///     POST /api/jobs/N/cancel
///
/// Below the token for files: GET /PATH, or /PATH?download=1.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "missions/studio/child_job.h"
#include "missions/studio/http_interface.h"
#include "missions/studio/request_guard.h"
#include "missions/studio/work_folder.h"

namespace skycap::missions::studio {

class Service : public RequestHandler {
 public:
  /// `program` is the executable whose commands the page runs. `opened` is the file that the page
  /// shows first, relative to the folder; may be empty.
  Service(WorkFolder folder, std::filesystem::path program, std::string opened);

  void set_port(int port) { guard_.set_port(port); }
  const RequestGuard& guard() const { return guard_; }
  const WorkFolder& folder() const { return folder_; }

  std::optional<HttpAnswer> reject(const HttpRequest& head) const override;
  HttpAnswer answer(const HttpRequest& request) override;

  /// Ends all streams and cancels the jobs, which save their results.
  void stop();

 private:
  HttpAnswer answer_page(const std::string& path, const HttpRequest& request);
  HttpAnswer answer_file(const std::string& path, const HttpRequest& request) const;
  HttpAnswer answer_get(const std::string& path, const HttpRequest& request);
  HttpAnswer answer_post(const std::string& path, const HttpRequest& request);
  HttpAnswer start_job(const std::string& body);
  HttpAnswer stream_job(const std::shared_ptr<Job>& job);

  WorkFolder folder_;
  std::filesystem::path program_;
  std::string opened_;
  RequestGuard guard_;
  JobList jobs_;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<int> streams_ = 0;  ///< open event streams
  std::atomic<int> drafts_ = 0;   ///< number of the last draft file
};

}  // namespace skycap::missions::studio
