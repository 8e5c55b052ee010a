#include "flight/export/export.h"

#include "missions/flight_report.h"
#include "missions/output_folder.h"
#include "missions/package.h"
#include "missions/verbs.h"

namespace skycap::missions {

int export_package(const ExportOptions& options, const Console& console) {
  std::vector<flight::Format> formats;
  for (const std::string& name : options.formats) formats.push_back(flight::format_named(name));

  const PackagedSurvey survey = read_package(options.package, options.overrides);
  OutputFolder folder(options.out.value_or(options.package));
  SurveyMission flight;
  flight.route = plan_flight(survey.mission, survey.measured, survey.pad, survey.views);
  flight.files = stage_flight(survey.mission, flight.route, survey.measured, formats, folder);
  for (const flight::Format format : formats) {
    folder.replace([&](std::string_view name) { return is_flight_file(name, format); });
  }
  folder.commit();
  console.out << flight_text(flight) << "  results   " << folder.path().string() << "\n"
              << std::flush;
  return flight.route.sorties.empty() ? 1 : 0;
}

}  // namespace skycap::missions
