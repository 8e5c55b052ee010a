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
#include "missions/cli/build_text.h"
#include "missions/cli/command_options.h"
#include "missions/cli/commands.h"
#include "missions/cli/compare.h"
#include "missions/cli/completion.h"
#include "missions/cli/printable.h"
#include "missions/cli/rewrite.h"
#include "missions/config/mission_keys.h"
#include "missions/scan/cloud_formats.h"
#include "missions/support/similar_name.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::cli {
namespace {

/// Returns a list of all planner names, without that of users' planners.
std::string planner_list() {
  std::string list;
  for (const survey::PlannerTitle& title : survey::planner_titles) {
    if (title.name == survey::PlannerName::external) continue;
    list.append(list.empty() ? "" : ", ").append(title.word);
  }
  return list;
}

void add_plan(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("plan", "Plan a survey in simulation and write the mission files");
  const auto options = std::make_shared<PlanOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  command->add_option("mission", options->mission, "Mission file (docs/reference/mission-file.md)")
      ->required();
  command->add_option("--out", options->out, "Folder for the results (default: results/NAME)");
  command->add_option(
      "--planner", keys->planner,
      planner_list() + ", or a custom planner file (.so, .py); overrides the mission file");
  command->add_option("--seed", keys->seed, "Random seed; overrides the mission file");
  command->add_option("--threads", keys->threads, "Number of threads (0: all processors)");
  command->add_option("--max-views", keys->max_views, "Maximum number of views");
  command
      ->add_option("--trials", options->trials,
                   "Number of seeds to run; writes trials.csv and trials.json")
      ->check(CLI::Range(1, 100'000));
  command->add_flag("--resume", options->resumes,
                    "Resume an interrupted survey in the results folder");
  command->add_flag("!--no-report", options->has_report, "Do not write the HTML report");
  command->add_flag("--quiet", options->is_quiet, "Print errors only");
  command->add_option("--control-points", options->control_points,
                      "Photo missions: CSV file of surveyed ground control points, "
                      "name,x,y,z or name,latitude,longitude,height");
  command->add_flag("--use-prior-as-truth", keys->uses_prior_as_truth,
                    "Simulate with the target's prior data as ground truth");
  command->add_flag("--verbose", options->is_verbose,
                    "Print planning times per view and the optimality gap of the tour");
  add_set_option(*command, *keys);
  run_with_keys(*command, options, keys, plan, console, action);
}

void add_benchmark(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("benchmark", "Compare planners over several missions and seeds");
  const auto options = std::make_shared<BenchmarkOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  command->add_option("missions", options->missions, "Mission files")->required();
  command
      ->add_option("--planners", options->planners,
                   "Planners: all (those in the paper), names such as see++,oa,skycap, or custom "
                   "planner files (.so, .py)")
      ->delimiter(',');
  command
      ->add_option("--set-views", options->set_views,
                   "Numbers of views for the planners uniform and random (default: "
                   "5,8,10,12,15,20,25,30,40,60,100)")
      ->check(CLI::Range(1, 10'000))
      ->delimiter(',');
  command
      ->add_option("--also", options->also,
                   "Results of another program (JSON, docs/howto/compare-planners.md), shown with "
                   "the others. For inspections: MISSION=FILE with a flight; repeatable")
      ->type_size(1)
      ->allow_extra_args(false);
  command
      ->add_option("--scenes", options->scenes,
                   "Scene families: all, or names such as garage,church. Each family replaces the "
                   "scenes of the missions and is generated for each seed")
      ->delimiter(',');
  command
      ->add_option("--trials", options->trials,
                   "Number of seeds for each planner and mission (default: 10)")
      ->check(CLI::Range(1, 100'000));
  command->add_option(
      "--out", options->out,
      "Folder for the results (default: results/benchmark). Completed runs are not repeated");
  command
      ->add_option("--threads", options->threads, "Number of parallel surveys (0: all processors)")
      ->check(CLI::Range(0, 1024));
  command->add_option("--seed", keys->seed, "First seed; overrides the mission files");
  command->add_option("--max-views", keys->max_views, "Maximum number of views per survey");
  command->add_flag("!--no-report", options->has_report, "Do not write the HTML report");
  command->add_flag("--quiet", options->is_quiet, "Print errors only");
  add_set_option(*command, *keys);
  run_with_keys(*command, options, keys, benchmark, console, action);
}

void add_scan(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand("scan", "Simulate a LiDAR or depth camera along a route");
  const auto options = std::make_shared<ScanCommandOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  command->add_option("mission", options->mission, "Mission file (docs/howto/simulate-lidar.md)")
      ->required();
  command->add_option(
      "--route", options->route,
      "Route file, or folder of a mission package (default: from the mission file)");
  command->add_option("--sensor", options->sensor,
                      "Sensor preset or file NAME.yaml; overrides the mission file");
  command->add_option("--out", options->out, "Folder for the results (default: results/NAME/scan)");
  command
      ->add_option(
          "--format", options->formats,
          "Point formats, one or more of " + scan::cloud_format_names() + " (default: las)")
      ->delimiter(',');
  command->add_flag("--with-truth", options->with_truth,
                    "Also write the points at their true positions (ground truth)");
  CLI::Option* const resumes = command->add_flag(
      "--resume", options->resumes, "Resume an interrupted scan in the results folder");
  command
      ->add_option("--pieces", options->shards,
                   "Number of pieces to split the flight into; does not affect the merged result")
      ->check(CLI::Range(1, 1'000'000))
      ->excludes(resumes);
  add_task_options(*command, options->task, "piece");
  command->add_flag("!--no-report", options->has_report, "Do not write the HTML report");
  command->add_option("--seed", keys->seed, "Random seed; overrides the mission file");
  command->add_option("--threads", keys->threads, "Number of threads (0: all processors)");
  command->add_flag("--quiet", options->is_quiet, "Print errors only");
  add_set_option(*command, *keys);
  run_with_keys(*command, options, keys, scan, console, action);
}

void add_check(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("check", "Check a mission file, or verify the clearance of a route file");
  const auto options = std::make_shared<CheckOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  const auto prints_schema = std::make_shared<bool>(false);
  const auto prints_keys = std::make_shared<bool>(false);
  const auto rewritten = std::make_shared<std::filesystem::path>();
  command->add_option("mission", options->mission, "Mission file");
  command->add_option(
      "--route", options->route,
      "Verify that this route (.plan, .waypoints, .kmz, .kml, .geojson, .csv, .tum) "
      "keeps flight.clearance from the scene");
  command
      ->add_option("--return-altitude", options->return_height,
                   "Return (RTL/RTH) altitude set on the vehicle, in metres above take-off")
      ->check(CLI::Range(0.0, 10'000.0));
  add_set_option(*command, *keys);
  command->add_flag("--schema", *prints_schema, "Print the JSON Schema of mission files");
  command->add_flag("--keys", *prints_keys, "Print the table of all keys");
  command->add_flag("--setup", options->prints_setup,
                    "Print all keys, with defaults and derived values, as YAML");
  command->add_option("--rewrite", *rewritten,
                      "Write the mission with the current names of keys and values to this file");
  command->callback([=, &console, &action] {
    options->overrides = keys->overrides();
    action = [=, &console] {
      if (*prints_schema) return console.out << config::mission_json_schema(), 0;
      if (*prints_keys) return console.out << config::mission_key_table(), 0;
      if (options->mission.empty()) {
        throw Error(ErrorKind::bad_usage, "check: missing argument: mission file");
      }
      if (!rewritten->empty()) return rewrite(options->mission, *rewritten, console);
      warn_deprecated_names(collect_files(*options), options->overrides, console);
      return check(*options, console);
    };
  });
}

void add_fly_test(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand(
      "fly-test", "Simulate a planned flight many times with wind and failsafes");
  const auto options = std::make_shared<FlyTestCommandOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  command->add_option("package", options->package, "Results folder of plan")->required();
  command
      ->add_option("--flights", options->flights, "Simulated flights per route file (default: 100)")
      ->check(CLI::Range(1, 1'000'000));
  command
      ->add_option("--returns", options->returns,
                   "Simulated returns from random positions (default: 1000; 0: none)")
      ->check(CLI::Range(0, 100'000'000));
  command
      ->add_option("--wind", options->wind_speed,
                   "Maximum steady wind in m/s, to which gusts are added (default: the mission's, "
                   "at least 5)")
      ->check(number_between(0.0, 100.0));
  command
      ->add_option(
          "--position-error", options->position_error,
          "Maximum position error of the GNSS receiver in metres (default: from the mission)")
      ->check(number_between(0.0, 1000.0));
  command
      ->add_option("--return-altitude", options->return_height,
                   "Return (RTL/RTH) altitude set on the vehicle, in metres above take-off")
      ->check(number_between(0.0, 10'000.0));
  command->add_option(
      "--truth", options->truth,
      "Mission file with a scene (ground truth) that the flights are also checked against");
  command->add_option("--out", options->out, "Folder for fly_test.json (default: the package)");
  command->add_option("--seed", keys->seed, "Random seed; overrides the mission file");
  command->add_option("--threads", keys->threads, "Number of threads (0: all processors)");
  command->add_flag("--quiet", options->is_quiet, "Print errors only");
  add_set_option(*command, *keys);
  run_with_keys(*command, options, keys, fly_test, console, action);
}

void add_calibrate(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand("calibrate", "Fit a vehicle file to a flight log");
  const auto options = std::make_shared<CalibrateOptions>();
  command->add_option("log", options->log, "ArduPilot dataflash log (.bin), or .csv")->required();
  command->add_option("--vehicle", options->vehicle, "Preset to inherit from, such as m350_rtk")
      ->required();
  command
      ->add_option("--mass", options->mass,
                   "Take-off mass in kg, with payload (default: from the preset)")
      ->check(number_between(0.01, 1000.0));
  command
      ->add_option("--battery", options->battery_wh,
                   "Battery capacity in Wh (default: from the preset)")
      ->check(number_between(0.1, 1e5));
  command
      ->add_option("--air-density", options->air_density,
                   "Air density during the flight in kg/m^3 (default: 1.225)")
      ->check(number_between(0.4, 1.9));
  command->add_option("--out", options->out, "Vehicle file (default: LOG.yaml)");
  run(*command, options, calibrate, console, action);
}

void add_evaluate(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("evaluate", "Evaluate a point cloud, a mesh or an inspection flight");
  const auto options = std::make_shared<EvaluateOptions>();
  CLI::App* what = command->add_option_group("evaluated data");
  what->add_option("--cloud", options->cloud, "Point cloud: .ply, .pcd, .las, .laz, .e57 or .xyz");
  what->add_option("--mesh", options->mesh,
                   "Mesh instead of a cloud, for example from skycap reconstruct");
  what->add_option("--flight", options->flight,
                   "Flight instead of a cloud: CSV file with t,x,y,z,yaw,pitch; --model must be an "
                   "inspection mission");
  what->require_option(1);
  CLI::App* reference = command->add_option_group("reference data");
  reference->add_option(
      "--model", options->model,
      "Reference: a mesh, builtin:NAME, model:NAME, or a mission file for its scene");
  CLI::Option* const cloud =
      reference->add_option("--reference", options->reference,
                            "Reference: an earlier cloud of the same building (M3C2 distances)");
  reference->require_option(1);
  command->add_flag("--align", options->is_aligned, "Align the cloud with --reference first")
      ->needs(cloud);
  const auto add_length = [&](const char* name, double& value, const char* description,
                              double min) {
    command->add_option(name, value, description)->check(number_between(min, 1000.0))->needs(cloud);
  };
  add_length("--cylinder", options->cylinder,
             "M3C2: cylinder diameter d in metres (default: ten point spacings)", 1e-3);
  add_length("--normal-scale", options->normal_scale,
             "M3C2: normal scale D in metres (default: two cylinder diameters)", 1e-3);
  add_length("--max-change", options->max_change,
             "M3C2: maximum distance searched in metres (default: five cylinder diameters)", 1e-3);
  add_length("--registration-error", options->registration_error,
             "M3C2: registration error of the clouds in metres (default: 0)", 0.0);
  command->add_option("--distance", options->distance, "Coverage distance in metres")
      ->check(number_between(1e-6, 1e9));
  command->add_option("--samples", options->samples, "Number of surface samples (default: 100000)")
      ->check(CLI::Range(100, 10'000'000));
  command
      ->add_option("--pieces", options->shards,
                   "Number of pieces to split the cloud into; does not affect the result")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--out", options->out,
                      "Folder for the pieces and the merged evaluation.json, or for the "
                      "results of --reference");
  add_task_options(*command, options->task, "piece");
  command->add_option("--threads", options->threads, "Number of threads (0: all processors)")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--json", options->is_json, "Print the result as JSON");
  command->add_flag("--quiet", options->is_quiet, "Print errors only");
  command->add_option("--density", options->density,
                      "Folder for the point density: raster (GeoTIFF), histograms and fractions");
  command
      ->add_option(
          "--density-cell", options->density_cell,
          "Cell size of the raster, and radius around each surface sample, in metres (default: "
          "0.5)")
      ->check(number_between(0.01, 100.0));
  command
      ->add_option("--min-density", options->min_density,
                   "Required points per square metre (default: 100)")
      ->check(number_between(0.0, 1e9));
  run(*command, options, evaluate, console, action);
}

void add_convert(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand("convert", "Convert a point cloud to another format");
  const auto options = std::make_shared<ConvertOptions>();
  command
      ->add_option("in", options->in,
                   "Point cloud: .ply, .pcd, .las, .laz, .e57, .xyz, .txt, .asc, .pts or .csv")
      ->required();
  command
      ->add_option("out", options->out,
                   "Output file: .ply, .pcd, .las, .laz, .e57, .xyz, .txt, .asc or .csv")
      ->required();
  command
      ->add_option("--shift", options->shift,
                   "X, Y and Z added to all coordinates, in the unit of the file (default: 0 0 0)")
      ->check(number_between(-1e8, 1e8));
  command->add_option("--crs", options->crs,
                      "File with the reference system of the output as WKT, for example .prj");
  command->add_flag("--quiet", options->is_quiet, "Print errors and warnings only");
  run(*command, options, convert_cloud, console, action);
}

void add_reconstruct(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("reconstruct", "Reconstruct a surface mesh from a point cloud (Poisson)");
  const auto options = std::make_shared<ReconstructOptions>();
  command
      ->add_option("cloud", options->cloud,
                   "Point cloud (.ply, .pcd, .las, .laz, .e57, .xyz), with or without normals")
      ->required();
  command->add_option("--out", options->out, "PLY, OBJ, STL or OFF file (default: CLOUD_mesh.ply)");
  command->add_option("--spacing", options->spacing, "Voxel size for downsampling in metres")
      ->check(number_between(0.0, 1e6));
  command
      ->add_option("--depth", options->depth,
                   "Octree depth: 2^depth cells per side (default: from the point spacing)")
      ->check(CLI::Range(0, 12));
  command
      ->add_option("--trim", options->min_density,
                   "Remove surface whose point density is below this fraction of the typical "
                   "density (default: 0.2)")
      ->check(number_between(0.0, 0.99));
  command->add_option("--threads", options->threads, "Number of threads (0: all processors)")
      ->check(CLI::Range(0, 1024));
  run(*command, options, reconstruct_cloud, console, action);
}

void add_report(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand("report", "Write the HTML report of a results folder");
  const auto options = std::make_shared<ReportOptions>();
  command->add_option("folder", options->folder, "Results folder of plan, scan or benchmark")
      ->required();
  command->add_option("--out", options->out, "HTML file (default: in the folder)");
  command
      ->add_option("--points", options->points,
                   "Maximum number of points in the report (default: 1000000)")
      ->check(CLI::Range(1, 100'000'000));
  run(*command, options, report_results, console, action);
}

void add_view(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("view", "Open results, a point cloud or a mission in the browser");
  const auto options = std::make_shared<ViewOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  command
      ->add_option(
          "what", options->what,
          "Results folder, point cloud (.ply, .pcd, .las, .laz, .e57, .xyz), or mission file")
      ->required();
  command->add_option("--out", options->out, "HTML file (default: next to the input)");
  command->add_option("--background", options->background,
                      "Orthophoto or map as the ground of the 3-D view of a mission or of results "
                      "(GeoTIFF, JPEG 2000)");
  add_set_option(*command, *keys);
  run_with_keys(*command, options, keys, view, console, action);
}

void add_completion(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("completion", "Print a shell script that completes commands and options");
  const auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([=, &app, &console, &action] {
    action = [=, &app, &console] {
      console.out << completion_script(app, *shell) << std::flush;
      return 0;
    };
  });
}

/// Prints a one-line error message, even if `message` contains line feeds. Returns `exit_code`.
int report_failure(const Console& console, const std::string& message, int exit_code) {
  console.err << "skycap: error: " << printable_line(message) << "\n" << std::flush;
  return exit_code;
}

/// Returns the remedy for an unknown command.
std::string command_advice(const std::string& word, const std::vector<std::string>& known,
                           const std::string& commands) {
  std::string similar = support::find_similar(word, known);
  if (word == "help" || word == "version") similar = "--" + word;
  return similar.empty() ? "expected one of: " + commands : "did you mean '" + similar + "'?";
}

/// Returns the message for arguments that are not expected. It suggests the most similar option of
/// the command.
std::string unexpected_text(const CLI::App& app, const CLI::ExtrasError& failure) {
  std::vector<std::string> names;
  std::vector<const CLI::App*> parts{&app};
  for (const CLI::App* command : app.get_subcommands()) parts.push_back(command);
  for (const CLI::App* part : parts) {
    for (const CLI::Option* option : part->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  for (const std::string& extra : app.remaining(true)) {
    if (!extra.starts_with("--")) continue;
    const std::string word = extra.substr(0, extra.find('='));
    const std::string similar = support::find_similar(word, names);
    return "unknown option '" + word + "'" +
           (similar.empty() ? "; see --help" : "; did you mean '" + similar + "'?");
  }
  return std::string(failure.what()) + "; see --help";
}

int parse_and_run(const std::vector<std::string>& arguments, Console console) {
  CLI::App app("Skycap plans and simulates aerial surveys of buildings.", "skycap");
  app.set_version_flag("--version", build_text(), "Print version, commit, compiler and build");
  app.require_subcommand(0, 1);
  app.get_formatter()->column_width(28);
  app.fallthrough();  // verbs take the options below, too
  std::string progress = "auto";
  app.add_option("--progress", progress,
                 "Progress: auto (default, one line on a terminal), plain (lines with times, for "
                 "logs) or none")
      ->check(CLI::IsMember({"auto", "plain", "none"}));
  Action action;
  try {
    // Allows tests to emulate processors with fewer instruction sets.
    // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets variables
    if (const char* const widest = std::getenv("SKYCAP_INSTRUCTION_SET")) {
      geometry::limit_instruction_set(widest);
    }
    add_plan(app, console, action);
    add_site(app, console, action);
    add_init(app, console, action);
    add_live(app, console, action);
    add_benchmark(app, console, action);
    add_campaign(app, console, action);
    add_district(app, console, action);
    add_scan(app, console, action);
    add_check(app, console, action);
    add_export(app, console, action);
    add_fly_test(app, console, action);
    add_calibrate(app, console, action);
    add_compare(app, console, action);
    add_evaluate(app, console, action);
    add_convert(app, console, action);
    add_reconstruct(app, console, action);
    add_model(app, console, action);
    add_report(app, console, action);
    add_view(app, console, action);
    add_studio(app, console, action);
    add_presets(app, console, action);
    add_completion(app, console, action);
    std::vector<std::string> known;
    std::string commands;
    for (const CLI::App* command : app.get_subcommands({})) {
      known.push_back(command->get_name());
      commands += (commands.empty() ? "" : ", ") + command->get_name();
    }
    if (!arguments.empty() && !arguments[0].starts_with('-') &&
        std::ranges::find(known, arguments[0]) == known.end()) {
      throw Error(ErrorKind::bad_usage, "unknown command '" + arguments[0] + "'; " +
                                            command_advice(arguments[0], known, commands));
    }
    std::vector<std::string> reversed = with_current_options(arguments, console);
    std::ranges::reverse(reversed);  // CLI11 expects reversed arguments
    app.parse(reversed);
    if (!action) {
      throw Error(ErrorKind::bad_usage,
                  "no command given; expected one of: " + commands + "; see --help");
    }
    if (progress == "plain") console.progress = ProgressMode::plain;
    if (progress == "none") console.progress = ProgressMode::none;
    return action();
  } catch (const CLI::Success& success) {  // --help or --version
    return app.exit(success, console.out, console.err);
  } catch (const CLI::ExtrasError& failure) {
    return report_failure(console, unexpected_text(app, failure), 2);
  } catch (const CLI::ParseError& failure) {
    return report_failure(console, std::string(failure.what()) + "; see --help", 2);
  } catch (const Interrupted&) {
    console.err << "skycap: interrupted\n" << std::flush;
    return interrupted_exit_code(console);
  } catch (const Error& failure) {
    return report_failure(console, failure.what(), 2);
  } catch (const std::filesystem::filesystem_error& failure) {
    // System errors for user paths, such as symbolic link loops or missing permissions.
    const std::string text = failure.path1().string() + ": " + failure.code().message();
    return report_failure(console, text, 2);
  } catch (const std::bad_alloc&) {
    return report_failure(console, "out of memory", 3);
  } catch (const std::exception& failure) {
    return report_failure(console, std::string("internal error: ") + failure.what(), 3);
  }
}

}  // namespace

int run_command_line(const std::vector<std::string>& arguments, const Console& console) {
  PrintableBuffer buffer(*console.out.rdbuf());
  std::ostream out(&buffer);
  const int exit_code = parse_and_run(
      arguments, {out, console.err, console.err_is_terminal, console.stop, console.results_held,
                  console.termination_signal, console.progress});
  if (out.flush()) return exit_code;
  return report_failure(console, "cannot write to standard output", 3);
}

}  // namespace skycap::missions::cli
