#include "missions/online/live/answer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "flight/export/geodesy.h"
#include "flight/route/route.h"
#include "geometry/angle.h"
#include "geometry/pose/pose.h"
#include "missions/online/live/live_journal.h"
#include "missions/support/journal_text.h"
#include "missions/support/json_text.h"
#include "survey/coverage_estimator.h"

namespace skycap::missions::online {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;
using support::to_json;

Json view_json(const geometry::View& view, const flight::FlightOptions& flight) {
  const Eigen::Quaterniond turn(geometry::camera_pose(view).linear());
  Json json{{"position", to_json(view.position)},
            {"direction", to_json(view.direction)},
            {"quaternion_xyzw", {turn.x(), turn.y(), turn.z(), turn.w()}},
            {"heading_deg", flight::compute_yaw(view) / geometry::radians_per_degree},
            {"gimbal_pitch_deg", flight::compute_pitch(view) / geometry::radians_per_degree}};
  if (!flight.is_georeferenced) return json;
  const flight::Site& site = flight.site;
  const flight::GeodeticPoint geodetic = flight::LocalFrame(site.origin).to_geodetic(view.position);
  json["latitude_deg"] = geodetic.latitude_deg;
  json["longitude_deg"] = geodetic.longitude_deg;
  json["height_ellipsoid_m"] = geodetic.height;
  if (site.geoid_undulation) json["height_geoid_m"] = geodetic.height - *site.geoid_undulation;
  return json;
}

Json leg_json(const session::ExecutedLeg& path) {
  Json points = Json::array();
  for (const Vector3d& point : path.points) points.push_back(to_json(point));
  return points;
}

/// Returns the next en-route frames, limited by the size of a message header.
Json frames_json(const std::vector<session::ViewInFlight>& frames,
                 const flight::FlightOptions& flight) {
  constexpr std::size_t max = 64;
  Json json = Json::array();
  for (const session::ViewInFlight& frame : std::span(frames).first(std::min(frames.size(), max))) {
    Json one = view_json(frame.view, flight);
    one["time_s"] = frame.time;
    json.push_back(std::move(one));
  }
  return json;
}

/// Describes the motion that aligns a scan with the map.
std::string motion_text(const PoseFinding& pose) {
  std::string text = fmt::format("moved by {:.3f} m and rotated by {:.2f} deg", pose.shift,
                                 pose.turn / geometry::radians_per_degree);
  if (pose.unobservable > 0) {
    text += fmt::format(" ({} of 6 degrees of freedom are unobservable)", pose.unobservable);
  }
  return text;
}

std::string pose_text(const PoseFinding& pose) {
  if (pose.is_wrong) {
    const std::string seen = fmt::format("the scan passes through {:.0f}% of the predicted surface",
                                         100.0 * pose.seen_through);
    return "; warning: scan rejected: pose inconsistent with the map (" +
           (pose.is_checked ? "best fit " + motion_text(pose) + ", " + seen : seen) +
           "). Hold position, correct the pose and scan again";
  }
  if (pose.correction) return "; pose " + motion_text(pose);
  return "";
}

/// What the region of interest has kept from being surveyed, where that is worth a word.
std::string region_text(const BoxSight& visibility) {
  constexpr double worth_a_word = 0.01;
  std::string text;
  if (const double outside = visibility.outside_share(); outside >= worth_a_word) {
    text += fmt::format("; {:.0f}% of the points are outside planner.scene_box and ignored",
                        100.0 * outside);
  }
  const std::optional<double> predicted = visibility.unseen_share();
  if (predicted && *predicted >= worth_a_word) {
    text += fmt::format("; {:.0f}% of the surface of planner.scene_box has not been observed",
                        100.0 * *predicted);
  }
  return text;
}

const char* state_name(const Proposal& proposal) {
  if (proposal.end) return session::to_string(*proposal.end);
  return proposal.view ? "view" : "first_scan";
}

}  // namespace

std::string answer_json(const LiveSurvey& survey, const flight::FlightOptions& flight) {
  const Proposal& proposal = survey.proposal();
  Json json{{"id", proposal.number},
            {"state", state_name(proposal)},
            {"scans", survey.views().size()},
            {"points", survey.planner().cloud().size()},
            {"rejected", survey.set_aside()},
            {"view", proposal.view ? view_json(*proposal.view, flight) : Json()}};
  if (flight.capture.is_moving) {
    json["en_route"] = survey.en_route();
    json["frame_period_s"] = flight.capture.frame_period;
  }
  if (proposal.view && !proposal.path.points.empty()) {
    json["path"] = leg_json(proposal.path);
    json["clearance_m"] = proposal.path.clearance;
    if (flight.capture.is_moving) json["frames"] = frames_json(survey.frames(), flight);
  }
  if (proposal.has_pose_warning()) json["warning"] = "pose";
  if (proposal.pose) json["pose"] = finding_json(*proposal.pose);
  if (const survey::CoverageEstimator* estimator = survey.planner().estimator();
      estimator != nullptr && !survey.views().empty()) {
    json["estimated_coverage"] = estimator->predicted_coverage();
  }
  if (const std::optional<double> predicted = survey.visibility().unseen_share()) {
    json["outside_box"] = survey.visibility().outside_share();
    json["unseen_box_surface"] = *predicted;
  }
  return support::journal_line(json);
}

std::string answer_text(const LiveSurvey& survey) {
  const Proposal& proposal = survey.proposal();
  std::string scans =
      fmt::format("{} scans, {} points", survey.views().size(), survey.planner().cloud().size());
  if (survey.set_aside() > 0) scans += fmt::format(", {} scans rejected", survey.set_aside());
  if (proposal.pose) scans += pose_text(*proposal.pose);
  if (proposal.end) {
    return std::string(state_name(proposal)) + " after " + scans + region_text(survey.visibility());
  }
  if (!proposal.view)
    return "take the first scan from any position from which the scene is visible";
  const Vector3d& at = proposal.view->position;
  std::string text = fmt::format(
      "view {}: {:.3f} {:.3f} {:.3f}, heading {:.1f} deg, pitch {:.1f} deg", proposal.number,
      at.x(), at.y(), at.z(), flight::compute_yaw(*proposal.view) / geometry::radians_per_degree,
      flight::compute_pitch(*proposal.view) / geometry::radians_per_degree);
  if (!proposal.path.points.empty()) {
    text += fmt::format("; {} legs, clearance {:.2f} m", proposal.path.points.size() - 1,
                        proposal.path.clearance);
    if (const std::size_t frames = survey.frames().size(); frames > 0) {
      text += fmt::format(", {} en-route scans", frames);
    }
  }
  return text + "; " + scans;
}

}  // namespace skycap::missions::online
