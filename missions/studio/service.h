/// Answers the requests of the studio's page: files, missions and commands. The source lists the
/// paths.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "missions/studio/child_job.h"
#include "missions/studio/http_interface.h"
#include "missions/studio/request_guard.h"
#include "missions/studio/upload.h"
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
  /// Throws Error{bad_usage} if the folder contains no live survey.
  void require_live(const std::string& name) const;
  HttpAnswer answer_upload(const std::string& path, const HttpRequest& request);
  HttpAnswer start_job(const std::string& body);
  HttpAnswer stream_job(const std::shared_ptr<Job>& job);

  WorkFolder folder_;
  std::filesystem::path program_;
  std::string opened_;
  RequestGuard guard_;
  JobList jobs_;
  UploadList uploads_;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<int> streams_ = 0;  ///< open event streams
  std::atomic<int> drafts_ = 0;   ///< number of the last draft file
};

}  // namespace skycap::missions::studio
