#include <cstdlib>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/cli/commands.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/package.h"
#include "missions/package/settings.h"
#include "missions/report/cloud_page.h"
#include "missions/report/page.h"
#include "missions/report/result_pages.h"
#include "missions/site_data/site_image.h"
#include "missions/support/external_program.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

report::MadePage make_mission_page(const ViewOptions& options, const config::Report& report) {
  const config::MissionSetup setup = config::read_mission(options.what, options.overrides, report);
  if (setup.scene().model.empty()) {  // a photo mission or inspection: its target is prior data
    return {options.out.value_or(fs::path("results") / setup.name / "mission.html"),
            report::mission_page(setup.name, setup.survey(), setup.scene(),
                                 report::target_points(setup.scene()), setup.flight().takeoff)};
  }
  const evaluation::SurveyScene scene(setup.simulation, options.what.parent_path(),
                                      setup.run.threads);
  const geometry::View first = scene.first_view(setup.run.seed);
  std::optional<Eigen::Vector3d> pad;
  if (setup.flight().has_vehicle()) pad = setup.flight().pad(first.position);
  return {
      options.out.value_or(fs::path("results") / setup.name / "mission.html"),
      report::mission_page(setup.name, setup.survey(), setup.scene(), scene.samples().points, pad)};
}

std::vector<report::MadePage> make_pages(const ViewOptions& options, const config::Report& report) {
  const fs::path& what = options.what;
  std::error_code ignored;
  if (fs::is_directory(what, ignored)) {
    return report::made_pages(what, report::default_report_points, options.out);
  }
  if (!options.out && !fs::exists(what, ignored)) {
    throw Error(ErrorKind::bad_file, what.string() + ": does not exist");
  }
  const std::string extension = what.extension().string();
  if (extension == ".yaml" || extension == ".yml") return {make_mission_page(options, report)};
  fs::path file = what;
  file.replace_extension(".html");
  return {{options.out.value_or(file), report::cloud_page(what)}};
}

/// Returns the mission of a mission file or of a results folder.
config::MissionSetup find_mission(const ViewOptions& options, const config::Report& report) {
  const fs::path& what = options.what;
  const std::string extension = what.extension().string();
  if (extension == ".yaml" || extension == ".yml") {
    return config::read_mission(what, options.overrides, report);
  }
  const fs::path summary = what / package::summary_name;
  std::error_code ignored;
  if (!fs::is_regular_file(summary, ignored)) {
    throw Error(ErrorKind::bad_usage,
                "--background requires a mission file or results of plan, and " + what.string() +
                    " is neither");
  }
  return package::mission_from_settings(geometry::parse_json<nlohmann::ordered_json>(
                                            geometry::read_file(summary, geometry::largest_json))
                                            .value("settings", nlohmann::ordered_json()),
                                        summary.string(), options.overrides);
}

/// Reads the part of an image around the scene and the take-off point of a mission.
site_data::SiteImage read_background(const fs::path& file, const config::MissionSetup& setup) {
  const flight::FlightOptions& flight = setup.flight();
  if (!flight.is_georeferenced) {
    throw Error(ErrorKind::bad_config,
                "--background requires site.latitude_deg and site.longitude_deg in the mission");
  }
  constexpr double margin = 100.0;  // [m]
  Eigen::AlignedBox2d box(Eigen::Vector2d::Zero());
  if (!flight.unknown_box.isEmpty()) {
    box = {flight.unknown_box.min().head<2>(), flight.unknown_box.max().head<2>()};
  }
  if (flight.takeoff) box.extend(flight.takeoff->head<2>());
  box.min().array() -= margin;
  box.max().array() += margin;
  site_data::SiteFrame site;
  site.origin = flight.site.origin;
  return site_data::read_site_image(file, site, box);
}

/// Opens a file in a browser and returns whether that succeeded. Without a display it is not tried,
/// because xdg-open would start a text browser that waits for a terminal.
bool is_opened(const fs::path& file) {
  const bool has_screen =
      std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
  if (!has_screen) return false;
  return support::start_external_program({"xdg-open", fs::absolute(file).string()});
}

}  // namespace

int view(const ViewOptions& options, const Console& console) {
  ProgressLine progress(console, false);
  progress.show("reading " + options.what.string());
  std::optional<site_data::SiteImage> background;
  if (options.background) {
    background =
        read_background(*options.background, find_mission(options, progress.progress_callback()));
  }
  for (report::MadePage& page : make_pages(options, progress.progress_callback())) {
    if (page.text && background) {
      page.text = report::with_background(std::move(*page.text), background->name, background->jpeg,
                                          background->corners);
    }
    if (page.text) geometry::write_file(page.file, *page.text);
    progress.clear();
    const bool is_shown = is_opened(page.file);
    console.out << (is_shown ? "opened in the browser: " : "open this in a browser: ")
                << page.file.string() << "\n";
  }
  return 0;
}

}  // namespace skycap::missions::cli
