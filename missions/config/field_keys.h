/// Mapping from option fields to mission keys. The libraries' validate() functions report field
/// names only; this table translates them to the keys that users set.
#pragma once

#include <array>
#include <string_view>

namespace skycap::missions::config {

/// Field name in messages of validate() and its mission key.
struct FieldKey {
  std::string_view field, key;
};

/// Fields of planner, camera and navigation options. Fields of the same name share one key in all
/// options.
inline constexpr auto field_keys = std::to_array<FieldKey>({
    // geometry::CameraConfig, sim::DepthCameraConfig
    {"width", "sensor.width"},
    {"height", "sensor.height"},
    {"horizontal_fov", "sensor.horizontal_fov_deg"},
    {"vertical_fov", "sensor.vertical_fov_deg"},
    {"min_range", "sensor.min_range"},
    {"max_range", "sensor.max_range"},
    {"max_incidence", "sensor.max_incidence_deg"},
    {"noise.sigma", "sensor.noise.sigma"},
    // survey::ViewLimits
    {"stand_off", "limits.stand_off"},
    {"max_height", "site.max_height"},
    {"min_height", "site.min_height"},
    {"max_pitch", "limits.max_pitch_deg"},
    {"geofence", "site.geofence"},
    {"no_fly", "site.no_fly"},
    // shared by several planners
    {"density", "planner.density"},
    {"resolution_radius", "planner.resolution_radius"},
    {"resolution", "planner.resolution_radius"},
    {"spacing", "planner.spacing"},
    {"view_distance", "planner.view_distance"},
    {"scene_box", "planner.scene_box.max"},
    // survey::see::SeeConfig
    {"occlusion_search_distance", "planner.occlusion_search_distance"},
    {"visibility_update_limit", "planner.visibility_update_limit"},
    {"frame_neighbours", "planner.frame_neighbours"},
    {"occlusion_radius", "planner.occlusion_radius"},
    {"occluder_spacing", "planner.occluder_spacing"},
    {"first_view_weight", "planner.first_view_weight"},
    {"max_attempts", "planner.max_attempts"},
    {"frontier_spacing", "planner.frontier_spacing"},
    {"core_threshold", "planner.core_threshold"},
    {"max_evaluations", "planner.cap.max_evaluations"},
    // survey::surfel::SurfelConfig
    {"coverage_radius", "evaluation.coverage_distance"},
    {"view_price", "planner.goal"},
    {"stop.target_coverage", "planner.target_coverage"},
    {"stop.min_gain", "planner.min_gain"},
    {"stop.max_length", "limits.max_distance"},
    {"stop.max_time", "limits.max_minutes"},
    {"stop.speed", "limits.speed"},
    {"stop.time_per_view", "limits.time_per_view"},
    {"position_error", "scan.navigation.horizontal_sigma"},
    {"angle_error", "scan.navigation.tilt_sigma_deg"},
    {"frame_spacing", "sensor.frame_period"},
    // survey::volumetric::VolumetricConfig
    {"sphere_radius", "volumetric.sphere_radius"},
    {"candidates_per_view", "volumetric.candidates_per_view"},
    {"cost_weight", "volumetric.cost_weight"},
    {"ray_depth", "volumetric.ray_depth"},
    {"shadow_length", "volumetric.shadow_length"},
    {"rays.rays_per_pixel", "volumetric.rays_per_pixel"},
    {"rays.window_begin", "volumetric.window_begin"},
    {"rays.window_end", "volumetric.window_end"},
    // survey::fixed_views::FixedViewsConfig
    {"uniform.views", "uniform.views"},
    {"uniform.rings", "uniform.rings"},
    // survey::patterns::PatternConfig
    {"pattern.forward_overlap", "pattern.forward_overlap"},
    {"pattern.side_overlap", "pattern.side_overlap"},
    {"pattern.pitch", "pattern.pitch_deg"},
    // survey::pb_nbv::PbNbvConfig
    {"pb_nbv.candidates", "pb_nbv.candidates"},
    {"pb_nbv.parallels", "pb_nbv.parallels"},
    {"pb_nbv.sectors", "pb_nbv.sectors"},
    {"pb_nbv.growth", "pb_nbv.growth"},
    {"pb_nbv.voxel", "pb_nbv.voxel"},
    {"pb_nbv.working_distance", "pb_nbv.working_distance"},
    // sim::NavigationErrors
    {"navigation.horizontal_sigma", "scan.navigation.horizontal_sigma"},
    {"navigation.vertical_sigma", "scan.navigation.vertical_sigma"},
    {"navigation.tilt_sigma", "scan.navigation.tilt_sigma_deg"},
    {"navigation.heading_sigma", "scan.navigation.heading_sigma_deg"},
    {"navigation.correlation_time", "scan.navigation.correlation_time"},
});

/// Returns the key of a field, or an empty string if no key sets the field.
constexpr std::string_view find_field_key(std::string_view field) {
  for (const FieldKey& known : field_keys) {
    if (known.field == field) return known.key;
  }
  return {};
}

}  // namespace skycap::missions::config
