/// report.html of a survey: of what its folder holds and of nothing else, or of one that goes on.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/pose.h"
#include "missions/report/results.h"
#include "missions/scene/scene_options.h"
#include "missions/session/survey_options.h"
#include "missions/session/survey_record.h"

namespace skycap::missions::report {

/// The page of the survey that summary.json tells of, with at most so many points of cloud.ply.
/// Without cloud.ply or coverage.ply it goes without them. Throws Error{bad_file} naming the file
/// if one is not as `skycap plan` writes it.
std::string survey_report(const ResultFinder& results, std::size_t most_points);

/// Where a survey that goes on wants to look next, if it wants to, and the way there.
struct NextView {
  std::optional<geometry::View> view;
  std::vector<Eigen::Vector3d> way;
};

/// The page of a survey that goes on: a browser that shows it reads it again now and then. Shows
/// fewer points than the page of a finished one, and no incidence, so that it costs little.
/// `summary_text` is package::summary_json() of the same record.
std::string live_page(const std::string& summary_text, const session::SurveyOptions& survey,
                      const scene::SceneOptions& scene, session::SurveyRecord so_far,
                      const NextView& next);

}  // namespace skycap::missions::report
