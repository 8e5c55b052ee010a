#include "missions/session/python_planner.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/error.h"
#include "geometry/io/json.h"
#include "survey/planner.h"

namespace skycap::missions::session {

extern const char* const planner_host;  ///< text of planner_host.py

namespace {

using Json = nlohmann::ordered_json;
using survey::external::LoadedPlanner;

/// Process with a socket to its standard input and output.
class PythonProcess {
 public:
  PythonProcess() {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) fail();
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    // -I would hide the user's packages; -u keeps the order of printed lines.
    std::array<const char*, 5> arguments{"python3", "-u", "-c", planner_host, nullptr};
    const int error = ::posix_spawnp(&process_, arguments[0], &actions, nullptr,
                                     const_cast<char* const*>(arguments.data()), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    socket_ = ends[0];
    if (error != 0) {
      ::close(socket_);
      fail();
    }
  }
  PythonProcess(const PythonProcess&) = delete;
  PythonProcess& operator=(const PythonProcess&) = delete;
  ~PythonProcess() {
    ::close(socket_);
    ::kill(process_, SIGKILL);  // it has no results to save
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  void stop_on(const std::stop_token& stop) { stop_ = stop; }

  void send(const void* data, std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t count = ::send(socket_, at, size, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return;  // the process has ended; its last answer contains the reason
      at += count;
      size -= static_cast<std::size_t>(count);
    }
  }

  void receive(void* data, std::size_t size) {
    char* at = static_cast<char*>(data);
    while (size > 0) {
      if (stop_.stop_requested()) throw survey::Interrupted();
      pollfd wait{socket_, POLLIN, 0};
      constexpr int period = 100;  // of the check for stop requests [ms]
      if (stop_.stop_possible() && ::poll(&wait, 1, period) <= 0) continue;
      const ssize_t count = ::recv(socket_, at, size, 0);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) {
        throw Error(ErrorKind::bad_file,
                    "the Python process ended; install python3, or correct the planner");
      }
      at += count;
      size -= static_cast<std::size_t>(count);
    }
  }

 private:
  [[noreturn]] static void fail() {
    throw Error(ErrorKind::bad_file, "cannot start python3; install python3");
  }

  pid_t process_ = -1;
  int socket_ = -1;
  std::stop_token stop_;
};

class PythonPlanner final : public survey::OwnPlanner {
 public:
  PythonPlanner(const std::string& file, const survey::OwnPlannerTask& task) {
    const geometry::CameraConfig& camera = task.camera;
    Json fields{{"seed", task.seed},
                {"width", camera.width},
                {"height", camera.height},
                {"horizontal_fov", camera.horizontal_fov},
                {"vertical_fov", camera.vertical_fov},
                {"min_range", camera.min_range},
                {"max_range", camera.max_range},
                {"spacing", task.spacing},
                {"view_distance", task.view_distance},
                {"scene_box", Json()}};
    if (task.scene_box) {
      fields["scene_box"] = {numbers(task.scene_box->min()), numbers(task.scene_box->max())};
    }
    send({{"command", "make"}, {"file", file}, {"task", fields}});
    answer();
  }

  std::optional<geometry::View> next_view(const geometry::ScanSpan& scan,
                                          const geometry::PointCloud& cloud) override {
    const auto stored = std::span(cloud.positions).subspan(stored_);
    for (const Eigen::Vector3f& point : stored) box_.extend(point.cast<double>());
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = scan.world_from_sensor.linear();
    send({{"command", "next_view"},
          {"number", number_++},
          {"points", scan.points.size()},
          {"pixels", scan.pixels.size()},
          {"stored", stored.size()},
          {"low", numbers(box_.min())},
          {"high", numbers(box_.max())},
          {"position", numbers(scan.sensor_position())},
          {"rotation", std::vector<double>(rotation.data(), rotation.data() + rotation.size())}});
    process_.send(scan.points.data(), scan.points.size_bytes());
    process_.send(scan.pixels.data(), scan.pixels.size_bytes());
    process_.send(stored.data(), stored.size_bytes());
    stored_ = cloud.positions.size();
    return answer();
  }

  std::optional<geometry::View> next_alternative_view() override {
    send({{"command", "next_alternative_view"}});
    return answer();
  }

  void stop_on(const std::stop_token& stop) { process_.stop_on(stop); }
  double last_processor_time() const { return processor_time_; }

 private:
  static Json numbers(const Eigen::Vector3d& vector) {
    return {vector.x(), vector.y(), vector.z()};
  }

  void send(const Json& message) {
    const std::string text = message.dump();
    const std::uint64_t size = text.size();
    process_.send(&size, sizeof size);
    process_.send(text.data(), text.size());
  }

  std::optional<geometry::View> answer() {
    constexpr std::uint64_t max_size = 1 << 20;
    std::uint64_t size = 0;
    process_.receive(&size, sizeof size);
    if (size > max_size) throw Error(ErrorKind::bad_file, "the answer of the planner is too long");
    std::string text(size, ' ');
    process_.receive(text.data(), text.size());
    const Json json = geometry::parse_json<Json>(text);
    if (json.contains("error")) throw Error(ErrorKind::bad_file, json["error"].get<std::string>());
    processor_time_ = json.at("seconds").get<double>();
    if (json.at("view").is_null()) return std::nullopt;
    const auto view = json.at("view").get<std::array<double, 6>>();
    return geometry::View{{view[0], view[1], view[2]}, {view[3], view[4], view[5]}};
  }

  PythonProcess process_;
  std::size_t number_ = 0;
  std::size_t stored_ = 0;   ///< points of the cloud that the process has received
  Eigen::AlignedBox3d box_;  ///< bounding box of the cloud
  double processor_time_ = 0.0;
};

}  // namespace

LoadedPlanner load_python_planner(const std::string& file, const survey::OwnPlannerTask& task) {
  try {
    auto planner = std::make_unique<PythonPlanner>(file, task);
    PythonPlanner* const known = planner.get();
    return {.planner = std::move(planner),
            .processor_time_elsewhere = [known] { return known->last_processor_time(); },
            .stop_on = [known](const std::stop_token& stop) { known->stop_on(stop); }};
  } catch (const Error& error) {
    throw Error(ErrorKind::bad_file, file + ": " + error.what());
  }
}

}  // namespace skycap::missions::session
