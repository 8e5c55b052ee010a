#include "missions/library/survey.h"

#include <utility>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/judge/coverage.h"
#include "missions/library/mission_contents.h"
#include "missions/package/package.h"
#include "missions/run/survey_runner.h"
#include "missions/scene/survey_scene.h"

namespace skycap::missions::library {
namespace {

package::CoverageFigures figures_of(const run::SurveyRecord& record,
                                    const scene::SurveyScene& scene, unsigned threads) {
  package::CoverageFigures figures{record.coverage(), {}, {}};
  if (record.stop_reason == survey::StopReason::interrupted) return figures;
  const std::vector<std::uint8_t> is_visible = scene.visible(threads);
  figures.visible = judge::covered_share(record.is_covered, is_visible);
  figures.ceiling = scene.ceiling(is_visible, threads);
  return figures;
}

/// Writes the package.
std::optional<package::SurveyMission> write_package(const file::Mission& mission,
                                                    const run::SurveyRecord& record,
                                                    const package::CoverageFigures& figures,
                                                    geometry::OutputFolder& folder,
                                                    const std::stop_token& stop) {
  auto flight = package::stage_package(mission, record, figures, mission.threads, folder, stop);
  if (record.stop_reason == survey::StopReason::interrupted &&
      package::is_complete_result(folder.path() / package::summary_name)) {
    folder.move_to("interrupted");
  }
  folder.commit();
  return flight;
}

Survey survey_of(const Mission::Contents& contents, const SurveyRequest& request) {
  const file::Mission& mission = contents.mission;
  std::optional<geometry::OutputFolder> folder;
  if (request.folder) folder.emplace(*request.folder);
  const scene::SurveyScene scene(mission, contents.folder);
  Survey survey;
  run::SurveyRecord record = run::run_survey(mission, scene, mission.seed, mission.threads,
                                             request.stop, [&](const run::JudgedView& view) {
                                               survey.views.push_back(view.surveyed);
                                               survey.coverages.push_back(view.coverage);
                                               if (request.report)
                                                 request.report(view.surveyed, view.coverage);
                                             });
  const package::CoverageFigures figures = figures_of(record, scene, mission.threads);
  std::optional<package::SurveyMission> flight;
  if (folder) flight = write_package(mission, record, figures, *folder, request.stop);
  if (flight) survey.failure = flight->failure;
  survey.summary = package::summary_json(mission, record, figures, flight);
  survey.end = record.stop_reason;
  survey.visible_coverage = figures.visible;
  survey.attainable_coverage = figures.ceiling;
  survey.cloud = std::move(record.cloud);
  return survey;
}

}  // namespace

Survey plan(const Mission& mission, const SurveyRequest& request) {
  try {
    return survey_of(mission.contents(), request);
  } catch (const Error& error) {
    throw Error(error.kind(), mission.name() + ": " + error.what());
  }
}

}  // namespace skycap::missions::library
