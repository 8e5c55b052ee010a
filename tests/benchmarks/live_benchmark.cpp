/// Benchmark of a survey through a socket. Measures the time that `skycap serve` needs from a depth
/// image to the next view and its path, and the growth of its memory.
///
///   live_benchmark SKYCAP [--width 1600] [--height 1200] [--density 60] [--threads 1] [--circles
///   N]
///
/// A box of 10 x 8 x 10 m stands on the ground. A vehicle measures each requested view with 3 mm
/// noise until the survey ends. With --circles, the mission has no vehicle and the sensor is
/// hand-held. After the last requested view, scans continue in circles around the box until there
/// are N scans. Wall-clock time is measured in the client, from the first byte of the message to
/// the last byte of the answer. CPU time is the server's time in that interval.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "clients/skycap_live.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"
#include "tests/benchmarks/processor_time.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace skycap;
using Eigen::Vector3d;

constexpr double horizontal_fov_deg = 60.0, vertical_fov_deg = 46.8, farthest = 60.0, unit = 0.001;

struct Options {
  std::string program;
  int width = 1600, height = 1200, density = 60, threads = 1;
  int circles = 0;  ///< total number of hand-held scans; 0 for a vehicle
};

std::string make_mission(const Options& options) {
  const std::string vehicle =
      "flight: {vehicle: m350_rtk, clearance: 2.0,\n"
      "         unknown_box: {min: [-6, -5, 0], max: [6, 5, 11]}}\n";
  return fmt::format(
      "name: box\n"
      "sensor: {{width: {}, height: {}, horizontal_fov_deg: {}, vertical_fov_deg: {},\n"
      "         max_range: {}}}\n"
      "planner: {{name: skycap, preset: building, density: {}, resolution_radius: 0.25,\n"
      "          view_distance: 14, scene_box: {{min: [-6, -5, 0.3], max: [6, 5, 11]}}}}\n"
      "start: {{position: [0, -20, 6], look_at: [0, 0, 5]}}\n"
      "evaluation: {{coverage_distance: 0.1}}\n{}",
      options.width, options.height, horizontal_fov_deg, vertical_fov_deg, farthest,
      options.density, options.circles > 0 ? "" : vehicle);
}

geometry::Camera make_camera(const Options& options) {
  constexpr double degree = M_PI / 180.0;
  geometry::CameraConfig config;
  config.width = options.width;
  config.height = options.height;
  config.horizontal_fov = horizontal_fov_deg * degree;
  config.vertical_fov = vertical_fov_deg * degree;
  return geometry::Camera(config);
}

/// Returns the depth along the optical axis to the box or the ground. Infinite if the ray hits
/// neither.
double compute_depth(const Vector3d& sensor, const Vector3d& ray) {
  const Vector3d low(-5.0, -4.0, 0.0), high(5.0, 4.0, 10.0);
  const Vector3d a = (low - sensor).cwiseQuotient(ray), b = (high - sensor).cwiseQuotient(ray);
  const double enters = a.cwiseMin(b).maxCoeff(), leaves = a.cwiseMax(b).minCoeff();
  if (enters > 0.0 && enters < leaves) return enters;
  return ray.z() < 0.0 ? -sensor.z() / ray.z() : INFINITY;
}

/// Returns the depth image from a pose, row by row.
std::vector<std::uint16_t> measure(const geometry::Camera& camera, const Eigen::Isometry3d& pose,
                                   std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 0.003);
  std::vector<std::uint16_t> image;
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      const Vector3d ray = pose.linear() * camera.ray({column, row});
      const double depth = compute_depth(pose.translation(), ray) + noise(random);
      image.push_back(depth < farthest ? static_cast<std::uint16_t>(depth / unit) : 0);
    }
  }
  return image;
}

/// Runs `skycap serve` in a separate process, from reading its address to its exit.
class Server {
 public:
  Server(const Options& options, const std::filesystem::path& folder)
      : pipe_(::popen(fmt::format("echo $$; exec {} serve {} --survey {} --port 0 --quiet "
                                  "--threads {}",
                                  options.program, (folder / "m.yaml").string(),
                                  (folder / "survey").string(), options.threads)
                          .c_str(),
                      "r"),
              &::pclose) {
    pid_ = std::stoi(line());
    address_ = line();
    ::clock_getcpuclockid(pid_, &clock_);
  }
  ~Server() { ::kill(pid_, SIGTERM); }

  const std::string& address() const { return address_; }
  double processor_time() const { return seconds_on(clock_); }

  /// Returns the current or (with another key) the peak memory use [MiB].
  int memory(const std::string& key = "VmRSS:") const {
    std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
    std::string word;
    long kibibytes = 0;
    while (status >> word && word != key) {
    }
    status >> kibibytes;
    return static_cast<int>(kibibytes / 1024);
  }

 private:
  std::string line() const {
    char text[256];
    if (std::fgets(text, sizeof text, pipe_.get()) == nullptr) {
      throw std::runtime_error("skycap serve has ended");
    }
    std::string line(text);
    return line.substr(0, line.find('\n'));
  }

  std::unique_ptr<FILE, decltype(&::pclose)> pipe_;
  std::string address_;
  pid_t pid_ = 0;
  clockid_t clock_ = 0;
};

Eigen::Isometry3d make_pose(const nlohmann::json& view) {
  const auto p = view.at("position").get<std::vector<double>>();
  const auto q = view.at("quaternion_xyzw").get<std::vector<double>>();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Vector3d(p[0], p[1], p[2]);
  pose.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
  return pose;
}

skycap_live::Pose to_rows(const Eigen::Isometry3d& pose) {
  skycap_live::Pose rows{};
  for (int i = 0; i < 12; ++i) rows[static_cast<std::size_t>(i)] = pose(i / 4, i % 4);
  return rows;
}

/// Returns a pose on a circle around the box. The angle and the height vary with `number`.
Eigen::Isometry3d place_on_circle(int number) {
  const double angle = 2.4 * number;
  const Vector3d position(18.0 * std::cos(angle), 18.0 * std::sin(angle), 4.0 + number % 8);
  return geometry::camera_pose(geometry::look_at(position, {0.0, 0.0, 5.0}));
}

struct Times {
  std::vector<double> wall, processor;

  static std::string text(std::vector<double> times) {
    std::ranges::sort(times);
    return fmt::format("{:.3f} s, worst {:.3f} s", times[times.size() / 2], times.back());
  }
};

void survey(const Options& options) {
  const testing_support::TemporaryFolder folder;
  folder.file("m.yaml", make_mission(options));
  const Server server(options, folder.path());
  skycap_live::Survey client(server.address());
  const geometry::Camera camera = make_camera(options);
  std::mt19937 random(1);
  Times times;
  nlohmann::json answer = nlohmann::json::parse(client.next());
  int scans = 0;
  while (!answer.at("view").is_null() || scans < options.circles) {
    const nlohmann::json& view = answer.at("view");
    const Eigen::Isometry3d pose = view.is_null() ? place_on_circle(scans) : make_pose(view);
    const std::vector<std::uint16_t> image = measure(camera, pose, random);
    client.next();  // wait until the HTML report of the previous scan has been written
    const double processor = server.processor_time(), wall = seconds_on(CLOCK_MONOTONIC);
    const std::string text =
        client.add_depth(image, options.width, options.height, unit, to_rows(pose));
    times.wall.push_back(seconds_on(CLOCK_MONOTONIC) - wall);
    times.processor.push_back(server.processor_time() - processor);
    answer = nlohmann::json::parse(text);
    if (answer.contains("warning")) throw std::runtime_error("a true pose was suspected: " + text);
    if (++scans > 10 && scans % 100 != 0) continue;
    const auto returns = image.size() - static_cast<std::size_t>(std::ranges::count(image, 0));
    std::printf("scan %d: %zu returns, %.3f s (processor %.3f s), %d points, %d MiB\n", scans,
                returns, times.wall.back(), times.processor.back(), answer.at("points").get<int>(),
                server.memory());
    std::fflush(stdout);
  }
  if (scans == 0) throw std::runtime_error("no view was asked for");
  std::printf("%d scans, %s: from message to path %s; processor %s; at most %d MiB\n", scans,
              answer.at("state").get<std::string>().c_str(), Times::text(times.wall).c_str(),
              Times::text(times.processor).c_str(), server.memory("VmHWM:"));
}

Options parse(int argc, char** argv) {
  Options options;
  std::map<std::string, int*> numbers{{"--width", &options.width},
                                      {"--height", &options.height},
                                      {"--density", &options.density},
                                      {"--circles", &options.circles},
                                      {"--threads", &options.threads}};
  if (argc < 2) throw std::runtime_error("name the program skycap");
  options.program = argv[1];
  for (int i = 2; i + 1 < argc; i += 2) *numbers.at(argv[i]) = std::atoi(argv[i + 1]);
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    survey(parse(argc, argv));
    return 0;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "live_benchmark: %s\n", failure.what());
    return 1;
  }
}
