#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/command_options.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/report/cloud_page.h"
#include "missions/report/object_map.h"
#include "missions/site_data/file_reader.h"
#include "missions/site_data/prior_text.h"
#include "missions/wizard/photo_proposal.h"
#include "missions/wizard/proposal.h"
#include "missions/wizard/target.h"

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
  std::string base;              ///< value of prior.base, or "ground": height of the take-off point
  std::optional<double> height;  ///< value of prior.height
  std::optional<fs::path> terrain;
  std::vector<fs::path> obstacles;
  std::string vehicle;          ///< preset or file; empty: that of the photo camera, or generic
  std::string sensor;           ///< preset or file; empty: the vehicle's camera
  std::optional<double> gsd;    ///< ground sampling distance of a photo camera [m]
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
                "--id, --at and --attribute are mutually exclusive; use one of them");
  }
  return pick;
}

/// The height of outlines, and what it counts from.
void read_base(const SiteOptions& options, wizard::ImportOptions& import_options) {
  if (options.base.empty()) return;
  if (options.base == "ground") {
    if (import_options.vertical || options.terrain) {
      throw Error(ErrorKind::bad_usage,
                  "--base ground conflicts with --vertical and --terrain; remove one of them");
    }
    import_options.base = 0.0;
    import_options.vertical = site_data::HeightDatum::takeoff;
    return;
  }
  constexpr double farthest = 1e4;
  double base = 0.0;
  if (!CLI::detail::lexical_cast(options.base, base) || !(std::abs(base) <= farthest)) {
    reject("--base", options.base, "ground or a height from -10000 to 10000 m");
  }
  import_options.base = base;
}

/// Throws if only one of photo camera and ground sampling distance is set.
void check_photo_options(const SiteOptions& options) {
  if (options.gsd && options.sensor.empty()) {
    throw Error(
        ErrorKind::bad_usage,
        "--gsd requires a photo camera; set --sensor to a photo camera listed by skycap presets");
  }
  if (!options.gsd && wizard::is_photo_camera(options.sensor)) {
    throw Error(ErrorKind::bad_usage, "--sensor " + options.sensor +
                                          " is a photo camera and requires a ground sampling "
                                          "distance; set --gsd, such as --gsd 0.005");
  }
}

std::string make_vehicle(const SiteOptions& options) {
  if (!options.vehicle.empty()) return options.vehicle;
  return options.gsd ? wizard::find_photo_vehicle(options.sensor) : "generic";
}

wizard::SiteRequest to_site_request(const SiteOptions& options) {
  check_photo_options(options);
  wizard::SiteRequest request{
      .map = options.map,
      .target = make_pick(options),
      .import_options = {.crs = options.crs, .vertical = {}, .base = {}, .height = options.height},
      .terrain = options.terrain,
      .obstacles = options.obstacles,
      .vehicle = make_vehicle(options),
      .sensor = options.sensor,
      .gsd = options.gsd};
  for (const site_data::HeightDatum datum : datums) {
    if (options.vertical == to_string(datum)) request.import_options.vertical = datum;
  }
  read_base(options, request.import_options);
  return request;
}

std::string make_page(const std::string& name, const evaluation::SimulationOptions& options,
                      const fs::path& file) {
  if (options.scene.model.empty()) {  // a photo mission: its target is prior data alone
    return report::mission_page(name, options.survey, options.scene,
                                report::target_points(options.scene),
                                options.survey.flight.takeoff);
  }
  constexpr unsigned all_processors = 0;
  const evaluation::SurveyScene scene(options, file.parent_path(), all_processors);
  return report::mission_page(name, options.survey, options.scene, scene.samples().points,
                              options.survey.flight.takeoff);
}

/// In single quotes, unless a POSIX shell takes it for one word anyway.
std::string shell_word(const std::string& text) {
  constexpr const char* plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./:,+=@%";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

/// The command that was given, without a target.
std::string make_command(const SiteOptions& options) {
  std::string command = "skycap site " + shell_word(options.map.string());
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) command += std::string(" ") + option + " " + shell_word(value);
  };
  add("--crs", options.crs), add("--vertical", options.vertical), add("--base", options.base);
  if (options.height) add("--height", fmt::format("{:g}", *options.height));
  if (options.terrain) add("--terrain", options.terrain->string());
  for (const fs::path& obstacle : options.obstacles) add("--obstacle", obstacle.string());
  add("--vehicle", options.vehicle);
  add("--sensor", options.sensor);
  if (options.gsd) add("--gsd", fmt::format("{:g}", *options.gsd));
  if (options.out) add("--out", options.out->string());
  return command;
}

/// Writes a page with the objects of the map if there are several, so that the user can choose one.
/// Returns exit code 1 in that case, because no mission has been written.
std::optional<int> show_objects(const SiteOptions& options, const wizard::SiteRequest& request,
                                const fs::path& file, geometry::OutputFolder& folder,
                                const Console& console) {
  if (!request.target.ids.empty() || !request.target.attributes.empty() || request.target.click) {
    return std::nullopt;
  }
  const std::vector<site_data::Object> objects =
      wizard::list_things(wizard::collect_files(request));
  if (objects.size() <= 1) return std::nullopt;
  const fs::path page = fs::path(file).replace_extension(".objects.html");
  folder.write(page.filename().string(),
               report::object_map(options.map.filename().string(), objects, make_command(options)));
  folder.commit();
  std::string some;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, objects.size()); ++i) {
    some += (i == 0 ? "" : ", ") + objects[i].id;
  }
  console.out
      << fmt::format(
             "{}: contains {} objects, {}{}; no mission written\n  map       {}\n  next      "
             "open the map and click the target, or choose it with --at "
             "LATITUDE,LONGITUDE, --id or --attribute\n",
             options.map.string(), objects.size(), some, objects.size() > 5 ? ", ..." : "",
             page.string())
      << std::flush;
  return 1;
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
  const wizard::SiteRequest request = to_site_request(options);
  if (const auto shown = show_objects(options, request, file, folder, console)) return *shown;
  const std::string text = wizard::propose_mission(request, file);
  const bool is_datum_assumed = wizard::assumes_geoid(request);
  progress.show("drawing the map");
  const config::MissionSetup setup = config::parse_mission(text, file.string());
  const std::string page = make_page(setup.name, setup.simulation, file);
  progress.clear();
  folder.write(file.filename().string(), text);
  folder.write(page_path.filename().string(), page);
  folder.commit();
  if (is_datum_assumed) {
    warn(console, options.map.string() +
                      ": missing vertical datum; heights are assumed to be AMSL (EGM96). Set "
                      "--vertical if they are not");
  }
  const Eigen::Vector3d pad = setup.flight().takeoff.value();
  console.out << fmt::format("{}: first mission for {}\n", file.string(), setup.name)
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
      "site", "Create a mission file from a map, city model or mesh, and its surroundings");
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
  command->add_option(
      "--crs", options->crs,
      "Coordinate reference system; overrides that of the map and applies to files that do not "
      "specify one");
  command
      ->add_option("--vertical", options->vertical,
                   "Vertical datum of files that do not specify one: ellipsoid or geoid")
      ->check(CLI::IsMember({to_string(datums[0]), to_string(datums[1])}));
  command->add_option("--base", options->base,
                      "Base height of outlines in metres, in the datum of --vertical, or ground: "
                      "the height of the take-off point");
  command
      ->add_option("--height", options->height,
                   "Height in metres for outlines without a height attribute")
      ->check(number_between(0.01, 1e4));
  command->add_option("--terrain", options->terrain,
                      "Terrain file; sets the base height of outlines");
  command->add_option("--obstacle", options->obstacles, "Further file with obstacles")
      ->type_size(1)
      ->allow_extra_args(false);
  command->add_option("--vehicle", options->vehicle,
                      "Vehicle preset or file (default: the preset that carries the photo camera, "
                      "otherwise generic)");
  command->add_option(
      "--sensor", options->sensor,
      "Sensor preset (skycap presets) or LiDAR file NAME.yaml (default: the vehicle's "
      "camera, otherwise a depth camera of 320 x 240 pixels). A photo camera requires --gsd");
  command
      ->add_option("--gsd", options->gsd,
                   "Ground sampling distance of a photo camera in metres; creates a photo mission")
      ->check(number_between(1e-5, 10.0));
  command->add_option("--out", options->out, "Mission file (default: site.yaml)");
  run(*command, options, propose_site, console, action);
}

}  // namespace skycap::missions::cli
