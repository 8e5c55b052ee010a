/// Commands of the program that run as child processes and outlive the page.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <sys/types.h>

namespace skycap::missions::studio {

struct JobRequest {
  std::filesystem::path program;       ///< executable
  std::vector<std::string> arguments;  ///< of the program, without its name
  std::filesystem::path folder;        ///< working folder
  std::string title;                   ///< command as shown on the page
  /// Text that is replaced in the output, such as the name of a temporary file; may be empty.
  std::string hidden_text, shown_text;
  std::function<void()> at_end;  ///< called once when the process has ended; may be empty
};

/// State of a job with the lines from a given number on.
struct JobState {
  int id = 0;
  std::string title;
  bool is_running = true;
  std::optional<int> exit_code;  ///< 128 + signal if a signal ended the process
  double seconds = 0.0;          ///< run time so far
  std::size_t first_line = 0;    ///< number of the first line in `lines`
  std::vector<std::string> lines;
};

class Job {
 public:
  Job(int id, JobRequest request);
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  ~Job();  ///< cancels the job and waits for it

  int id() const { return id_; }
  bool is_running() const;
  /// Sends SIGINT, upon which commands save their results. A second call sends SIGKILL, five
  /// seconds after the first at the earliest.
  void cancel();
  JobState state(std::size_t first_line) const;
  /// Waits until there is a line with this number, the job has ended, or `timeout` has passed.
  void wait_for_line(std::size_t number, std::chrono::milliseconds timeout) const;
  /// Waits for the end. Returns whether it has ended.
  bool wait(std::chrono::milliseconds timeout) const;

 private:
  void run();
  void read_lines(int pipe);
  void add_line(std::string line);

  int id_;
  JobRequest request_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  pid_t process_ = -1;  ///< -1 before the start and after the end
  bool is_cancelled_ = false, is_running_ = true;
  std::chrono::steady_clock::time_point cancelled_at_, end_;
  std::optional<int> exit_code_;
  std::size_t first_line_ = 0;
  std::deque<std::string> lines_;
  std::jthread thread_;  ///< last member: it uses the others
};

/// Jobs of one run of the studio, at most four at a time.
class JobList {
 public:
  /// Starts a job. Throws Error{bad_usage} if too many are running.
  std::shared_ptr<Job> start(JobRequest request);
  std::shared_ptr<Job> find(int id) const;  ///< null if the number is unknown
  std::vector<JobState> states() const;     ///< without lines
  /// Cancels all jobs and waits until they have saved their results.
  void cancel_all();

 private:
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Job>> jobs_;
  int last_id_ = 0;
};

}  // namespace skycap::missions::studio
