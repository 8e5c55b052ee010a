#include "missions/cli/compare.h"

#include <memory>
#include <string_view>

#include <CLI/App.hpp>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/write_page.h"
#include "missions/comparison/flight_comparison.h"

namespace skycap::missions::cli {

int compare(const CompareOptions& options, const Console& console) {
  ProgressLine progress(console, options.is_quiet);
  comparison::CompareRequest request{
      .folder = options.package,
      .logs = options.logs,
      .routes = options.routes,
      .truth = options.truth,
      .cloud = options.cloud,
      .comparison = {.max_deviation = options.max_deviation},
      .heights = options.heights == "takeoff"    ? flight::TrackHeights::takeoff
                 : options.heights == "absolute" ? flight::TrackHeights::absolute
                                                 : flight::TrackHeights::automatic,
      .overrides = options.overrides};
  const bool has_plan = !std::filesystem::is_regular_file(options.package);
  if (!has_plan && !options.routes.empty()) {
    throw Error(ErrorKind::bad_usage,
                "--route needs the results folder of a plan instead of a mission file");
  }
  const std::filesystem::path results =
      has_plan ? options.package : std::filesystem::path("results") / options.package.stem();
  geometry::OutputFolder folder(options.out.value_or(results / "compare"));
  folder.replace([](std::string_view name) {
    return name == comparison::comparison_name || name == comparison::surface_name ||
           name.starts_with(comparison::patch_stem);
  });
  const comparison::FlightComparison found = comparison::compare_flight(
      request, folder, [&](const std::string& what) { progress.show(what); }, console.stop);
  comparison::stage_comparison(found, request, folder);
  write_page(comparison::comparison_name, options.has_report, folder, console);
  folder.commit();
  progress.clear();
  if (!options.is_quiet) {
    console.out << comparison::comparison_text(found) << "  results   " << folder.path().string()
                << "\n"
                << std::flush;
  }
  const bool is_complete =
      found.num_flown_legs() == found.plan.legs.size() && found.num_missed_captures() == 0;
  return is_complete ? 0 : 1;
}

void add_compare(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand(
      "compare", "Compare flight logs with their mission and plan the missed views");
  const auto options = std::make_shared<CompareOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  command
      ->add_option("package", options->package,
                   "Results folder of plan; without a plan, a mission file")
      ->required();
  command
      ->add_option("logs", options->logs,
                   "Flight logs in flight order: ArduPilot .bin, PX4 .ulg, .tum, .csv, DJI .MRK, "
                   ".gpx or .srt")
      ->required();
  command
      ->add_option("--route", options->routes,
                   "Route file that was flown; repeatable (default: the files of the mission's "
                   "vehicle)")
      ->type_size(1)
      ->allow_extra_args(false);
  command
      ->add_option("--max-deviation", options->max_deviation,
                   "Maximum distance from the plan in metres at which a leg or capture counts as "
                   "flown (default: 3)")
      ->check(number_between(0.01, 1000.0));
  command
      ->add_option("--heights", options->heights,
                   "Height of the log to use: auto, takeoff or absolute (default: auto)")
      ->check(CLI::IsMember({"auto", "takeoff", "absolute"}));
  command->add_option("--truth", options->truth,
                      "Mission file whose scene is used as ground truth (default: the scene of the "
                      "mission)");
  command->add_option("--cloud", options->cloud,
                      "Cloud in the mission's frame whose distance is measured (default: that of "
                      "the results folder)");
  command->add_option("--out", options->out,
                      "Output folder (default: compare in the results folder of the mission)");
  command->add_option("--threads", keys->threads, "Number of threads (0: all processors)");
  command->add_flag("!--no-report", options->has_report, "Do not write the HTML report");
  command->add_flag("--quiet", options->is_quiet, "Print errors only");
  add_set_option(*command, *keys);
  run_with_keys(*command, options, keys, compare, console, action);
}

}  // namespace skycap::missions::cli
