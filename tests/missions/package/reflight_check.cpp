// Compares the coverage that a package prints for each of its route files with a simulated
// re-flight of the file, with noise from another seed: the captures as the interpreter reads them.
// A scanner measures along the trajectory in the CSV file.
// The arguments are package folders. Exit code 1 if a difference exceeds half a percentage point.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/export/export.h"
#include "flight/export/trajectory_file.h"
#include "flight/interpreter/interpret.h"
#include "geometry/angle.h"
#include "geometry/io/file.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/package.h"
#include "missions/simulation/measurement.h"

namespace skycap::missions {
namespace {

using Json = nlohmann::json;

constexpr double max_difference = 0.005;
constexpr std::uint64_t other_seed = 5;
constexpr double seconds_per_view = 10.0;

std::vector<session::ViewInFlight> captures_of(const std::filesystem::path& file,
                                               const flight::FlightFacts& facts) {
  const std::string content = geometry::read_file(file, flight::largest_route_file);
  const flight::Format format = flight::detect_format(file, content);
  const flight::InterpretedRoute route = flight::interpret(content, format, facts);
  std::vector<session::ViewInFlight> views;
  for (const flight::InterpretedStop& stop : flight::list_captures(content, format, route)) {
    views.push_back({.view = {stop.position, flight::compute_direction(
                                                 {geometry::radians_per_degree * stop.yaw_deg,
                                                  geometry::radians_per_degree * stop.pitch_deg})},
                     .time = seconds_per_view * static_cast<double>(views.size())});
  }
  return views;
}

/// Returns the scans along a trajectory, `period` [s] apart. A scanner at rest scans once.
std::vector<session::ViewInFlight> scans_along(const std::filesystem::path& file, double period,
                                               const geometry::ScannerMount& mount) {
  const std::vector<flight::TimedState> states =
      flight::read_trajectory_csv(geometry::read_file(file, flight::largest_route_file));
  const auto state_at = [&](double time) -> const flight::TimedState& {
    const auto after = std::ranges::lower_bound(states, time, {}, &flight::TimedState::time);
    return after == states.end() ? states.back() : *after;
  };
  const auto nose = [](const flight::TimedState& state) {
    return geometry::View{state.position, flight::compute_direction({state.yaw, 0.0})};
  };
  std::vector<session::ViewInFlight> views;
  bool was_at_rest = false;
  for (double time = states.front().time; time <= states.back().time; time += period) {
    const flight::TimedState& state = state_at(time);
    const bool is_at_rest = state.velocity.norm() < 0.01 && std::abs(state.yaw_rate) < 0.01;
    const flight::TimedState &from = state_at(time - 0.5 * period),
                             &to = state_at(time + 0.5 * period);
    if (!is_at_rest || !was_at_rest) {
      views.push_back({geometry::scanner_view(mount, nose(state)), state.velocity, time});
      if (!is_at_rest) views.back().stretch = {nose(from), nose(to), to.time - from.time};
    }
    was_at_rest = is_at_rest;
  }
  return views;
}

/// Prints a row per format with captures. Returns whether all differences are small.
bool check(const std::filesystem::path& folder) {
  const package::PackageSummary summary = package::read_package_summary(folder, {});
  const config::MissionSetup& setup = summary.mission;
  const evaluation::SurveyScene scene(setup.simulation, folder, 0);
  const std::vector<std::uint8_t> is_visible = scene.visible(0);
  const Json written =
      Json::parse(geometry::read_file(folder / "summary.json", flight::largest_route_file))
          .at("flight")
          .at("written");
  const bool scans_in_flight = setup.flight().capture.scans_in_flight();
  bool is_fine = true;
  for (const Json& part : written) {
    // The sorties of a format are files with the same extension.
    std::vector<std::string> extensions;
    for (const Json& name : part.at("files")) {
      const std::filesystem::path file = name.get<std::string>();
      const std::string extension = file.extension();
      if (std::ranges::find(extensions, extension) == extensions.end()) {
        extensions.push_back(extension);
      }
    }
    for (const std::string& extension : extensions) {
      flight::FlightFacts facts = setup.flight().facts();
      facts.pad = summary.pad.value();
      facts.is_pad_known = true;
      std::vector<session::ViewInFlight> views;
      for (const Json& name : part.at("files")) {
        const std::filesystem::path file = folder / name.get<std::string>();
        if (file.extension() != extension) continue;
        if (scans_in_flight) {
          if (extension != ".csv") continue;
          const flight::CaptureOptions& capture = setup.flight().capture;
          const double begin = views.empty() ? 0.0 : views.back().time + 1.0;
          for (session::ViewInFlight& view :
               scans_along(file, capture.frame_period, capture.mount.value())) {
            view.time += begin;
            views.push_back(view);
          }
          continue;
        }
        for (session::ViewInFlight& view : captures_of(file, facts)) views.push_back(view);
      }
      if (views.empty()) continue;  // The format has no captures.
      const double again =
          evaluation::covered_share(simulation::reflight_coverage(setup.simulation, scene, views,
                                                                  setup.run.seed + other_seed, 0)
                                        .stored,
                                    is_visible)
              .value();
      const double printed = part.at("coverage_visible").get<double>();
      const bool is_equal = std::abs(again - printed) <= max_difference;
      std::printf("%s%s: %zu captures, printed %.2f%%, re-flown %.2f%%%s\n",
                  folder.filename().c_str(), extension.c_str(), views.size(), 100.0 * printed,
                  100.0 * again, is_equal ? "" : ": DIFFERENT");
      is_fine = is_fine && is_equal;
    }
  }
  return is_fine;
}

}  // namespace
}  // namespace skycap::missions

int main(int count, char** arguments) {
  bool is_fine = count > 1;
  for (int i = 1; i < count; ++i) {
    try {
      is_fine = skycap::missions::check(arguments[i]) && is_fine;
    } catch (const std::exception& error) {
      std::printf("%s: %s\n", arguments[i], error.what());
      is_fine = false;
    }
  }
  return is_fine ? 0 : 1;
}
