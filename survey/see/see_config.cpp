#include <cmath>
#include <numbers>
#include <sstream>

#include "geometry/error.h"
#include "survey/see/see.h"

namespace skycap::survey::see {
namespace {

template <typename Value>
void require(bool holds, const char* field, const char* rule, const Value& value) {
  if (holds) return;
  std::ostringstream message;
  message << "planner." << field << " is " << value << "; it must be " << rule;
  throw Error(ErrorKind::bad_config, message.str());
}

bool is_length(double value) { return std::isfinite(value) && value > 0.0; }

}  // namespace

int SeeConfig::effective_core_threshold() const {
  if (core_threshold) return *core_threshold;
  const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(resolution_radius, 3);
  return static_cast<int>(std::min(1e9, std::ceil(volume * density)));
}

double SeeConfig::effective_spacing() const { return spacing.value_or(1.0 / std::sqrt(density)); }

void SeeConfig::validate() const {
  constexpr const char* length = "a positive number of metres";
  require(std::isfinite(density) && density > 0.0, "density",
          "a positive number of points per cubic metre", density);
  require(is_length(resolution_radius), "resolution_radius", length, resolution_radius);
  require(is_length(occlusion_search_distance), "occlusion_search_distance", length,
          occlusion_search_distance);
  require(visibility_update_limit > 0, "visibility_update_limit", "at least 1",
          visibility_update_limit);
  require(std::isfinite(effective_spacing()) && effective_spacing() >= 0.0, "spacing",
          "zero or a positive number of metres", effective_spacing());
  require(effective_spacing() < resolution_radius, "spacing",
          "less than resolution_radius, or no point has neighbours (by default it is "
          "density^(-1/2))",
          effective_spacing());
  require(!view_distance || is_length(*view_distance), "view_distance", length,
          view_distance.value_or(0.0));
  require(!scene_box || (!scene_box->isEmpty() && scene_box->diagonal().allFinite()), "scene_box",
          "a box whose minimum is below its maximum", "empty");
  require(!frame_neighbours || *frame_neighbours >= 3, "frame_neighbours", "at least 3",
          frame_neighbours.value_or(0));
  require(
      !occlusion_radius || (is_length(*occlusion_radius) && *occlusion_radius <= resolution_radius),
      "occlusion_radius", "positive and at most resolution_radius", occlusion_radius.value_or(0.0));
  require(is_length(occluder_spacing), "occluder_spacing", length, occluder_spacing);
  require(std::isfinite(first_view_weight) && first_view_weight >= 0.0, "first_view_weight",
          "zero or more", first_view_weight);
  require(max_attempts >= 1, "max_attempts", "at least 1", max_attempts);
  require(std::isfinite(frontier_spacing) && frontier_spacing >= 0.0, "frontier_spacing",
          "zero or a positive number of metres", frontier_spacing);
  require(!least_height || std::isfinite(*least_height), "least_height", "a finite height",
          least_height.value_or(0.0));
  cap.validate();

  const int k = effective_core_threshold();
  if (core_threshold) {
    require(k >= 4, "core_threshold", "at least 4, or no point can be a frontier", k);
  } else if (k < 4) {
    std::ostringstream message;
    message << "planner.density " << density << " and planner.resolution_radius "
            << resolution_radius << " give a core threshold of " << k
            << ", which admits no frontier; with this radius the density must be above "
            << 9.0 / (4.0 * std::numbers::pi * std::pow(resolution_radius, 3))
            << ", or with this density the radius above "
            << std::cbrt(9.0 / (4.0 * std::numbers::pi * density));
    throw Error(ErrorKind::bad_config, message.str());
  }
}

}  // namespace skycap::survey::see
