// Benchmark of the cost of an unknown scene. Missions replanned from survey measurements are
// compared with missions that the same search plans with the true surface and the surrounding free
// space. Both have the same coverage target.
//
// minutes_benchmark [MISSION] [--seeds 3] [--set KEY=VALUE]...
//
// The oracle obtains the true surface from the scans of the survey and of additional views that
// cover the scene. Both missions are simulated. The default mission is a teapot of 20 m.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/coverage.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/flight_files.h"
#include "missions/package/package.h"
#include "missions/package/replanned_mission.h"
#include "missions/session/constrained_planner.h"
#include "missions/simulation/omniscient.h"
#include "missions/simulation/survey_runner.h"
#include "sim/sensors/survey_sensor.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace skycap;
using namespace skycap::missions;

/// Returns the survey record of an oracle: the views and legs of the survey, with the surface and
/// free space measured from views that cover the scene.
session::SurveyRecord all_knowing(const evaluation::SimulationOptions& options,
                                  const evaluation::SurveyScene& scene,
                                  const session::SurveyRecord& record, unsigned threads) {
  const sim::SurveySensor sensor(options.sensor, record.seed + 1'000'000);
  std::vector<geometry::View> views = package::collect_views(record);
  session::ConstrainedPlanner knowing(options.survey, views.front(),
                                      {record.seed, threads, scene.view_sphere()});
  for (const geometry::View& view :
       simulation::known_cover(options, scene, record.seed, threads, {.candidates = 3000})) {
    views.push_back(view);
  }
  std::uint64_t frame = 0;
  for (const geometry::View& view : views) {
    const geometry::Scan scan = sensor.scan(scene.scene(), view, frame++, threads);
    if (frame == 1) {
      knowing.planner().next_view(scan);
    } else {
      knowing.planner().pass(scan);
    }
    knowing.flight()->add_scan(scan);
  }
  session::SurveyRecord reported;
  knowing.finish(reported);
  session::SurveyRecord all = record;
  all.surface = reported.surface;
  all.flight_record->measured = reported.flight_record->measured;
  all.flight_record->landing_surfaces = reported.flight_record->landing_surfaces;
  return all;
}

package::ReplannedMission choose(const evaluation::SimulationOptions& options,
                                 const session::RunOptions& run,
                                 const session::SurveyRecord& record,
                                 const package::CoverageFigures& coverage) {
  const session::FlightRecord& flight_record = *record.flight_record;
  std::vector<package::Polyline> paths;
  for (const session::ExecutedLeg& leg : flight_record.legs) paths.push_back(leg.points);
  flight::Route present =
      package::plan_flight(options.survey.flight, *flight_record.measured, flight_record.pad,
                           package::collect_views(record), paths, flight_record.landing_surfaces);
  return package::replan_mission(options.survey, package::choice_options(options.sensor, run),
                                 record, coverage, std::move(present), {});
}

void print(const char* who, const package::ReplannedMission& mission) {
  const package::MissionFigures& figures = mission.choice.replanned;
  std::printf("  %-16s %6.1f s %6.1f m %4zu views %4zu pieces, promised %.2f %%, %.2f %% covered\n",
              who, figures.duration, figures.length, figures.views, figures.segments,
              100.0 * figures.predicted_coverage, 100.0 * mission.again->visible.value_or(0.0));
}

void compare(const std::filesystem::path& file, const std::vector<config::KeyOverride>& overrides,
             std::uint64_t seeds) {
  const config::MissionSetup mission = config::read_mission(file, overrides);
  const evaluation::SimulationOptions& options = mission.simulation;
  const unsigned threads = geometry::thread_count(mission.run.threads);
  const evaluation::SurveyScene scene(options, file.parent_path(), mission.run.threads);
  double ours = 0.0, knowing = 0.0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const session::SurveyRecord record = simulation::run_survey(options, scene, seed, threads);
    const package::CoverageFigures coverage =
        package::coverage_figures(options, record, scene, threads, {});
    const package::ReplannedMission from_survey = choose(options, mission.run, record, coverage);
    const package::ReplannedMission from_truth =
        choose(options, mission.run, all_knowing(options, scene, record, threads), coverage);
    std::printf("seed %llu: %zu views, %.2f %% of the visible\n",
                static_cast<unsigned long long>(seed), record.views.size(),
                100.0 * coverage.visible.value_or(0.0));
    print("from the survey", from_survey);
    print("knowing all", from_truth);
    std::fflush(stdout);
    ours += from_survey.choice.replanned.duration;
    knowing += from_truth.choice.replanned.duration;
  }
  std::printf("all seeds: %.2f times the seconds of who knows all\n", ours / knowing);
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path mission;
  std::uint64_t seeds = 3;
  std::vector<config::KeyOverride> overrides{{"--set", "planner.name", "skycap"},
                                             {"--set", "flight.views", "anew"}};
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--seeds" && i + 1 < argc) {
      seeds = std::max(1UL, std::strtoul(argv[++i], nullptr, 10));
    } else if (word == "--set" && i + 1 < argc) {
      const std::string setting = argv[++i];
      const std::size_t equals = std::min(setting.find('='), setting.size() - 1);
      overrides.push_back({"--set", setting.substr(0, equals), setting.substr(equals + 1)});
    } else {
      mission = word;
    }
  }
  const testing_support::TemporaryFolder folder;
  if (mission.empty()) mission = folder.file("teapot.yaml", tests::flight_mission());
  try {
    compare(mission, overrides, seeds);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
