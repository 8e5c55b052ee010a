#include "flight/export/export.h"

#include "geometry/io/output_folder.h"
#include "missions/derived/mission_flight.h"
#include "missions/package/flight_report.h"
#include "missions/package/package.h"
#include "missions/verbs/verbs.h"

namespace skycap::missions::verbs {

int export_package(const ExportOptions& options, const Console& console) {
  std::vector<flight::Format> formats;
  for (const std::string& name : options.formats) formats.push_back(flight::format_named(name));

  ProgressLine progress(console, false);
  progress.show("reading " + options.package.string());
  const package::PackagedSurvey survey = package::read_package(options.package, options.overrides);
  geometry::OutputFolder folder(options.out.value_or(options.package));
  progress.show(survey.mission.name + ": planning the flight");
  package::SurveyMission flight;
  flight.pictures = derived::picture_bounds_of(survey.mission);
  flight.route = package::plan_flight(survey.mission, survey.measured, survey.pad, survey.views,
                                      survey.ways, survey.grounds, console.stop);
  flight.files =
      package::stage_flight(survey.mission, flight.route, survey.measured, formats, folder);
  for (const flight::Format format : formats) {
    folder.replace([&](std::string_view name) { return package::is_flight_file(name, format); });
  }
  folder.commit();
  progress.clear();
  console.out << package::flight_text(flight) << "  results   " << folder.path().string() << "\n"
              << std::flush;
  return flight.route.sorties.empty() ? 1 : 0;
}

}  // namespace skycap::missions::verbs
