// Benchmark of the cost of verified return paths. The route of a mission package is planned with
// and without return paths, in the same measured space and view order. Prints the additional
// mission time and the planning time.
//
// way_home_benchmark [PACKAGE... ] [--rounds 3]
//
// Without a package, a 20 m teapot is surveyed first.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "missions/cli/command_line.h"
#include "missions/package/package.h"
#include "tests/benchmarks/interleaved.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace skycap;
using namespace skycap::missions;

flight::Route plan(const package::PackagedSurvey& survey, bool has_returns) {
  std::vector<flight::CapturePoint> capture_points;
  for (std::uint32_t i = 0; i < survey.views.size(); ++i) {
    capture_points.push_back({survey.views[i], survey.flight.rest_before(), 1, i,
                              survey.flight.rest_after(), survey.paths[i]});
  }
  flight::Obstacles rules = survey.flight.rules();
  const flight::KnownSpace known(rules);
  const flight::KnownSpace pad_space(without_ground(std::move(rules)));
  const flight::JointSpace space({&survey.measured, &known});
  flight::RouteOptions options = survey.flight.route(survey.pad);
  if (!has_returns) options.returns.reset();
  return plan_route(std::move(capture_points), survey.flight.required_vehicle(), space, &pad_space,
                    options);
}

/// Keeps only the views that both routes visit, because views without a return path are skipped in
/// one of them.
void keep_route_views(const flight::Route& route, package::PackagedSurvey& survey) {
  std::vector<bool> is_kept(survey.views.size(), false);
  for (const flight::CapturePoint& capture_point : route.capture_points)
    is_kept[capture_point.view_index] = true;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < survey.views.size(); ++i) {
    if (!is_kept[i]) continue;
    survey.views[kept] = survey.views[i];
    survey.paths[kept++].clear();  // the path starts at a view that may be skipped
  }
  survey.views.resize(kept);
  survey.paths.resize(kept);
}

void measure(const std::filesystem::path& folder, int rounds) {
  package::PackagedSurvey survey = package::read_package(folder, {});
  const std::size_t all = survey.views.size();
  keep_route_views(plan(survey, true), survey);
  const flight::Route with = plan(survey, true), without = plan(survey, false);
  const auto [time, bare_time] = benchmarks::interleaved_medians(
      rounds, [&] { plan(survey, true); }, [&] { plan(survey, false); });
  std::printf(
      "%s: %zu of %zu views, %zu and %zu flown to; length %.1f m, %+.2f %%; time %.1f s, "
      "%+.2f %%; planned in %.2f s, %.2f times %.2f s\n",
      folder.string().c_str(), survey.views.size(), all, with.capture_points.size(),
      without.capture_points.size(), with.length, 100.0 * (with.length / without.length - 1.0),
      with.duration, 100.0 * (with.duration / without.duration - 1.0), time, time / bare_time,
      bare_time);
}

/// Creates the package of a small survey.
void survey_teapot(const std::filesystem::path& mission, const std::filesystem::path& package) {
  std::ostringstream out, err;
  cli::run_command_line(
      {"plan", mission.string(), "--quiet", "--no-report", "--out", package.string()}, {out, err});
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 3;
  std::vector<std::filesystem::path> packages;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--rounds" && i + 1 < argc) {
      rounds = std::atoi(argv[++i]);
    } else {
      packages.emplace_back(argv[i]);
    }
  }
  const testing_support::TemporaryFolder folder;
  if (packages.empty()) {
    packages.push_back(folder.path() / "teapot");
    survey_teapot(folder.file("teapot.yaml", tests::flight_mission()), packages.front());
  }
  for (const std::filesystem::path& package : packages) measure(package, rounds);
  return 0;
}
