#include "missions/cli/command_line.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "geometry/error.h"
#include "geometry/instruction_set.h"
#include "geometry/interrupted.h"
#include "missions/cli/printable.h"
#include "missions/cli/verb_options.h"
#include "missions/cli/verbs.h"
#include "missions/config/mission_keys.h"
#include "missions/scan/cloud_formats.h"
#include "missions/version.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::cli {
namespace {

/// What planner.name may be.
std::string planner_list() {
  std::string list;
  for (const survey::PlannerTitle& title : survey::planner_titles) {
    list.append(list.empty() ? "" : ", ").append(title.word);
  }
  return list;
}

void add_plan(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "plan", "Survey a mission's scene in simulation and write the mission package");
  const auto options = std::make_shared<PlanOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  verb->add_option("mission", options->mission, "Mission file (docs/reference/mission-file.md)")
      ->required();
  verb->add_option("--out", options->out, "Folder for the results; default results/NAME");
  verb->add_option("--planner", keys->planner, planner_list() + ", in place of the mission's");
  verb->add_option("--seed", keys->seed, "Seed, in place of the mission's");
  verb->add_option("--threads", keys->threads, "Threads, 0 for all processors");
  verb->add_option("--max-views", keys->max_views, "End after this many views");
  verb->add_option("--trials", options->trials,
                   "Run this many seeds; write trials.csv and trials.json")
      ->check(CLI::Range(1, 100'000));
  verb->add_flag("--resume", options->resumes,
                 "Go on with the survey that was interrupted in that folder, if there is one");
  verb->add_flag("!--no-report", options->has_report, "Leave out the page");
  verb->add_flag("--quiet", options->is_quiet, "Print nothing but errors");
  verb->add_option("--dry-run", keys->dry_run,
                   "prior: the targets among the mission's prior data stand in for the truth")
      ->check(CLI::IsMember({"prior"}));
  verb->add_flag("--verbose", options->is_verbose, "Print the planning time of each view by part");
  add_set_option(*verb, *keys);
  run_with_keys(*verb, options, keys, plan, console, action);
}

void add_benchmark(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "benchmark", "Compare planners on missions over many seeds: the paper's tables, and curves");
  const auto options = std::make_shared<BenchmarkOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  verb->add_option("missions", options->missions, "Mission files")->required();
  verb->add_option("--planners", options->planners,
                   "all (those of the paper), or names such as see++,oa,skycap")
      ->delimiter(',');
  verb->add_option("--scenes", options->scenes,
                   "all families of scenes, or names such as garage,church: each in the place of "
                   "the missions' own, and drawn anew for each seed")
      ->delimiter(',');
  verb->add_option("--trials", options->trials, "Seeds for each planner and mission; default 10")
      ->check(CLI::Range(1, 100'000));
  verb->add_option("--out", options->out,
                   "Folder for the results; default results/benchmark. What is finished there is "
                   "not run again");
  verb->add_option("--threads", options->threads, "Surveys at a time, 0 for all processors")
      ->check(CLI::Range(0, 1024));
  verb->add_option("--seed", keys->seed, "First seed, in place of the missions'");
  verb->add_option("--max-views", keys->max_views, "End every survey after this many views");
  verb->add_flag("!--no-report", options->has_report, "Leave out the page");
  verb->add_flag("--quiet", options->is_quiet, "Print nothing but errors");
  add_set_option(*verb, *keys);
  run_with_keys(*verb, options, keys, benchmark, console, action);
}

void add_scan(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "scan", "Fly a route in the simulator and record what a sensor measures on the way");
  const auto options = std::make_shared<ScanVerbOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  verb->add_option("mission", options->mission, "Mission file (docs/howto/simulate-lidar.md)")
      ->required();
  verb->add_option("--route", options->route,
                   "Route file, or the folder of a mission package; default: the mission's");
  verb->add_option("--sensor", options->sensor,
                   "Preset or description NAME.yaml, in place of the mission's");
  verb->add_option("--out", options->out, "Folder for the results; default results/NAME/scan");
  verb->add_option("--format", options->formats,
                   "Of the points, one or more of " + scan::cloud_format_names() + "; default las")
      ->delimiter(',');
  verb->add_flag("--with-truth", options->with_truth,
                 "Write a second file with the points as they really were");
  CLI::Option* const resumes =
      verb->add_flag("--resume", options->resumes,
                     "Go on with the scan that was interrupted in that folder, if there is one");
  verb->add_option("--pieces", options->pieces,
                   "Measure the flight in so many pieces, each by itself, and join them; the same "
                   "bytes")
      ->check(CLI::Range(1, 1'000'000))
      ->excludes(resumes);
  add_task_options(*verb, options->task, "piece");
  verb->add_flag("!--no-report", options->has_report, "Leave out the page");
  verb->add_option("--seed", keys->seed, "Seed, in place of the mission's");
  verb->add_option("--threads", keys->threads, "Threads, 0 for all processors");
  verb->add_flag("--quiet", options->is_quiet, "Print nothing but errors");
  add_set_option(*verb, *keys);
  run_with_keys(*verb, options, keys, scan, console, action);
}

void add_check(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand("check", "Check a mission file and its scene");
  const auto options = std::make_shared<CheckOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  const auto prints_schema = std::make_shared<bool>(false);
  const auto prints_keys = std::make_shared<bool>(false);
  verb->add_option("mission", options->mission, "Mission file");
  verb->add_option("--route", options->route,
                   "Prove that this route (.plan, .waypoints, .kmz, .kml, .geojson, .csv, .tum) "
                   "keeps flight.clearance from the scene");
  verb->add_option("--return-height", options->return_height,
                   "The height of return that the vehicle is set to, above take-off [m]")
      ->check(CLI::Range(0.0, 10'000.0));
  add_set_option(*verb, *keys);
  verb->add_flag("--schema", *prints_schema, "Print the JSON Schema of mission files instead");
  verb->add_flag("--keys", *prints_keys, "Print the table of all keys instead");
  verb->add_flag("--setup", options->prints_setup,
                 "Print the completed keys and the values derived from them as YAML");
  verb->callback([=, &console, &action] {
    options->overrides = keys->overrides();
    action = [=, &console] {
      if (*prints_schema) return console.out << config::mission_json_schema(), 0;
      if (*prints_keys) return console.out << config::mission_key_table(), 0;
      if (options->mission.empty()) {
        throw Error(ErrorKind::bad_usage, "check needs a mission file; name one");
      }
      return check(*options, console);
    };
  });
}

void add_fly_test(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "fly-test", "Fly a mission package's routes many times in wind, with failsafes");
  const auto options = std::make_shared<FlyTestVerbOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  verb->add_option("package", options->package, "Folder that plan wrote")->required();
  verb->add_option("--flights", options->flights, "Of each route file; default 100")
      ->check(CLI::Range(1, 1'000'000));
  verb->add_option("--returns", options->returns,
                   "Ways home from places at random; default 1000. 0: none")
      ->check(CLI::Range(0, 100'000'000));
  verb->add_option("--wind", options->wind_speed,
                   "Strongest steady wind, which gusts come on top of [m/s]; default the "
                   "mission's, at least 5")
      ->check(number_between(0.0, 100.0));
  verb->add_option("--position-error", options->position_error,
                   "Greatest error of the receiver [m]; default the mission's")
      ->check(number_between(0.0, 1000.0));
  verb->add_option("--return-height", options->return_height,
                   "The height of return that the vehicle is set to, above take-off [m]")
      ->check(number_between(0.0, 10'000.0));
  verb->add_option("--truth", options->truth,
                   "Mission file: judge the flights against its scene as it truly is, too");
  verb->add_option("--out", options->out, "Folder for fly_test.json; default the package");
  verb->add_option("--seed", keys->seed, "Seed, in place of the mission's");
  verb->add_option("--threads", keys->threads, "Threads, 0 for all processors");
  verb->add_flag("--quiet", options->is_quiet, "Print nothing but errors");
  add_set_option(*verb, *keys);
  run_with_keys(*verb, options, keys, fly_test, console, action);
}

void add_calibrate(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb =
      app.add_subcommand("calibrate", "Make a vehicle file from a log of the vehicle's own flight");
  const auto options = std::make_shared<CalibrateOptions>();
  verb->add_option("log", options->log, "ArduPilot's dataflash log (.bin), or .csv")->required();
  verb->add_option("--vehicle", options->vehicle, "Preset that it is like, such as m350_rtk")
      ->required();
  verb->add_option("--mass", options->mass, "Flown, with payload, in place of the preset's [kg]")
      ->check(number_between(0.01, 1000.0));
  verb->add_option("--battery", options->battery_wh, "In place of the preset's [Wh]")
      ->check(number_between(0.1, 1e5));
  verb->add_option("--air-density", options->air_density, "Of that day; default 1.225 kg/m^3")
      ->check(number_between(0.4, 1.9));
  verb->add_option("--out", options->out, "Vehicle file; default LOG.yaml");
  run(*verb, options, calibrate, console, action);
}

void add_evaluate(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "evaluate", "Coverage, accuracy and density of a cloud or mesh against a model");
  const auto options = std::make_shared<EvaluateOptions>();
  CLI::App* what = verb->add_option_group("what is judged");
  what->add_option("--cloud", options->cloud, "Point cloud: .ply, .pcd, .las, .laz, .e57 or .xyz");
  what->add_option("--mesh", options->mesh,
                   "Mesh, in place of a cloud: of skycap reconstruct, say");
  what->require_option(1);
  verb->add_option("--model", options->model,
                   "Mesh, builtin:NAME, model:NAME, or a mission file for its scene as surveyed")
      ->required();
  verb->add_option("--distance", options->distance,
                   "A surface point with a measurement this near is covered [m]")
      ->check(number_between(1e-6, 1e9));
  verb->add_option("--samples", options->samples, "Surface points; default 100000")
      ->check(CLI::Range(100, 10'000'000));
  verb->add_option("--pieces", options->pieces,
                   "Judge a cloud in so many pieces, each by itself; the same figures")
      ->check(CLI::Range(1, 1'000'000));
  verb->add_option("--out", options->out, "Folder for pieces, and for evaluation.json of them");
  add_task_options(*verb, options->task, "piece");
  verb->add_option("--threads", options->threads, "Threads, 0 for all processors")
      ->check(CLI::Range(0, 1024));
  verb->add_flag("--json", options->is_json, "Print JSON");
  verb->add_flag("--quiet", options->is_quiet, "Show no progress, and print nothing of pieces");
  run(*verb, options, evaluate, console, action);
}

void add_reconstruct(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand("reconstruct", "Make a surface mesh of a point cloud");
  const auto options = std::make_shared<ReconstructOptions>();
  verb->add_option("cloud", options->cloud,
                   "Point cloud (.ply, .pcd, .las, .laz, .e57, .xyz), with normals or without")
      ->required();
  verb->add_option("--out", options->out, "PLY, OBJ, STL or OFF; default CLOUD_mesh.ply");
  verb->add_option("--spacing", options->spacing, "Thin the cloud to one point a cube [m]")
      ->check(number_between(0.0, 1e6));
  verb->add_option("--depth", options->depth,
                   "Of the octree, 2^depth cells a side; default: as the points are spaced")
      ->check(CLI::Range(0, 12));
  verb->add_option("--trim", options->least_density,
                   "Drop surface with less than this share of the usual density; default 0.2")
      ->check(number_between(0.0, 0.99));
  verb->add_option("--threads", options->threads, "Threads, 0 for all processors")
      ->check(CLI::Range(0, 1024));
  run(*verb, options, reconstruct_cloud, console, action);
}

void add_report(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand("report", "Write the pages that show a folder of results");
  const auto options = std::make_shared<ReportOptions>();
  verb->add_option("folder", options->folder, "Folder that plan, scan or benchmark wrote")
      ->required();
  verb->add_option("--out", options->out, "The page; default in the folder");
  verb->add_option("--points", options->points, "Points of the cloud to show; default 1000000")
      ->check(CLI::Range(1, 100'000'000));
  run(*verb, options, report_results, console, action);
}

void add_view(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "view", "Show results, a point cloud, or a mission's scene in the browser");
  const auto options = std::make_shared<ViewOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  verb->add_option("what", options->what,
                   "Folder of results, cloud (.ply, .pcd, .las, .laz, .e57, .xyz), or mission file")
      ->required();
  verb->add_option("--out", options->out, "The page; default beside what is shown");
  add_set_option(*verb, *keys);
  run_with_keys(*verb, options, keys, view, console, action);
}

/// One line for the user, whatever the message holds.
int report_failure(const Console& console, const std::string& message, int exit_code) {
  console.err << "skycap: error: " << printable_line(message) << "\n" << std::flush;
  return exit_code;
}

int parse_and_run(const std::vector<std::string>& arguments, const Console& console) {
  CLI::App app("Skycap plans aerial surveys of buildings and simulates them.", "skycap");
  app.set_version_flag("--version", std::string("skycap ") + version);
  app.require_subcommand(0, 1);
  app.get_formatter()->column_width(28);
  Action action;
  try {
    // So that tests and comparisons can do on this processor what another one would.
    // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets variables
    if (const char* const widest = std::getenv("SKYCAP_INSTRUCTION_SET")) {
      geometry::limit_instruction_set(widest);
    }
    add_plan(app, console, action);
    add_site(app, console, action);
    add_live(app, console, action);
    add_benchmark(app, console, action);
    add_campaign(app, console, action);
    add_district(app, console, action);
    add_scan(app, console, action);
    add_check(app, console, action);
    add_export(app, console, action);
    add_fly_test(app, console, action);
    add_calibrate(app, console, action);
    add_evaluate(app, console, action);
    add_reconstruct(app, console, action);
    add_model(app, console, action);
    add_report(app, console, action);
    add_view(app, console, action);
    const auto known = app.get_subcommands({});
    std::string verbs;
    for (const CLI::App* verb : known) verbs += (verbs.empty() ? "" : ", ") + verb->get_name();
    if (!arguments.empty() && !arguments[0].starts_with('-') &&
        std::ranges::find(known, arguments[0], &CLI::App::get_name) == known.end()) {
      throw Error(ErrorKind::bad_usage,
                  "there is no verb '" + arguments[0] + "'; the verbs are " + verbs);
    }
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());  // as CLI11 wants it
    app.parse(reversed);
    if (!action) {
      throw Error(ErrorKind::bad_usage,
                  "says nothing to do; name one of the verbs " + verbs + ", or --help");
    }
    return action();
  } catch (const CLI::Success& wish) {  // --help or --version
    return app.exit(wish, console.out, console.err);
  } catch (const CLI::ParseError& failure) {
    return report_failure(console, std::string(failure.what()) + "; see --help", 2);
  } catch (const Interrupted&) {
    console.err << "skycap: interrupted\n" << std::flush;
    return interrupted_exit_code(console);
  } catch (const Error& failure) {
    return report_failure(console, failure.what(), 2);
  } catch (const std::filesystem::filesystem_error& failure) {
    // A loop of links, a folder that may not be entered: the system's word on a path of the user's.
    const std::string text = failure.path1().string() + ": " + failure.code().message();
    return report_failure(console, text, 2);
  } catch (const std::bad_alloc&) {
    return report_failure(console, "there is not enough memory for this", 3);
  } catch (const std::exception& failure) {
    return report_failure(console, std::string("internal failure: ") + failure.what(), 3);
  }
}

}  // namespace

int run_command_line(const std::vector<std::string>& arguments, const Console& console) {
  PrintableBuffer buffer(*console.out.rdbuf());
  std::ostream out(&buffer);
  const int exit_code =
      parse_and_run(arguments, {out, console.err, console.err_is_terminal, console.stop,
                                console.results_held, console.ending_signal});
  if (out.flush()) return exit_code;
  return report_failure(console, "the results cannot be written to the standard output", 3);
}

}  // namespace skycap::missions::cli
