/// HTML reports (report.html) of completed surveys, from their results folder only, and of running
/// surveys.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "missions/report/results.h"
#include "missions/scene/scene_options.h"
#include "missions/session/survey_options.h"
#include "missions/session/survey_record.h"

namespace skycap::missions::report {

/// Returns the report of the survey described in summary.json, with up to `max_points` points of
/// cloud.ply. cloud.ply and coverage.ply are optional. Throws Error{bad_file} with the file name if
/// a file is invalid.
std::string survey_report(const ResultFinder& results, std::size_t max_points);

/// Next view of a running survey, if any, and the path to it.
struct NextView {
  std::optional<geometry::View> view;
  std::vector<Eigen::Vector3d> path;
};

/// Returns the report of a running survey, which browsers reload periodically. To reduce the cost,
/// it contains fewer points than that of a completed survey and no incidence angles. `summary_text`
/// is package::summary_json() of the same record.
std::string live_page(const std::string& summary_text, const session::SurveyOptions& survey,
                      const scene::SceneOptions& scene, session::SurveyRecord so_far,
                      const NextView& next);

}  // namespace skycap::missions::report
