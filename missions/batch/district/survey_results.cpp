#include "missions/batch/district/survey_results.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/io/output_folder.h"
#include "missions/package/package.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;

/// Of all things of the target together, by their area.
double coverage_in(const nlohmann::json& targets) {
  double area = 0.0, covered = 0.0;
  for (const nlohmann::json& target : targets) {
    area += target.at("area_m2").get<double>();
    covered += target.at("area_m2").get<double>() * target.at("coverage").get<double>();
  }
  return area > 0.0 ? covered / area : 0.0;
}

std::size_t bytes_in(const fs::path& folder) {
  std::size_t bytes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  return bytes;
}

}  // namespace

SurveyFigures figures_of(const fs::path& folder, const batch::TrialRecord& record) {
  geometry::finish_commit(folder);
  const fs::path file = folder / package::summary_name;
  try {
    const nlohmann::json summary =
        geometry::parse_json<nlohmann::json>(geometry::read_file(file, geometry::largest_json));
    SurveyFigures figures{.folder = folder,
                          .views = summary.at("views"),
                          .coverage = coverage_in(summary.at("targets")),
                          .coverage_visible = {},
                          .planning_time = record.trial.planning_time,
                          .wall_time = record.run.wall_time,
                          .peak_memory = record.run.peak_memory,
                          .file_bytes = bytes_in(folder),
                          .stop_reason = summary.at("stop_reason")};
    const nlohmann::json& visible = summary.at("coverage_visible");
    if (visible.is_number()) figures.coverage_visible = visible.get<double>();
    if (const auto& flight = summary.at("flight"); flight.contains("route")) {
      figures.time = flight["route"].at("duration_s");
      figures.length = flight["route"].at("length_m");
    }
    return figures;
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::bad_file, file.string() + ": is not a survey's summary (" +
                                         error.what() + "); remove its folder, and run again");
  }
}

FlightInput flight_input(const fs::path& folder) {
  package::PackagedSurvey survey = package::read_package(folder, {});
  return {std::move(survey.views), std::move(survey.grounds), std::move(survey.measured)};
}

}  // namespace skycap::missions::batch
