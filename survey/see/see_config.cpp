#include "survey/see/see_config.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "geometry/error.h"
#include "geometry/requirement.h"

namespace skycap::survey::see {
namespace {

bool is_length(double value) { return std::isfinite(value) && value > 0.0; }

}  // namespace

int SeeConfig::effective_core_threshold() const {
  if (core_threshold) return *core_threshold;
  const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(resolution_radius, 3);
  return static_cast<int>(std::min(1e9, std::ceil(volume * density)));
}

int SeeConfig::half_disc_threshold() const {
  // Fraction of a plane that randomly placed discs of diameter epsilon cover (Feder 1980).
  constexpr double filled = 0.547;
  const double radii = 2.0 * resolution_radius / effective_spacing();
  const double half = 0.5 * filled * radii * radii;
  return std::max(effective_core_threshold(), static_cast<int>(std::min(1e6, std::round(half))));
}

double SeeConfig::effective_spacing() const { return spacing.value_or(1.0 / std::sqrt(density)); }

void SeeConfig::validate() const {
  constexpr const char* length = "a positive number of metres";
  require(std::isfinite(density) && density > 0.0, "density", density,
          "a positive number of points per cubic metre");
  require(is_length(resolution_radius), "resolution_radius", resolution_radius, length);
  require(is_length(occlusion_search_distance), "occlusion_search_distance",
          occlusion_search_distance, length);
  require(visibility_update_limit > 0, "visibility_update_limit",
          static_cast<double>(visibility_update_limit), "at least 1");
  require(std::isfinite(effective_spacing()) && effective_spacing() >= 0.0, "spacing",
          effective_spacing(), "zero or a positive number of metres");
  require(
      effective_spacing() < resolution_radius, "spacing", effective_spacing(),
      "less than resolution_radius; otherwise no point has neighbours (default: density^(-1/2))");
  require(!view_distance || is_length(*view_distance), "view_distance", view_distance.value_or(0.0),
          length);
  if (scene_box && (scene_box->isEmpty() || !scene_box->diagonal().allFinite())) {
    throw Error(ErrorKind::bad_config, "scene_box is empty; its minimum must be below its maximum");
  }
  require(!frame_neighbours || *frame_neighbours >= 3, "frame_neighbours",
          frame_neighbours.value_or(0), "at least 3");
  require(
      !occlusion_radius || (is_length(*occlusion_radius) && *occlusion_radius <= resolution_radius),
      "occlusion_radius", occlusion_radius.value_or(0.0), "positive and at most resolution_radius");
  require(is_length(occluder_spacing), "occluder_spacing", occluder_spacing, length);
  require(std::isfinite(first_view_weight) && first_view_weight >= 0.0, "first_view_weight",
          first_view_weight, "zero or more");
  require(max_attempts >= 1, "max_attempts", max_attempts, "at least 1");
  require(std::isfinite(frontier_spacing) && frontier_spacing >= 0.0, "frontier_spacing",
          frontier_spacing, "zero or a positive number of metres");
  require(!min_height || std::isfinite(*min_height), "min_height", min_height.value_or(0.0),
          "a finite height");
  cap.validate();

  const int k = effective_core_threshold();
  if (core_threshold) {
    require(k >= 4, "core_threshold", k, "at least 4; otherwise no point can be a frontier");
  } else if (k < 4) {
    std::ostringstream message;
    message
        << "density " << density << " and resolution_radius " << resolution_radius
        << " result in a core threshold of " << k
        << ", with which no point can be a frontier; with this radius, the density must be above "
        << 9.0 / (4.0 * std::numbers::pi * std::pow(resolution_radius, 3))
        << ", or with this density, the radius must be above "
        << std::cbrt(9.0 / (4.0 * std::numbers::pi * density));
    throw Error(ErrorKind::bad_config, message.str());
  }
}

}  // namespace skycap::survey::see
