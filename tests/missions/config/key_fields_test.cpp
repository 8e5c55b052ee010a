// Each key of the mission file sets the field with its name, and no other field.
#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "missions/config/mission_keys.h"

namespace skycap::missions {
namespace {

using config::KeyValue;
using Document = config::MissionDocument;
using Eigen::Vector3d;

constexpr double degree = geometry::radians_per_degree;

/// Returns one of two valid values of a key.
KeyValue value_for(const config::Key& key, bool is_second) {
  switch (key.type) {
    case config::KeyType::text:
      // Procedural models, which have a level of detail and a seed.
      if (key.path == "scene.model") {
        return std::string("builtin:") + (is_second ? "city-block" : "church");
      }
      return std::string(is_second ? "/some/tile.yaml" : "/some/other.yaml");
    case config::KeyType::boolean:
      return is_second;
    case config::KeyType::choice:
      return is_second ? key.choices.back() : key.choices.front();
    case config::KeyType::integer:
      return std::int64_t{is_second ? 7 : 3};
    case config::KeyType::vector:
      return Vector3d(is_second ? Vector3d(1, 2, 3) : Vector3d(4, -2, 8));
    case config::KeyType::number:
      return is_second ? 0.25 : 0.5;
    case config::KeyType::polygon:
    case config::KeyType::line:
      return std::vector<Eigen::Vector2d>{{0, 0}, {9, 0}, {0, is_second ? 9.5 : 4.5}};
    case config::KeyType::volumes:
      return std::vector<geometry::Prism>{
          {"", {{0, 0}, {1, 0}, {0, 1}}, -2.0, is_second ? 30.0 : 60.0}};
    case config::KeyType::vectors:
      return std::vector<Vector3d>{{10, -20, 90}, {is_second ? 0.5 : 2.5, 0, -45}};
    case config::KeyType::sources:
      return std::vector<site_data::Source>{
          {.file = is_second ? "/tile.gml" : "/map.gml", .role = site_data::Role::terrain}};
    case config::KeyType::texts:
      return std::vector<std::string>{"m350_rtk", is_second ? "mavic_3e" : "generic"};
    case config::KeyType::integers:
      return std::vector<int>{2, is_second ? 6 : 5};
    case config::KeyType::pairs:
      return std::map<std::string, std::string>{{"use", is_second ? "church" : "mill"}};
  }
  return {};
}

std::string value_text(const config::Key& key, const Document& document) {
  const auto value = key.get(document);
  return value ? config::to_text(*value) : "-";
}

/// Keys that only have a value if another key has a certain value, and that other key.
const std::map<std::string, std::string> means_nothing_without = {
    {"sensor.frame_period", "sensor.capture"}};

/// Checks that setting a key changes its own text to the value and no other key. `document` must
/// contain a prior source for the keys of sources.
void expect_own_fields(std::span<const config::Key> keys, Document document) {
  for (const config::Key& key : keys) key.set(document, value_for(key, true));
  for (const config::Key& key : keys) {
    EXPECT_EQ(value_text(key, document), config::to_text(value_for(key, true))) << key.path;
    Document changed = document;
    key.set(changed, value_for(key, false));
    EXPECT_EQ(value_text(key, changed), config::to_text(value_for(key, false))) << key.path;
    EXPECT_NE(value_text(key, changed), value_text(key, document)) << key.path << " is not changed";
    for (const config::Key& other : keys) {
      const auto needed = means_nothing_without.find(other.path);
      if (&other == &key) continue;
      if (needed != means_nothing_without.end() && needed->second == key.path) continue;
      EXPECT_EQ(value_text(other, changed), value_text(other, document))
          << other.path << " changes with " << key.path;
    }
  }
}

TEST(MissionKeys, HaveDistinctFields) { expect_own_fields(config::mission_keys(), {}); }

TEST(MissionKeys, HaveDistinctFieldsForSources) {
  Document document;
  document.prior.emplace_back();
  expect_own_fields(config::find_key("prior")->items, std::move(document));
}

/// Returns the value of a field as in the file. Enumerators are numbers.
template <class Field>
KeyValue value(const Field& field) {
  if constexpr (requires { field.has_value(); }) {
    return value(field.value());
  } else if constexpr (std::is_same_v<Field, bool>) {
    return field;
  } else if constexpr (std::is_enum_v<Field> || std::is_integral_v<Field>) {
    return static_cast<std::int64_t>(field);
  } else {
    return field;
  }
}

template <class Field>
KeyValue degrees(const Field& field) {
  if constexpr (requires { field.has_value(); }) {
    return degrees(field.value());
  } else {
    return Field(field / degree);
  }
}

/// Copies of a model: [east, north, rotation].
KeyValue in_degrees(std::vector<Vector3d> copies) {
  for (Vector3d& copy : copies) copy.z() /= degree;
  return copies;
}

struct KeyField {
  std::string_view key;
  KeyValue (*value)(const Document&);
};

constexpr KeyField fields[] = {
    {"scene.copies", [](const Document& d) { return in_degrees(d.scene.copies); }},
    {"scene.detail", [](const Document& d) { return value(d.scene.detail); }},
    {"scene.seed", [](const Document& d) { return value(d.scene.seed); }},
    {"scene.model", [](const Document& d) { return value(d.scene.model); }},
    {"name", [](const Document& d) { return value(d.name); }},
    {"seed", [](const Document& d) { return value(d.seed); }},
    {"threads", [](const Document& d) { return value(d.threads); }},
    {"scene.up_axis", [](const Document& d) { return value(d.scene.up_axis); }},
    {"scene.rotation_deg", [](const Document& d) { return degrees(d.scene.rotation); }},
    {"scene.longest_side", [](const Document& d) { return value(d.scene.longest_side); }},
    {"scene.scale", [](const Document& d) { return value(d.scene.scale); }},
    {"scene.position", [](const Document& d) { return value(d.scene.position); }},
    {"scene.ground", [](const Document& d) { return value(d.scene.ground); }},
    {"scene.neighbours", [](const Document& d) { return value(d.scene.neighbours); }},
    {"scene.reflectance", [](const Document& d) { return value(d.scene.reflectance); }},
    {"scene.materials", [](const Document& d) { return value(d.scene.materials); }},
    {"sensor.frame_period", [](const Document& d) { return value(d.sensor.options.frame_period); }},
    {"sensor.lidar", [](const Document& d) { return value(d.sensor.lidar); }},
    {"sensor.photo_camera", [](const Document& d) { return value(d.sensor.photo_camera); }},
    {"photo.gsd", [](const Document& d) { return value(d.photo.gsd); }},
    {"photo.min_partners", [](const Document& d) { return value(d.photo.min_partners); }},
    {"photo.max_incidence_deg",
     [](const Document& d) { return degrees(d.photo.rule.max_incidence); }},
    {"photo.min_parallax_deg",
     [](const Document& d) { return degrees(d.photo.rule.min_parallax); }},
    {"photo.max_parallax_deg",
     [](const Document& d) { return degrees(d.photo.rule.max_parallax); }},
    {"photo.poses", [](const Document& d) { return value(d.photo.poses); }},
    {"photo.patterns", [](const Document& d) { return value(d.photo.patterns); }},
    {"photo.pattern", [](const Document& d) { return value(d.photo.pattern); }},
    {"photo.forward_overlap", [](const Document& d) { return value(d.photo.forward_overlap); }},
    {"photo.side_overlap", [](const Document& d) { return value(d.photo.side_overlap); }},
    {"photo.target_share", [](const Document& d) { return value(d.photo.target_share); }},
    {"photo.max_photos", [](const Document& d) { return value(d.photo.max_photos); }},
    {"photo.pass", [](const Document& d) { return value(d.photo.pass); }},
    {"sensor.preset", [](const Document& d) { return value(d.sensor.preset); }},
    {"sensor.width", [](const Document& d) { return value(d.sensor.options.camera.camera.width); }},
    {"sensor.height",
     [](const Document& d) { return value(d.sensor.options.camera.camera.height); }},
    {"sensor.horizontal_fov_deg",
     [](const Document& d) { return degrees(d.sensor.options.camera.camera.horizontal_fov); }},
    {"sensor.vertical_fov_deg",
     [](const Document& d) { return degrees(d.sensor.options.camera.camera.vertical_fov); }},
    {"sensor.min_range",
     [](const Document& d) { return value(d.sensor.options.camera.camera.min_range); }},
    {"sensor.max_range",
     [](const Document& d) { return value(d.sensor.options.camera.camera.max_range); }},
    {"sensor.max_incidence_deg",
     [](const Document& d) { return degrees(d.sensor.options.camera.max_incidence); }},
    {"sensor.exposure", [](const Document& d) { return value(d.sensor.options.shutter.exposure); }},
    {"sensor.readout", [](const Document& d) { return value(d.sensor.options.shutter.readout); }},
    {"sensor.settle", [](const Document& d) { return value(d.sensor.options.settle); }},
    {"sensor.capture", [](const Document& d) { return value(d.sensor.options.capture); }},
    {"sensor.noise.sigma",
     [](const Document& d) { return value(d.sensor.options.camera.noise.sigma); }},
    {"sensor.noise.direction",
     [](const Document& d) { return value(d.sensor.options.camera.noise.direction); }},
    {"inspection.range", [](const Document& d) { return value(d.inspection.range); }},
    {"inspection.cloud", [](const Document& d) { return value(d.inspection.cloud); }},
    {"inspection.share", [](const Document& d) { return value(d.inspection.share); }},
    {"inspection.max_incidence_deg",
     [](const Document& d) { return degrees(d.inspection.max_incidence); }},
    {"inspection.min_views", [](const Document& d) { return value(d.inspection.min_views); }},
    {"inspection.spacing", [](const Document& d) { return value(d.inspection.spacing); }},
    {"inspection.max_speed", [](const Document& d) { return value(d.inspection.max_speed); }},
    {"inspection.max_acceleration",
     [](const Document& d) { return value(d.inspection.max_acceleration); }},
    {"inspection.max_jerk", [](const Document& d) { return value(d.inspection.max_jerk); }},
    {"inspection.max_yaw_rate_deg",
     [](const Document& d) { return degrees(d.inspection.max_yaw_rate); }},
    {"inspection.max_yaw_acceleration_deg",
     [](const Document& d) { return degrees(d.inspection.max_yaw_acceleration); }},
    {"inspection.moves", [](const Document& d) { return value(d.inspection.moves); }},
    {"inspection.searches", [](const Document& d) { return value(d.inspection.searches); }},
    {"planner.name", [](const Document& d) { return value(d.planner.name); }},
    {"planner.file", [](const Document& d) { return value(d.planner.file); }},
    {"uniform.views", [](const Document& d) { return value(d.planner.fixed_views.views); }},
    {"uniform.set", [](const Document& d) { return value(d.planner.fixed_views.set); }},
    {"uniform.rings", [](const Document& d) { return value(d.planner.fixed_views.rings); }},
    {"uniform.order", [](const Document& d) { return value(d.planner.fixed_views.order); }},
    {"pb_nbv.views", [](const Document& d) { return value(d.planner.pb_nbv.views); }},
    {"pb_nbv.candidates", [](const Document& d) { return value(d.planner.pb_nbv.candidates); }},
    {"pb_nbv.parallels", [](const Document& d) { return value(d.planner.pb_nbv.parallels); }},
    {"pb_nbv.sectors", [](const Document& d) { return value(d.planner.pb_nbv.sectors); }},
    {"pb_nbv.max_ellipsoids",
     [](const Document& d) { return value(d.planner.pb_nbv.max_ellipsoids); }},
    {"pb_nbv.growth", [](const Document& d) { return value(d.planner.pb_nbv.growth); }},
    {"pb_nbv.voxel", [](const Document& d) { return value(d.planner.pb_nbv.voxel); }},
    {"pb_nbv.working_distance",
     [](const Document& d) { return value(d.planner.pb_nbv.working_distance); }},
    {"pb_nbv.region", [](const Document& d) { return value(d.planner.pb_nbv.region); }},
    {"pattern.polygon", [](const Document& d) { return value(d.planner.patterns.polygon); }},
    {"pattern.line", [](const Document& d) { return value(d.planner.patterns.line); }},
    {"pattern.width", [](const Document& d) { return value(d.planner.patterns.width); }},
    {"pattern.base", [](const Document& d) { return value(d.planner.patterns.base); }},
    {"pattern.top", [](const Document& d) { return value(d.planner.patterns.top); }},
    {"pattern.forward_overlap",
     [](const Document& d) { return value(d.planner.patterns.forward_overlap); }},
    {"pattern.side_overlap",
     [](const Document& d) { return value(d.planner.patterns.side_overlap); }},
    {"pattern.pitch_deg", [](const Document& d) { return degrees(d.planner.patterns.pitch); }},
    {"planner.preset", [](const Document& d) { return value(d.planner.preset); }},
    {"planner.goal", [](const Document& d) { return value(d.planner.goal); }},
    {"planner.density", [](const Document& d) { return value(d.planner.sampling.density); }},
    {"planner.density_per_m2",
     [](const Document& d) { return value(d.planner.sampling.density_per_m2); }},
    {"planner.resolution_radius",
     [](const Document& d) { return value(d.planner.sampling.resolution_radius); }},
    {"planner.occlusion_search_distance",
     [](const Document& d) { return value(d.planner.see.occlusion_search_distance); }},
    {"planner.visibility_update_limit",
     [](const Document& d) { return value(d.planner.see.visibility_update_limit); }},
    {"planner.core_threshold",
     [](const Document& d) { return value(d.planner.see.core_threshold); }},
    {"planner.spacing", [](const Document& d) { return value(d.planner.sampling.spacing); }},
    {"planner.view_distance",
     [](const Document& d) { return value(d.planner.sampling.view_distance); }},
    {"planner.scene_box.min",
     [](const Document& d) { return value(d.planner.sampling.scene_box->min()); }},
    {"planner.scene_box.max",
     [](const Document& d) { return value(d.planner.sampling.scene_box->max()); }},
    {"planner.outlier_rule", [](const Document& d) { return value(d.planner.see.outlier_rule); }},
    {"planner.frame_neighbours",
     [](const Document& d) { return value(d.planner.see.frame_neighbours); }},
    {"planner.free_space_normals",
     [](const Document& d) { return value(d.planner.see.free_space_normals); }},
    {"planner.offset_line", [](const Document& d) { return value(d.planner.see.offset_line); }},
    {"planner.occlusion_radius",
     [](const Document& d) { return value(d.planner.see.occlusion_radius); }},
    {"planner.march_end", [](const Document& d) { return value(d.planner.see.march_end); }},
    {"planner.optimise_views",
     [](const Document& d) { return value(d.planner.see.optimise_views); }},
    {"planner.cap.policy", [](const Document& d) { return value(d.planner.see.cap.policy); }},
    {"planner.cap.max_evaluations",
     [](const Document& d) { return value(d.planner.see.cap.max_evaluations); }},
    {"planner.observing_direction",
     [](const Document& d) { return value(d.planner.see.observing_direction); }},
    {"planner.occluder_spacing",
     [](const Document& d) { return value(d.planner.see.occluder_spacing); }},
    {"planner.still_occluded",
     [](const Document& d) { return value(d.planner.see.still_occluded); }},
    {"planner.visibility_graph",
     [](const Document& d) { return value(d.planner.see.visibility_graph); }},
    {"planner.facing_test", [](const Document& d) { return value(d.planner.see.facing_test); }},
    {"planner.field_of_view_test",
     [](const Document& d) { return value(d.planner.see.field_of_view_test); }},
    {"planner.first_view_weight",
     [](const Document& d) { return value(d.planner.see.first_view_weight); }},
    {"planner.nearest", [](const Document& d) { return value(d.planner.see.nearest); }},
    {"planner.adjustment", [](const Document& d) { return value(d.planner.see.adjustment); }},
    {"planner.adjustment_centroid",
     [](const Document& d) { return value(d.planner.see.adjustment_centroid); }},
    {"planner.max_attempts", [](const Document& d) { return value(d.planner.see.max_attempts); }},
    {"planner.stay_on_target",
     [](const Document& d) { return value(d.planner.see.stay_on_target); }},
    {"planner.frontier_spacing",
     [](const Document& d) { return value(d.planner.see.frontier_spacing); }},
    {"planner.target_coverage",
     [](const Document& d) { return value(d.planner.surfel_stop.target_coverage); }},
    {"planner.min_gain", [](const Document& d) { return value(d.planner.surfel_stop.min_gain); }},
    {"planner.ablation.coverage_model",
     [](const Document& d) { return value(d.planner.ablation.coverage_model); }},
    {"planner.ablation.unseen_surface",
     [](const Document& d) { return value(d.planner.ablation.surface_prediction); }},
    {"planner.ablation.free_space",
     [](const Document& d) { return value(d.planner.ablation.free_space); }},
    {"planner.ablation.learned_rates",
     [](const Document& d) { return value(d.planner.ablation.learned_rates); }},
    {"planner.ablation.targeted_views",
     [](const Document& d) { return value(d.planner.ablation.targeted_views); }},
    {"planner.ablation.refinement",
     [](const Document& d) { return value(d.planner.ablation.refinement); }},
    {"planner.ablation.batch", [](const Document& d) { return value(d.planner.ablation.batch); }},
    {"volumetric.view_limit",
     [](const Document& d) { return value(d.planner.volumetric.view_limit); }},
    {"volumetric.candidates_per_view",
     [](const Document& d) { return value(d.planner.volumetric.candidates_per_view); }},
    {"volumetric.sphere_centre",
     [](const Document& d) { return value(d.planner.volumetric.sphere_centre); }},
    {"volumetric.sphere_radius",
     [](const Document& d) { return value(d.planner.volumetric.sphere_radius); }},
    {"volumetric.cost_weight",
     [](const Document& d) { return value(d.planner.volumetric.cost_weight); }},
    {"volumetric.ties", [](const Document& d) { return value(d.planner.volumetric.ties); }},
    {"volumetric.visibility",
     [](const Document& d) { return value(d.planner.volumetric.gain.visibility); }},
    {"volumetric.rse_end",
     [](const Document& d) { return value(d.planner.volumetric.gain.rear_side_end); }},
    {"volumetric.af_share",
     [](const Document& d) { return value(d.planner.volumetric.gain.area_share); }},
    {"volumetric.rays_per_pixel",
     [](const Document& d) { return value(d.planner.volumetric.rays.rays_per_pixel); }},
    {"volumetric.window_begin",
     [](const Document& d) { return value(d.planner.volumetric.rays.window_begin); }},
    {"volumetric.window_end",
     [](const Document& d) { return value(d.planner.volumetric.rays.window_end); }},
    {"volumetric.ray_depth",
     [](const Document& d) { return value(d.planner.volumetric.ray_depth); }},
    {"volumetric.shadow_length",
     [](const Document& d) { return value(d.planner.volumetric.shadow_length); }},
    {"volumetric.thinned",
     [](const Document& d) { return value(d.planner.volumetric.downsampled); }},
    {"volumetric.carve_no_returns",
     [](const Document& d) { return value(d.planner.volumetric.carve_no_returns); }},
    {"start.position", [](const Document& d) { return value(d.start.position); }},
    {"start.look_at", [](const Document& d) { return value(d.start.look_at); }},
    {"start.direction", [](const Document& d) { return value(d.start.direction); }},
    {"limits.max_views", [](const Document& d) { return value(d.limits.options.max_views); }},
    {"limits.max_distance", [](const Document& d) { return value(d.limits.options.max_distance); }},
    {"limits.ground_clearance", [](const Document& d) { return value(d.limits.ground_clearance); }},
    {"limits.stand_off", [](const Document& d) { return value(d.limits.min_standoff); }},
    {"limits.min_pitch_deg", [](const Document& d) { return degrees(d.limits.min_pitch); }},
    {"limits.max_pitch_deg", [](const Document& d) { return degrees(d.limits.max_pitch); }},
    {"limits.max_minutes", [](const Document& d) { return value(d.limits.max_minutes); }},
    {"limits.speed", [](const Document& d) { return value(d.limits.options.speed); }},
    {"limits.time_per_view",
     [](const Document& d) { return value(d.limits.options.time_per_view); }},
    {"evaluation.coverage_distance",
     [](const Document& d) { return value(d.evaluation.registration_distance); }},
    {"evaluation.samples", [](const Document& d) { return value(d.evaluation.samples); }},
    {"evaluation.visible_directions",
     [](const Document& d) { return value(d.evaluation.visible_directions); }},
    {"evaluation.attainable_views",
     [](const Document& d) { return value(d.evaluation.attainable_views); }},
    {"evaluation.passage_radius", [](const Document& d) { return value(d.evaluation.radius); }},
    {"paper.views", [](const Document& d) { return value(d.paper.views); }},
    {"paper.coverage", [](const Document& d) { return value(d.paper.coverage); }},
    {"paper.planning_time", [](const Document& d) { return value(d.paper.planning_time); }},
    {"paper.distance", [](const Document& d) { return value(d.paper.distance); }},
    {"flight.rally", [](const Document& d) { return value(d.flight.options.rally); }},
    {"flight.vehicles", [](const Document& d) { return value(d.flight.options.fleet.names); }},
    {"flight.pads", [](const Document& d) { return value(d.flight.options.fleet.pads); }},
    {"flight.fleet_goal", [](const Document& d) { return value(d.flight.options.fleet.goal); }},
    {"flight.separation",
     [](const Document& d) { return value(d.flight.options.fleet.separation); }},
    {"flight.timing_tolerance",
     [](const Document& d) { return value(d.flight.options.fleet.timing_tolerance); }},
    {"flight.extra_unknown_boxes",
     [](const Document& d) { return value(d.flight.extra_unknown_boxes); }},
    {"flight.vehicle", [](const Document& d) { return value(d.flight.options.vehicle_name); }},
    {"flight.clearance", [](const Document& d) { return value(d.flight.options.clearance); }},
    {"flight.position_error",
     [](const Document& d) { return value(d.flight.options.position_error); }},
    {"flight.tracking_error",
     [](const Document& d) { return value(d.flight.options.tracking_error); }},
    {"flight.map_error", [](const Document& d) { return value(d.flight.options.map_error); }},
    {"flight.unknown_box.min",
     [](const Document& d) { return value(d.flight.unknown_box->min()); }},
    {"flight.unknown_box.max",
     [](const Document& d) { return value(d.flight.unknown_box->max()); }},
    {"flight.no_return_free_range",
     [](const Document& d) { return value(d.flight.options.free_without_return); }},
    {"flight.takeoff", [](const Document& d) { return value(d.flight.options.takeoff); }},
    {"flight.takeoff_climb",
     [](const Document& d) { return value(d.flight.options.takeoff_climb); }},
    {"flight.pad_slope_deg", [](const Document& d) { return degrees(d.flight.options.pad_slope); }},
    {"flight.max_pad_slope_deg",
     [](const Document& d) { return degrees(d.flight.options.max_pad_slope); }},
    {"flight.cruise_speed", [](const Document& d) { return value(d.flight.options.cruise_speed); }},
    {"flight.hold", [](const Document& d) { return value(d.flight.options.hold); }},
    {"flight.hold_after", [](const Document& d) { return value(d.flight.options.hold_after); }},
    {"flight.wind_speed", [](const Document& d) { return value(d.flight.options.wind_speed); }},
    {"flight.wind_from_deg", [](const Document& d) { return degrees(d.flight.options.wind_from); }},
    {"flight.battery_temperature",
     [](const Document& d) { return value(d.flight.options.temperature); }},
    {"flight.reserve", [](const Document& d) { return value(d.flight.options.reserve); }},
    {"flight.initial_pattern", [](const Document& d) { return value(d.flight.initial_pattern); }},
    {"flight.views", [](const Document& d) { return value(d.flight.options.views); }},
    {"flight.order", [](const Document& d) { return value(d.flight.options.order); }},
    {"flight.free_space", [](const Document& d) { return value(d.flight.free_space); }},
    {"flight.style", [](const Document& d) { return value(d.flight.options.style); }},
    {"site.geofence", [](const Document& d) { return value(d.site.geofence); }},
    {"site.no_fly", [](const Document& d) { return value(d.site.no_fly); }},
    {"site.min_height", [](const Document& d) { return value(d.site.min_height); }},
    {"site.max_height", [](const Document& d) { return value(d.site.max_height); }},
    {"site.latitude_deg", [](const Document& d) { return value(d.georeference.latitude_deg); }},
    {"site.longitude_deg", [](const Document& d) { return value(d.georeference.longitude_deg); }},
    {"site.ellipsoid_height",
     [](const Document& d) { return value(d.georeference.ellipsoid_height); }},
    {"site.geoid_undulation",
     [](const Document& d) { return value(d.georeference.geoid_undulation); }},
    {"live.pose_check", [](const Document& d) { return value(d.live.checks_poses); }},
    {"live.pose_sigma", [](const Document& d) { return value(d.live.pose_sigma); }},
    {"live.pose_sigma_deg", [](const Document& d) { return degrees(d.live.pose_sigma_angle); }},
    {"live.registration", [](const Document& d) { return value(d.live.registers); }},
    {"live.remove_flying_pixels",
     [](const Document& d) { return value(d.live.removes_flying_pixels); }},
    {"scan.orbit.centre", [](const Document& d) { return value(d.scan.orbit.centre); }},
    {"scan.orbit.radius", [](const Document& d) { return value(d.scan.orbit.radius); }},
    {"scan.orbit.min_height", [](const Document& d) { return value(d.scan.orbit.min_height); }},
    {"scan.orbit.max_height", [](const Document& d) { return value(d.scan.orbit.max_height); }},
    {"scan.orbit.circles", [](const Document& d) { return value(d.scan.orbit.circles); }},
    {"scan.orbit.speed", [](const Document& d) { return value(d.scan.orbit.speed); }},
    {"scan.orbit.start_deg", [](const Document& d) { return degrees(d.scan.orbit.start); }},
    {"scan.navigation.horizontal_sigma",
     [](const Document& d) { return value(d.scan.navigation.horizontal_sigma); }},
    {"scan.navigation.vertical_sigma",
     [](const Document& d) { return value(d.scan.navigation.vertical_sigma); }},
    {"scan.navigation.tilt_sigma_deg",
     [](const Document& d) { return degrees(d.scan.navigation.tilt_sigma); }},
    {"scan.navigation.heading_sigma_deg",
     [](const Document& d) { return degrees(d.scan.navigation.heading_sigma); }},
    {"scan.navigation.correlation_time",
     [](const Document& d) { return value(d.scan.navigation.correlation_time); }},
    {"scan.sensor", [](const Document& d) { return value(d.scan.sensor); }},
    {"scan.route", [](const Document& d) { return value(d.scan.route); }},
    {"scan.crs", [](const Document& d) { return value(d.scan.crs); }},
    {"scan.speed", [](const Document& d) { return value(d.scan.speed); }},
    {"scan.mount.position", [](const Document& d) { return value(d.scan.mount_position); }},
    {"scan.mount.rotation_deg", [](const Document& d) { return degrees(d.scan.mount_rotation); }},
    {"scan.lever_arm_error", [](const Document& d) { return value(d.scan.lever_arm_error); }},
    {"scan.boresight_error_deg", [](const Document& d) { return degrees(d.scan.boresight_error); }},
    {"scan.frame_period", [](const Document& d) { return value(d.scan.frame_period); }},
    {"scan.depth_unit", [](const Document& d) { return value(d.scan.depth_unit); }},
};

// A key that sets and gets the field of another key would pass all tests that only use keys.
TEST(MissionKeys, SetAndGetTheirNamedFields) {
  EXPECT_EQ(std::size(fields), config::mission_keys().size() - 1) << "all but the list of sources";
  for (const config::Key& key : config::mission_keys()) {
    if (key.type == config::KeyType::sources) continue;
    const auto field = std::ranges::find(fields, std::string_view(key.path), &KeyField::key);
    ASSERT_NE(field, std::end(fields)) << key.path;
    for (const bool is_second : {false, true}) {
      Document document;
      const KeyValue given = value_for(key, is_second);
      key.set(document, given);
      KeyValue expected = given;
      if (key.type == config::KeyType::choice) {
        expected =
            std::ranges::find(key.choices, std::get<std::string>(given)) - key.choices.begin();
      }
      EXPECT_EQ(config::to_text(field->value(document)), config::to_text(expected)) << key.path;
    }
  }
}

}  // namespace
}  // namespace skycap::missions
