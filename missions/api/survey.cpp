#include "missions/api/survey.h"

#include <utility>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/api/mission_contents.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/package.h"
#include "missions/simulation/feasibility.h"
#include "missions/simulation/survey_runner.h"

namespace skycap::missions::api {
namespace {

Survey make_survey(const Mission::Contents& contents, const SurveyRequest& request) {
  const config::MissionSetup& setup = contents.setup;
  const unsigned threads = setup.run.threads;
  std::optional<geometry::OutputFolder> folder;
  if (request.folder) folder.emplace(*request.folder);
  const evaluation::SurveyScene scene(setup.simulation, contents.folder, threads);
  simulation::require_feasible(setup.simulation, scene, setup.run);
  Survey survey;
  session::SurveyRecord record =
      simulation::run_survey(setup.simulation, scene, setup.run.seed, threads, request.stop,
                             [&](const session::EvaluatedView& view) {
                               survey.views.push_back(view.surveyed);
                               survey.coverages.push_back(view.coverage);
                               if (request.report) request.report(view.surveyed, view.coverage);
                             });
  const package::CoverageFigures figures =
      package::coverage_figures(setup.simulation, record, scene, threads, request.stop);
  std::optional<package::SurveyMission> flight;
  if (folder) {
    flight = package::stage_package(setup, record, figures, threads, *folder, request.stop);
    package::commit_package(record, *folder);
  }
  if (flight) survey.failure = flight->failure;
  survey.summary = package::summary_json(setup, record, figures, flight);
  survey.end = record.stop_reason;
  survey.visible_coverage = figures.visible;
  survey.attainable_coverage = figures.attainable_coverage;
  survey.cloud = std::move(record.cloud);
  return survey;
}

}  // namespace

Survey plan(const Mission& mission, const SurveyRequest& request) {
  try {
    return make_survey(mission.contents(), request);
  } catch (const Error& error) {
    throw Error(error.kind(), mission.name() + ": " + error.what());
  }
}

}  // namespace skycap::missions::api
