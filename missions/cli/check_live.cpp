#include "missions/cli/check_live.h"

#include <vector>

#include <fmt/format.h>

#include "flight/route/route.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/config/mission_document.h"
#include "missions/session/initial_pattern_flight.h"
#include "missions/session/survey_flight.h"
#include "missions/site_data/prior_text.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::cli {
namespace {

using Eigen::Vector3d;

/// Consistency check of a live mission's keys.
class LiveCheck {
 public:
  LiveCheck(const config::MissionSetup& setup)
      : setup_(setup), planner_(setup.survey().planner), first_(first_view()) {
    check_distances();
    check_limits();
    check_first_view();
    const std::string range = range_warning(setup, planner_.view_distance);
    if (!range.empty()) warnings_.push_back(range);
  }

  bool has_problems() const { return !problems_.empty(); }

  std::string text(const std::string& file) const {
    std::string text = file + (has_problems() ? ": cannot be surveyed\n" : ": no problems found\n");
    text += "  survey    live: scans come from a sensor; no scene is simulated\n";
    text += fmt::format("  planner   {}, view distance d {:.4g} m, spacing epsilon {:.4g} m\n",
                        survey::find_title(planner_.name).word, planner_.view_distance,
                        planner_.spacing);
    text += sensor_text() + region_text() + limits_text() + first_view_text();
    if (setup_.scene().priors) text += site_data::format_priors(*setup_.scene().priors);
    for (const std::string& problem : problems_) text += "  problem   " + problem + "\n";
    for (const std::string& warning : warnings_) text += "  Warning: " + warning + "\n";
    return text;
  }

 private:
  std::optional<geometry::View> first_view() const {
    const session::StartOptions& start = setup_.survey().start;
    const std::vector<geometry::View> initial_pattern =
        session::initial_pattern_views(start, setup_.run.seed);
    return initial_pattern.empty() ? start.view : initial_pattern.front();
  }

  void check_distances() {
    const double distance = planner_.view_distance;
    const geometry::CameraConfig& camera = planner_.camera;
    if (camera.max_range <= distance) {
      problems_.push_back(fmt::format(
          "the maximum range of the sensor ({:.4g} m) must be greater than the view distance "
          "({:.4g} m); lower planner.view_distance or raise sensor.max_range",
          camera.max_range, distance));
    }
    if (camera.min_range >= distance) {
      problems_.push_back(fmt::format(
          "the minimum range of the sensor ({:.4g} m) must be less than the view distance ({:.4g} "
          "m); raise planner.view_distance or lower sensor.min_range",
          camera.min_range, distance));
    }
    if (planner_.limits.min_standoff >= distance) {
      problems_.push_back(fmt::format(
          "{0} ({1:.4g} m) must be smaller than the view distance ({2:.4g} m); lower {0} or raise "
          "planner.view_distance",
          setup_.flight().has_vehicle() ? "flight.clearance" : "limits.stand_off",
          planner_.limits.min_standoff, distance));
    }
  }

  void check_limits() {
    const survey::ViewLimits& limits = planner_.limits;
    if (limits.geofence.empty()) {
      warnings_.emplace_back(
          "site.geofence is missing: views behind walls can be proposed; set it to the area in "
          "which the sensor can move");
    }
    if (limits.min_standoff == 0.0) {
      warnings_.emplace_back(
          "limits.stand_off is 0: views close to surfaces and in unknown space can be proposed; "
          "set it to the minimum distance from surfaces");
    }
  }

  void check_first_view() {
    if (!first_) return;
    if (!planner_.limits.allow(*first_)) {
      problems_.emplace_back(
          "the first view violates a height or pitch limit, the geofence or a no-fly volume; "
          "correct start.position, the start direction or the limit");
    } else if (setup_.flight().has_vehicle()) {
      try {  // The climb and the path to the first view are verified before any scan.
        const session::SurveyFlight flight(setup_.flight(), *first_, setup_.run.threads);
      } catch (const Error& error) {
        problems_.emplace_back(error.what());
      }
    }
  }

  std::string sensor_text() const {
    const geometry::CameraConfig& camera = planner_.camera;
    const std::string range =
        fmt::format("range {:.4g} to {:.4g} m", camera.min_range, camera.max_range);
    if (setup_.lidar) return fmt::format("  sensor    {}, {}\n", *setup_.lidar, range);
    const double degree = geometry::radians_per_degree;
    return fmt::format("  sensor    {} x {} pixels, {:.4g} x {:.4g} degrees, {}\n", camera.width,
                       camera.height, camera.horizontal_fov / degree, camera.vertical_fov / degree,
                       range);
  }

  std::string region_text() const {
    if (!planner_.scene_box) return "";
    const Vector3d size = planner_.scene_box->sizes(), low = planner_.scene_box->min();
    return fmt::format(
        "  region    planner.scene_box, {:.4g} x {:.4g} x {:.4g} m from ({:.4g}, {:.4g}, {:.4g}); "
        "measurements outside are ignored\n",
        size.x(), size.y(), size.z(), low.x(), low.y(), low.z());
  }

  std::string limits_text() const {
    const double degree = geometry::radians_per_degree;
    const survey::ViewLimits& limits = planner_.limits;
    std::string text = fmt::format(
        "  limits    distance from surfaces at least {:.4g} m, pitch {:.4g} to {:.4g} "
        "degrees",
        limits.min_standoff, limits.min_pitch / degree, limits.max_pitch / degree);
    if (limits.min_height) text += fmt::format(", z at least {:.4g} m", *limits.min_height);
    if (limits.max_height) text += fmt::format(", z at most {:.4g} m", *limits.max_height);
    if (setup_.flight().has_vehicle()) text += ", vehicle " + setup_.flight().vehicle_name;
    return text + "\n";
  }

  std::string first_view_text() const {
    if (!first_) return "  first     any view from which the scene is visible\n";
    const double degree = geometry::radians_per_degree;
    return fmt::format(
        "  first     view at ({:.4g}, {:.4g}, {:.4g}), heading {:.4g} degrees, pitch {:.4g} "
        "degrees\n",
        first_->position.x(), first_->position.y(), first_->position.z(),
        flight::compute_yaw(*first_) / degree, flight::compute_pitch(*first_) / degree);
  }

  const config::MissionSetup& setup_;
  const survey::PlannerOptions& planner_;
  std::optional<geometry::View> first_;
  std::vector<std::string> problems_, warnings_;
};

}  // namespace

std::string range_warning(const config::MissionSetup& setup, double view_distance) {
  const config::SensorSection& sensor = setup.document->sensor;
  const std::optional<config::RangeInterval>& useful = sensor.useful_range;
  if (!useful || (view_distance >= useful->min && view_distance <= useful->max)) return "";
  return fmt::format(
      "the view distance ({:.4g} m) should be in the range in which the camera {} is accurate "
      "({:g} to {:g} m); change planner.view_distance, or set sensor.max_range to the "
      "range "
      "of your sensor",
      view_distance, sensor.preset, useful->min, useful->max);
}

int check_live(const std::string& file, const config::MissionSetup& setup, const Console& console) {
  const LiveCheck check(setup);
  console.out << check.text(file) << std::flush;
  return check.has_problems() ? 1 : 0;
}

}  // namespace skycap::missions::cli
