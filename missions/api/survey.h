/// Complete simulated survey of a mission's scene, as performed by `skycap plan`.
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
  /// Folder for the mission package. Its files are identical to those of `skycap plan --out`,
  /// except for times. Without a folder, nothing is written, and missions with a vehicle have no
  /// route.
  std::optional<std::filesystem::path> folder;
  /// Callback with each view and the coverage after it, called on the planning thread. May be
  /// empty.
  std::function<void(const survey::SurveyedView&, double coverage)> report;
  std::stop_token stop;  ///< stop request; the current view is completed
};

struct Survey {
  survey::StopReason end = survey::StopReason::complete;
  std::vector<survey::SurveyedView> views;
  std::vector<double> coverages;  ///< covered fraction of the surface after each view
  geometry::PointCloud cloud;
  /// Covered fraction of the surface visible from admissible views.
  std::optional<double> visible_coverage;
  std::optional<double> attainable_coverage;  ///< attainable fraction of the surface
  std::string summary;                        ///< contents of summary.json
  std::string failure;  ///< reason for a missing route; empty without an error

  double coverage() const { return coverages.empty() ? 0.0 : coverages.back(); }
};

/// Simulates the survey. Throws Error with the mission name if the scene or the folder is invalid.
/// An interrupted survey does not overwrite a complete one but is written to the subfolder
/// `interrupted`.
Survey plan(const Mission& mission, const SurveyRequest& request = {});

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< public name for user programs
}
