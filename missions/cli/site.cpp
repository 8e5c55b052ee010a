#include <array>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/command_options.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/report/cloud_page.h"
#include "missions/site_data/file_reader.h"
#include "missions/site_data/prior_text.h"
#include "missions/wizard/proposal.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

/// Altitude references supported without a pad.
constexpr std::array datums{site_data::HeightDatum::ellipsoid, site_data::HeightDatum::geoid};

struct SiteOptions {
  fs::path map;  ///< file with the target and its neighbours
  /// Identifiers of the target; one of `ids`, `at` and `attributes` is required.
  std::vector<std::string> ids;
  std::string at;                       ///< LATITUDE,LONGITUDE of a position on the target
  std::vector<std::string> attributes;  ///< KEY=VALUE attributes, all of which the target must have
  std::string crs, vertical;            ///< values of prior.crs and prior.vertical
  std::optional<double> base, height;   ///< values of prior.base and prior.height
  std::optional<fs::path> terrain;
  std::vector<fs::path> obstacles;
  std::string vehicle = "generic";
  std::optional<fs::path> out;  ///< mission file; default: site.yaml
};

[[noreturn]] void reject(const std::string& option, const std::string& requested,
                         const std::string& expected) {
  throw Error(ErrorKind::bad_usage, option + " is " + requested + "; it must be " + expected);
}

wizard::Pick make_pick(const SiteOptions& options) {
  wizard::Pick pick{.ids = options.ids, .attributes = {}, .click = {}};
  if (!options.at.empty()) {
    pick.click = wizard::click_in(options.at);
    if (!pick.click) reject("--at", options.at, wizard::click_form);
  }
  for (const std::string& pair : options.attributes) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos) reject("--attribute", pair, "KEY=VALUE");
    pick.attributes[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  const int source_count =
      (pick.ids.empty() ? 0 : 1) + (pick.attributes.empty() ? 0 : 1) + (pick.click ? 1 : 0);
  if (source_count > 1) {
    throw Error(ErrorKind::bad_usage,
                "--id, --at and --attribute exclude each other; use one of them");
  }
  return pick;
}

wizard::SiteRequest to_site_request(const SiteOptions& options) {
  wizard::SiteRequest request{.map = options.map,
                              .target = make_pick(options),
                              .import_options = {.crs = options.crs,
                                                 .vertical = {},
                                                 .base = options.base,
                                                 .height = options.height},
                              .terrain = options.terrain,
                              .obstacles = options.obstacles,
                              .vehicle = options.vehicle};
  for (const site_data::HeightDatum datum : datums) {
    if (options.vertical == to_string(datum)) request.import_options.vertical = datum;
  }
  return request;
}

std::string make_page(const std::string& name, const evaluation::SimulationOptions& options,
                      const fs::path& file) {
  constexpr unsigned all_processors = 0;
  const evaluation::SurveyScene scene(options, file.parent_path(), all_processors);
  return report::mission_page(name, options.survey, options.scene, scene.samples().points,
                              options.survey.flight.takeoff);
}

/// Writes a first mission file and its HTML report. Existing files are not overwritten.
int propose_site(const SiteOptions& options, const Console& console) {
  const fs::path file = options.out.value_or("site.yaml");
  if (file.extension() != ".yaml" && file.extension() != ".yml") {
    reject("--out", file.string(), "a name that ends in .yaml");
  }
  const fs::path page_path = fs::path(file).replace_extension(".html");
  // Opened first, because the mission's file names are relative to the folder. This also completes
  // an interrupted commit.
  geometry::OutputFolder folder(file.has_parent_path() ? file.parent_path() : ".");
  for (const fs::path& result : {file, page_path}) {
    if (!fs::exists(result)) continue;
    throw Error(ErrorKind::bad_usage,
                result.string() + " already exists; use another --out or move the file");
  }
  ProgressLine progress(console, false);
  progress.show("reading " + options.map.filename().string());
  const site_data::ReadOnce once;
  const std::string text = wizard::propose_mission(to_site_request(options), file);
  progress.show("drawing the map");
  const config::MissionSetup setup = config::parse_mission(text, file.string());
  const std::string page = make_page(setup.name, setup.simulation, file);
  progress.clear();
  folder.write(file.filename().string(), text);
  folder.write(page_path.filename().string(), page);
  folder.commit();
  const Eigen::Vector3d pad = setup.flight().takeoff.value();
  console.out << fmt::format("{}: a first mission for {}\n", file.string(), setup.name)
              << site_data::format_priors(*setup.scene().priors)
              << fmt::format("  pad       {:g} {:g} {:g}\n", pad.x(), pad.y(), pad.z())
              << "  map       " << page_path.string() << "\n"
              << "  next      skycap plan " << file.string() << "\n"
              << std::flush;
  return 0;
}

}  // namespace

void add_site(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand(
      "site", "Create a mission file from a map, city model, terrain model or point cloud");
  const auto options = std::make_shared<SiteOptions>();
  command
      ->add_option("map", options->map,
                   "File with the target and its surroundings (docs/reference/prior-formats.md)")
      ->required();
  command->add_option("--id", options->ids, "Target by its name in the file; repeatable")
      ->type_size(1)
      ->allow_extra_args(false);
  command->add_option("--at", options->at, "Target by position: LATITUDE,LONGITUDE");
  command
      ->add_option("--attribute", options->attributes,
                   "Target by attribute KEY=VALUE, such as a part of its address; repeatable")
      ->type_size(1)
      ->allow_extra_args(false);
  command->add_option("--crs", options->crs,
                      "Coordinate reference system of the files, if they do not contain one");
  command
      ->add_option("--vertical", options->vertical,
                   "Vertical datum of the files, if they do not contain one: ellipsoid or geoid")
      ->check(CLI::IsMember({to_string(datums[0]), to_string(datums[1])}));
  command
      ->add_option("--base", options->base,
                   "Base height of outlines in the datum of --vertical, in metres")
      ->check(number_between(-1e4, 1e4));
  command
      ->add_option("--height", options->height,
                   "Height of outlines that contain no height, in metres")
      ->check(number_between(0.01, 1e4));
  command->add_option("--terrain", options->terrain,
                      "Terrain file; sets the base height of outlines");
  command->add_option("--obstacle", options->obstacles, "Further file with obstacles")
      ->type_size(1)
      ->allow_extra_args(false);
  command->add_option("--vehicle", options->vehicle, "Vehicle preset or file (default: generic)");
  command->add_option("--out", options->out, "Mission file (default: site.yaml)");
  run(*command, options, propose_site, console, action);
}

}  // namespace skycap::missions::cli
