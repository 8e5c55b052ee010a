#include "survey/volumetric/volumetric_config.h"

#include <cmath>

#include "geometry/requirement.h"
#include "survey/volumetric/occupancy_states.h"

namespace skycap::survey::volumetric {

double VolumetricConfig::shadow_length() const {
  constexpr double default_in_voxels = 18.0;
  return settings.shadow_length.value_or(default_in_voxels * resolution);
}

double VolumetricConfig::ray_depth() const { return settings.ray_depth.value_or(sphere_radius); }

void VolumetricConfig::validate() const {
  constexpr const char* length = "a positive number of metres";
  const auto is_length = [](double value) { return std::isfinite(value) && value > 0.0; };
  require(is_length(resolution), "resolution", resolution, length);
  require(std::isfinite(spacing) && spacing >= 0.0, "spacing", spacing,
          "zero or a positive number of metres");
  require(is_length(sphere_radius), "sphere_radius", sphere_radius, length);
  require(candidates >= 1, "candidates_per_view", settings.candidates_per_view,
          "large enough for at least one candidate");
  require(std::isfinite(settings.cost_weight) && settings.cost_weight >= 0.0, "cost_weight",
          settings.cost_weight, "zero or more");
  require(is_length(ray_depth()), "ray_depth", ray_depth(), length);
  // A diagonal shadow needs sqrt(3) times as many voxels.
  constexpr double longest_shadow = OccupancyStates::deepest_shadow / 2.0;
  require(is_length(shadow_length()) && shadow_length() < longest_shadow * resolution,
          "shadow_length", shadow_length(), "positive and less than 2000 voxels");
  const RayPattern& rays = settings.rays;
  require(rays.rays_per_pixel > 0.0 && rays.rays_per_pixel <= 1.0, "rays.rays_per_pixel",
          rays.rays_per_pixel, "above 0 and at most 1");
  require(rays.window_begin >= 0.0 && rays.window_begin < rays.window_end, "rays.window_begin",
          rays.window_begin, "at least 0 and below window_end");
  require(rays.window_end < 1.0 + 1e-12, "rays.window_end", rays.window_end, "at most 1");
}

}  // namespace skycap::survey::volumetric
