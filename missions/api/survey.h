/// A whole survey of a mission's scene, as `skycap plan` makes it.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "geometry/points/point_cloud.h"
#include "missions/api/mission.h"
#include "survey/survey_loop.h"

namespace skycap::missions::api {

struct SurveyRequest {
  /// Where to write the mission package, the same bytes that `skycap plan --out` writes but for
  /// times. Nothing: nowhere; a mission with a vehicle then has no route.
  std::optional<std::filesystem::path> folder;
  /// Told of each view and of the covered share after it, on the thread that plans. May be empty.
  std::function<void(const survey::SurveyedView&, double coverage)> report;
  std::stop_token stop;  ///< ends the survey after the view that is being planned
};

struct Survey {
  survey::StopReason end = survey::StopReason::complete;
  std::vector<survey::SurveyedView> views;
  std::vector<double> coverages;  ///< covered share of the surface after each view
  geometry::PointCloud cloud;
  std::optional<double> visible_coverage;     ///< share of what admissible views can see
  std::optional<double> attainable_coverage;  ///< share of the surface that could be covered at all
  std::string summary;                        ///< the text of summary.json
  std::string failure;                        ///< why there is no route; empty if none is missing

  double coverage() const { return coverages.empty() ? 0.0 : coverages.back(); }
};

/// Surveys the scene in simulation. Throws Error, naming the mission, for what is wrong with the
/// scene or the folder. An interrupted survey in a folder with a complete one goes into a folder
/// `interrupted` within it.
Survey plan(const Mission& mission, const SurveyRequest& request = {});

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< the name in programs of users
}
