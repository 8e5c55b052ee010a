#include "missions/studio/child_job.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/error.h"

namespace skycap::missions::studio {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t max_lines = 5000;        ///< kept per job
constexpr std::size_t max_line_length = 4000;  ///< [byte]
constexpr std::size_t max_running = 4, max_kept = 100;
constexpr std::chrono::seconds time_to_save(5);

/// Runs in the child between fork and exec: system calls only.
[[noreturn]] void become_program(const char* program, char* const* arguments, const char* folder,
                                 int pipe, pid_t parent) {
  // An own process group: Ctrl-C on the terminal reaches the studio only, which passes it on.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGINT);  // the results are saved if the studio is killed
  if (::getppid() != parent) ::_exit(1);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing < 0 || ::dup2(nothing, STDIN_FILENO) < 0 || ::dup2(pipe, STDOUT_FILENO) < 0 ||
      ::dup2(pipe, STDERR_FILENO) < 0 || ::chdir(folder) != 0) {
    ::_exit(126);
  }
  ::close_range(STDERR_FILENO + 1, ~0U, 0);  // connections of the server
  ::execv(program, arguments);
  ::_exit(127);
}

}  // namespace

Job::Job(int id, JobRequest request)
    : id_(id), request_(std::move(request)), thread_([this] { run(); }) {}

Job::~Job() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

bool Job::is_running() const {
  const std::scoped_lock lock(mutex_);
  return is_running_;
}

void Job::cancel() {
  const std::scoped_lock lock(mutex_);
  const auto now = steady_clock::now();
  if (process_ > 0 && !is_cancelled_) ::kill(process_, SIGINT);
  if (process_ > 0 && is_cancelled_ && now > cancelled_at_ + time_to_save)
    ::kill(process_, SIGKILL);
  if (!is_cancelled_) cancelled_at_ = now;
  is_cancelled_ = true;
}

JobState Job::state(std::size_t first_line) const {
  const std::scoped_lock lock(mutex_);
  const auto end = is_running_ ? steady_clock::now() : end_;
  JobState state{.id = id_,
                 .title = request_.title,
                 .is_running = is_running_,
                 .exit_code = exit_code_,
                 .seconds = std::chrono::duration<double>(end - start_).count(),
                 .first_line = std::max(first_line, first_line_),
                 .lines = {}};
  for (std::size_t i = state.first_line - first_line_; i < lines_.size(); ++i) {
    state.lines.push_back(lines_[i]);
  }
  return state;
}

void Job::wait_for_line(std::size_t number, std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout,
                    [&] { return !is_running_ || first_line_ + lines_.size() > number; });
}

bool Job::wait(std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return !is_running_; });
}

void Job::add_line(std::string line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n')) line.pop_back();
  if (!request_.hidden_text.empty()) {
    for (std::size_t at = line.find(request_.hidden_text); at != std::string::npos;
         at = line.find(request_.hidden_text, at + request_.shown_text.size())) {
      line.replace(at, request_.hidden_text.size(), request_.shown_text);
    }
  }
  const std::scoped_lock lock(mutex_);
  lines_.push_back(std::move(line));
  if (lines_.size() > max_lines) lines_.pop_front(), ++first_line_;
  changed_.notify_all();
}

void Job::read_lines(int pipe) {
  std::string line;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t count = ::read(pipe, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    for (const char c : std::string_view(buffer.data(), static_cast<std::size_t>(count))) {
      if (c == '\n') {
        add_line(std::exchange(line, {}));
      } else if (line.size() < max_line_length) {
        line += c;
      }
    }
  }
  if (!line.empty()) add_line(std::move(line));
}

void Job::run() {
  const std::string program = request_.program.string();
  std::vector<char*> arguments{const_cast<char*>(program.c_str())};
  for (const std::string& word : request_.arguments)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  std::array<int, 2> ends{-1, -1};
  const pid_t parent = ::getpid();
  int status = 0;
  if (::pipe2(ends.data(), O_CLOEXEC) == 0) {
    const pid_t child = ::fork();
    if (child == 0)
      become_program(program.c_str(), arguments.data(), request_.folder.c_str(), ends[1], parent);
    ::close(ends[1]);
    {
      const std::scoped_lock lock(mutex_);
      process_ = child;
      if (is_cancelled_ && child > 0) ::kill(child, SIGINT);
    }
    if (child > 0) {
      read_lines(ends[0]);
      // The process stays a zombie until the lock is held, so that cancel() signals no other one.
      siginfo_t info{};
      while (::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT) != 0 &&
             errno == EINTR) {
      }
      const std::scoped_lock lock(mutex_);
      while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
      }
      process_ = -1;
    } else {
      status = 126 << 8;
      add_line("cannot start a process: " + std::generic_category().message(errno));
    }
    ::close(ends[0]);
  } else {
    status = 126 << 8;
    add_line("cannot create a pipe: " + std::generic_category().message(errno));
  }
  if (request_.at_end) request_.at_end();
  const std::scoped_lock lock(mutex_);
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  is_running_ = false;
  end_ = steady_clock::now();
  changed_.notify_all();
}

std::shared_ptr<Job> JobList::start(JobRequest request) {
  const std::scoped_lock lock(mutex_);
  std::size_t running = 0;
  for (const auto& job : jobs_) running += job->is_running() ? 1 : 0;
  if (running >= max_running) {
    throw Error(
        ErrorKind::bad_usage,
        std::to_string(running) + " commands are running; wait for one to finish, or cancel one");
  }
  if (jobs_.size() >= max_kept) {
    std::erase_if(jobs_, [first = jobs_.front()->id()](const std::shared_ptr<Job>& job) {
      return job->id() < first + static_cast<int>(max_kept) / 2 && !job->is_running();
    });
  }
  jobs_.push_back(std::make_shared<Job>(++last_id_, std::move(request)));
  return jobs_.back();
}

std::shared_ptr<Job> JobList::find(int id) const {
  const std::scoped_lock lock(mutex_);
  for (const auto& job : jobs_) {
    if (job->id() == id) return job;
  }
  return nullptr;
}

std::vector<JobState> JobList::states() const {
  const std::scoped_lock lock(mutex_);
  std::vector<JobState> states;
  for (const auto& job : jobs_) states.push_back(job->state(static_cast<std::size_t>(-1)));
  return states;
}

void JobList::cancel_all() {
  const std::scoped_lock lock(mutex_);
  for (const auto& job : jobs_) job->cancel();
  for (const auto& job : jobs_) {
    while (!job->wait(std::chrono::seconds(10))) job->cancel();
  }
}

}  // namespace skycap::missions::studio
