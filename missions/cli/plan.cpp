#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/batch/benchmark/benchmark_report.h"
#include "missions/cli/commands.h"
#include "missions/cli/printable.h"
#include "missions/cli/survey_batch.h"
#include "missions/cli/write_page.h"
#include "missions/config/mission_document.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/inspection/inspection_mission.h"
#include "missions/inspection/inspection_results.h"
#include "missions/inspection/inspection_site.h"
#include "missions/package/flight_report.h"
#include "missions/package/package.h"
#include "missions/package/pilot_text.h"
#include "missions/package/target_coverage.h"
#include "missions/package/written_mission.h"
#include "missions/photo/photo_mission.h"
#include "missions/photo/photo_results.h"
#include "missions/photo/photo_site.h"
#include "missions/photo/photo_summary.h"
#include "missions/simulation/feasibility.h"
#include "missions/simulation/survey_runner.h"

namespace skycap::missions::cli {
namespace {

std::string percent(double share) { return fmt::format("{:.2f}%", 100.0 * share); }

std::string seconds(double time) {
  return time < 1.0 ? fmt::format("{:.1f} ms", 1e3 * time) : fmt::format("{:.2f} s", time);
}

std::string progress_text(const std::string& name, std::size_t views, std::size_t max_views,
                          const session::EvaluatedView& evaluated, double planning_time) {
  return fmt::format(
      "{}: view {} of at most {}, {} points, {} frontiers, {} covered, planned in {}", name, views,
      max_views, evaluated.surveyed.points, evaluated.surveyed.step.frontiers,
      percent(evaluated.coverage), seconds(planning_time));
}

/// Returns a row of the --verbose table: planning times of one view by part [ms].
std::string times_row(std::size_t view, const session::EvaluatedView& evaluated) {
  const survey::PlanningStep& step = evaluated.surveyed.step;
  std::string row;
  if (view == 0) {
    row = "view  frontiers  total ms";
    for (const survey::PartTime& time : step.times) {
      row += fmt::format(" {:>10}", time.part);
    }
    row += "\n";
  }
  row += fmt::format("{:4} {:10} {:9.2f}", view, step.frontiers,
                     1e3 * evaluated.surveyed.planning_time);
  for (const survey::PartTime& time : step.times) {
    row += fmt::format(" {:10.3f}", 1e3 * time.seconds);
  }
  return row + "\n";
}

std::string planning_text(const session::SurveyRecord& record) {
  std::string text = " (";
  bool is_first = true;
  for (const auto& [part, time] : package::planning_time_by_part(record)) {
    text += (is_first ? "" : ", ") + part + " " + seconds(time);
    is_first = false;
  }
  return text + ")";
}

/// Returns the surface that remains if no remaining view is reachable.
std::string missing_text(const session::SurveyRecord& record) {
  if (record.stop_reason != survey::StopReason::nowhere_to_go || !record.estimate ||
      record.estimate->unreachable <= 0.0) {
    return "";
  }
  return "  missing   estimate: " + percent(record.estimate->unreachable) +
         " of the surface, visible only from positions that are not verified as free\n";
}

/// Returns the numbers of a pattern's views. summary.json lists the views that were not flown.
std::string pattern_text(const survey::PatternRecord& pattern) {
  std::string text =
      fmt::format("  pattern   {} of {} views flown", pattern.flown, pattern.planned);
  if (pattern.moved > 0) text += fmt::format(", {} from farther away", pattern.moved);
  if (!pattern.dropped.empty()) {
    text += fmt::format("; {} dropped: outside the limits or unreachable (pattern.dropped in {})",
                        pattern.dropped.size(), package::summary_name);
  }
  return text + "\n";
}

std::string summary_text(const std::string& name, const PlanOptions& options,
                         const evaluation::SimulationOptions& simulation,
                         const session::SurveyRecord& record,
                         const package::CoverageFigures& coverage,
                         const std::optional<package::SurveyMission>& flight,
                         const std::filesystem::path& folder) {
  std::string text =
      fmt::format("{}: {} after {} views, {:.2f} m\n", name, session::to_string(record.stop_reason),
                  record.views.size(), record.distance());
  text += "  coverage  " + percent(coverage.all) + " of the surface";
  if (coverage.visible) text += ", " + percent(*coverage.visible) + " of the visible surface";
  if (coverage.attainable_coverage)
    text += "; attainable " + percent(*coverage.attainable_coverage);
  text += "\n" + package::target_text(package::target_coverage(
                     simulation.scene, simulation.evaluation.registration_distance,
                     record.cloud.positions));
  text += missing_text(record);
  if (record.pattern) text += pattern_text(*record.pattern);
  if (flight && flight->written) text += package::written_text(*flight->written);
  if (simulation.scene.model == "prior") {
    text += "  scene     prior data of the targets, used as ground truth\n";
  }
  text += "  planning  " + seconds(record.planning_time());
  if (options.is_verbose) text += planning_text(record);
  text += "\n";
  if (record.flight_record) text += package::survey_flight_text(simulation.survey.flight, record);
  if (flight) text += package::flight_text(*flight, options.is_verbose);
  text += "  results   " + folder.string() + "\n";
  if (flight) text += package::pilot_text(simulation.survey.flight, *flight);
  return text;
}

int plan_once(const PlanOptions& options, const config::MissionSetup& setup,
              const evaluation::SurveyScene& scene, geometry::OutputFolder& folder,
              const Console& console) {
  ProgressLine progress(console, options.is_quiet);
  std::size_t views = 0;
  double planning_time = 0.0;
  const auto report = [&](const session::EvaluatedView& evaluated) {
    planning_time += evaluated.surveyed.planning_time;
    if (options.is_verbose) console.err << times_row(views, evaluated) << std::flush;
    progress.show(progress_text(setup.name, ++views, setup.survey().limits.max_views, evaluated,
                                planning_time));
  };
  const PendingResultsGuard results(console);
  simulation::SurveyJournal journal(folder.path() / simulation::journal_name, setup.identity(),
                                    scene, options.resumes);
  if (journal.views() > 0 && !options.is_quiet) {
    console.err << "resuming an interrupted survey after " << journal.views() << " views\n";
  }
  const session::SurveyRecord record = simulation::run_survey(
      setup.simulation, scene, setup.run.seed, setup.run.threads, console.stop, report, &journal);

  const bool is_over = record.stop_reason != survey::StopReason::interrupted;
  if (is_over) progress.show(setup.name + ": computing attainable coverage");
  const package::CoverageFigures coverage =
      package::coverage_figures(setup.simulation, record, scene, setup.run.threads, console.stop);
  progress.show(setup.name + ": writing " + folder.path().string());
  const std::optional<package::SurveyMission> flight =
      package::stage_package(setup, record, coverage, setup.run.threads, folder, console.stop);
  write_page(package::summary_name, options.has_report, folder, console);
  package::commit_package(record, folder);
  progress.clear();
  if (!options.is_quiet) {
    console.out << summary_text(setup.name, options, setup.simulation, record, coverage, flight,
                                folder.path())
                << std::flush;
  }
  // A flown survey ends normally when no view is reachable. If that applies to the first view, the
  // survey failed.
  const bool went_through =
      is_over &&
      (record.stop_reason != survey::StopReason::nowhere_to_go || record.views.size() > 1) &&
      (!flight || flight->failure.empty());
  if (options.is_quiet && is_over && !went_through) {
    const bool has_failure = flight && !flight->failure.empty();
    console.err << printable_line("skycap: error: " + options.mission.string() + ": no route: " +
                                  (has_failure ? flight->failure : "no view is reachable"))
                << "\n"
                << std::flush;
  }
  return went_through ? 0 : 1;
}

int plan_trials(const PlanOptions& options, const config::MissionSetup& mission,
                geometry::OutputFolder& folder, const Console& console) {
  SurveyRunner runner("plan", console, options.is_quiet, mission.run.threads);
  const PendingResultsGuard results(console);
  const auto setup =
      std::make_shared<const batch::Setup>(batch::own_setup(options.mission, mission));
  std::vector<batch::BatchItem> items;
  for (std::size_t i = 0; i < options.trials; ++i) {
    const std::uint64_t seed = mission.run.seed + i;
    items.push_back(
        {setup, seed, folder.path() / "items" / ("seed_" + std::to_string(seed) + ".json")});
  }
  std::vector<batch::Trial> trials;  // includes trials completed by earlier runs
  for (auto& done : runner.run(items)) {
    if (done) trials.push_back(std::move(done->trial));
  }
  runner.clear();
  folder.write("trials.csv", batch::trials_csv(trials));
  folder.write("trials.json",
               batch::trials_json(mission, trials, options.trials, mission.run.threads));
  write_page("trials.json", options.has_report, folder, console);
  if (trials.size() < options.trials &&
      package::is_complete_result(folder.path() / "trials.json")) {
    folder.move_to("interrupted");  // completed trials are kept and not repeated
  }
  folder.commit();
  if (!options.is_quiet) {
    console.out << batch::trials_table(mission, trials) << "  results   " << folder.path().string()
                << "\n"
                << std::flush;
  }
  return trials.size() == options.trials ? 0 : 1;
}

/// A mission with a photo camera: nothing is measured, and nothing of a scene is known.
int plan_photos(const PlanOptions& options, const config::MissionSetup& setup,
                geometry::OutputFolder& folder, const Console& console) {
  if (options.trials > 0) {
    throw Error(ErrorKind::bad_usage,
                "--trials requires a depth sensor; remove --trials for a photo mission");
  }
  ProgressLine progress(console, options.is_quiet);
  const auto report = [&](const std::string& what) { progress.show(setup.name + ": " + what); };
  const photo::PhotoAirspace airspace(setup, setup.run.threads);
  photo::PhotoMission mission = photo::plan_photo_mission(setup, airspace, console.stop, report);
  if (options.control_points) {
    photo::add_control_points(setup, airspace, *options.control_points, mission);
  }
  report("writing " + folder.path().string());
  photo::stage_photo_mission(setup, airspace, mission, folder);
  write_page(package::summary_name, options.has_report, folder, console);
  folder.commit();
  photo::write_colmap_model(setup, mission, folder.path() / "colmap");
  progress.clear();
  if (options.is_quiet) return 0;
  console.out << photo::plan_text(setup, mission);
  if (mission.flight) console.out << package::flight_text(*mission.flight, options.is_verbose);
  console.out << "  results   " << folder.path().string() << "\n";
  console.out << (mission.flight
                      ? package::pilot_text(setup.flight(), *mission.flight, mission.warnings)
                      : photo::warnings_text(mission))
              << std::flush;
  return 0;
}

/// A continuous flight around a known structure: nothing is measured or simulated.
int plan_inspection(const PlanOptions& options, const config::MissionSetup& setup,
                    geometry::OutputFolder& folder, const Console& console) {
  if (options.trials > 0 || options.control_points) {
    throw Error(ErrorKind::bad_usage,
                "--trials and --control-points conflict with inspection.range; remove them");
  }
  ProgressLine progress(console, options.is_quiet);
  const auto report = [&](const std::string& what) { progress.show(setup.name + ": " + what); };
  report("reading the structure");
  const inspection::InspectionSpace space(setup);
  inspection::InspectionMission mission =
      inspection::plan_inspection_mission(setup, space, console.stop, report);
  report("writing " + folder.path().string());
  inspection::stage_inspection_mission(setup, space, mission, folder);
  write_page(package::summary_name, options.has_report, folder, console);
  folder.commit();
  progress.clear();
  if (options.is_quiet) return 0;
  console.out << inspection::plan_text(setup, mission) << "  results   " << folder.path().string()
              << "\n"
              << inspection::warnings_text(setup, mission) << std::flush;
  return 0;
}

}  // namespace

int plan(const PlanOptions& options, const Console& console) {
  const config::MissionSetup setup = read_shown(config::read_mission, options, console);
  geometry::OutputFolder folder(
      options.out.value_or(std::filesystem::path("results") / setup.name));
  if (setup.document->is_for_known_target()) {
    try {
      return setup.document->is_inspection() ? plan_inspection(options, setup, folder, console)
                                             : plan_photos(options, setup, folder, console);
    } catch (const Error& error) {
      throw Error(error.kind(), options.mission.string() + ": " + error.what());
    }
  }
  if (options.control_points) {
    throw Error(ErrorKind::bad_usage,
                "--control-points requires a photo mission; set sensor.photo_camera or remove the "
                "option");
  }
  if (options.trials > 0) return plan_trials(options, setup, folder, console);
  ProgressLine progress(console, options.is_quiet);
  progress.show(setup.name + ": loading scene");
  try {
    const evaluation::SurveyScene scene(setup.simulation, options.mission.parent_path(),
                                        setup.run.threads);
    simulation::require_feasible(setup.simulation, scene, setup.run);
    return plan_once(options, setup, scene, folder, console);
  } catch (const Error& error) {
    // Errors during the survey are reported with the mission file.
    throw Error(error.kind(), options.mission.string() + ": " + error.what());
  }
}

}  // namespace skycap::missions::cli
