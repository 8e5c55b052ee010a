#include <skycap/missions/survey.h>

#include "example.h"

// Runs a complete survey of two views without writing files.
const Example survey_example("missions/survey", [] {
  const auto mission = skycap::missions::library::Mission::parse(
      "scene: {model: builtin:teapot, longest_side: 1}\n"
      "limits: {max_views: 2}\n"
      "evaluation: {coverage_distance: 0.005, attainable_views: 0}\n",
      "teapot.yaml");
  const auto survey = skycap::missions::library::plan(mission);
  return survey.views.size() == 2 && survey.end == skycap::survey::StopReason::view_limit &&
         survey.coverage() > 0.1;
});
