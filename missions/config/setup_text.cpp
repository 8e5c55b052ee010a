#include "missions/config/setup_text.h"

#include <optional>
#include <string_view>

#include <Eigen/Geometry>

#include "geometry/angle.h"
#include "missions/config/key_texts.h"
#include "missions/config/mission_keys.h"
#include "missions/support/number_text.h"

namespace skycap::missions::config {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using support::exact_text;

std::string text(double value) { return exact_text(value); }
std::string text(std::size_t value) { return std::to_string(value); }
std::string text(int value) { return std::to_string(value); }
std::string text(bool value) { return value ? "true" : "false"; }
std::string text(const std::string& value) { return value; }
std::string text(const Vector3d& value) {
  return "[" + exact_text(value.x()) + ", " + exact_text(value.y()) + ", " + exact_text(value.z()) +
         "]";
}
std::string text(const AlignedBox3d& box) {
  if (box.isEmpty()) return "none";
  return "{min: " + text(Vector3d(box.min())) + ", max: " + text(Vector3d(box.max())) + "}";
}
template <class Value>
std::string text(const std::optional<Value>& value) {
  return value ? text(*value) : "none";
}

/// YAML writer that tracks the indentation.
class Lines {
 public:
  void section(std::string_view name) {
    line(name, "");
    ++depth_;
  }
  void end() { --depth_; }

  template <class Value>
  void value(std::string_view name, const Value& value) {
    line(name, " " + text(value));
  }
  void angle(std::string_view name, double radians) {
    value(name, radians / geometry::radians_per_degree);
  }

  std::string text_;

 private:
  void line(std::string_view name, const std::string& value) {
    text_.append(2 * depth_, ' ').append(name).append(":").append(value).append("\n");
  }

  std::size_t depth_ = 0;
};

void add_camera(const geometry::CameraConfig& camera, Lines& lines) {
  lines.section("camera");
  lines.value("width_px", camera.width);
  lines.value("height_px", camera.height);
  lines.angle("horizontal_fov_deg", camera.horizontal_fov);
  lines.angle("vertical_fov_deg", camera.vertical_fov);
  lines.value("min_range", camera.min_range);
  lines.value("max_range", camera.max_range);
  lines.end();
}

void add_planner(const survey::PlannerOptions& planner, Lines& lines) {
  lines.section("planner");
  lines.value("name", std::string(survey::find_title(planner.name).word));
  lines.value("spacing", planner.spacing);
  lines.value("view_distance", planner.view_distance);
  lines.value("resolution_radius", planner.resolution_radius);
  lines.value("scene_box", planner.scene_box.value_or(AlignedBox3d()));
  lines.section("view_limits");
  lines.value("min_height", planner.limits.min_height);
  lines.value("max_height", planner.limits.max_height);
  lines.value("follows_terrain", static_cast<bool>(planner.limits.min_height_at));
  lines.value("min_standoff", planner.limits.min_standoff);
  lines.angle("min_pitch_deg", planner.limits.min_pitch);
  lines.angle("max_pitch_deg", planner.limits.max_pitch);
  lines.end();
  lines.end();
}

void add_limits(const survey::SurveyLimits& limits, Lines& lines) {
  lines.section("survey_limits");
  lines.value("max_views", limits.max_views);
  lines.value("max_distance", limits.max_distance);
  lines.value("max_time", limits.max_time);
  lines.value("speed", limits.speed);
  lines.value("time_per_view", limits.time_per_view);
  lines.end();
}

void add_clearance(const flight::FlightOptions& flight, Lines& lines) {
  const flight::ClearanceBudget budget = flight.budget();
  lines.section("clearance_budget");
  lines.value("vehicle_radius", budget.vehicle_radius);
  lines.value("position_error", budget.position_error);
  lines.value("tracking_error", budget.tracking_error);
  lines.value("map_error", budget.map_error);
  lines.value("margin", budget.margin);
  lines.value("total", budget.total());
  lines.end();
}

void add_flight(const flight::FlightOptions& flight, const session::StartOptions& start,
                std::uint64_t seed, Lines& lines) {
  lines.section("flight");
  lines.value("vehicle", flight.required_vehicle().name);
  add_clearance(flight, lines);
  const flight::MeasuredSpaceConfig space = flight.measured_space();
  lines.value("unknown_box", flight.unknown_box);
  lines.value("voxel", space.voxel);
  lines.value("max_depth", space.max_depth);
  lines.value("ground_height", flight.airspace.ground_height);
  lines.value("has_terrain", static_cast<bool>(flight.airspace.terrain));
  lines.value("obstacles", flight.airspace.priors.size());
  lines.value("takeoff_climb", flight.climb());
  lines.value("cruise_speed", flight.cruise_speed);
  lines.value("hold_before_capture", flight.rest_before());
  lines.value("hold_after_capture", flight.rest_after());
  lines.value("captures_en_route", flight.capture.is_moving);
  lines.value("capture_period", flight.capture.frame_period);
  if (const auto image_motion = flight.image_motion_bounds()) {
    lines.value("motion_blur_px", image_motion->blur_px);
    lines.value("rolling_shutter_skew_px", image_motion->shear_px);
  }
  lines.value("initial_pattern_views", session::initial_pattern_views(start, seed).size());
  if (start.view) lines.value("takeoff", flight.pad(start.view->position));
  lines.end();
}

}  // namespace

std::string setup_text(const MissionSetup& setup) {
  Lines lines;
  lines.value("mission", setup.name);
  lines.section("keys");
  for (const Key& key : mission_keys()) {
    if (applies(key, *setup.document)) lines.value(key.path, setup.text(key.path));
  }
  lines.end();
  lines.section("derived");
  add_camera(setup.survey().planner.camera, lines);
  add_planner(setup.survey().planner, lines);
  add_limits(setup.survey().limits, lines);
  if (const auto& view = setup.survey().start.view) {
    lines.section("first_view");
    lines.value("position", view->position);
    lines.value("direction", view->direction);
    lines.end();
  }
  if (setup.flight().has_vehicle()) {
    add_flight(setup.flight(), setup.survey().start, setup.run.seed, lines);
  }
  lines.end();
  return lines.text_;
}

}  // namespace skycap::missions::config
