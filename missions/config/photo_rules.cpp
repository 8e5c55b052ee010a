#include "missions/config/photo_rules.h"

#include <algorithm>
#include <array>

#include "geometry/error.h"
#include "missions/config/derived_values.h"

namespace skycap::missions::config {
namespace {

using survey::photo::Pattern;

/// Returns the ground sampling distance of the plan: three times that of the mission on a coarse
/// pass.
double planned_gsd(const MissionDocument& document) {
  constexpr double coarser = 3.0;
  return document.photo.gsd.value() * (document.photo.pass == PhotoPass::coarse ? coarser : 1.0);
}

Pattern pattern_of(const MissionDocument& document, const char* key, const std::string& name) {
  if (const auto pattern = survey::photo::pattern_named(name)) return *pattern;
  document.reject(
      key, "unknown pattern " + name + "; expected one of: " + survey::patterns::pattern_names());
}

std::vector<Pattern> patterns_of(const MissionDocument& document) {
  if (!document.photo.patterns) return {Pattern::facade, Pattern::dome, Pattern::oblique};
  std::vector<Pattern> patterns;
  for (const std::string& name : *document.photo.patterns) {
    const Pattern pattern = pattern_of(document, "photo.patterns", name);
    if (std::ranges::find(patterns, pattern) == patterns.end()) patterns.push_back(pattern);
  }
  return patterns;
}

void check_without_camera(const MissionDocument& document) {
  for (const auto& [key, position] : document.locations) {
    if (key.starts_with("photo.") ||
        (key == "flight.free_space" && document.flight.free_space == FreeSpaceRule::assumed &&
         !document.is_inspection())) {
      document.reject(key, "requires a photo camera; set sensor.photo_camera, or remove the key");
    }
  }
}

void check_other_sensors(const MissionDocument& document) {
  for (const auto& [key, position] : document.locations) {
    const std::string_view instead = find_replacing_photo_key(key);
    if (instead.empty()) continue;
    const std::string what =
        "is for sensors that measure depth and conflicts with "
        "sensor.photo_camera; ";
    document.reject(
        key, what + (instead == "-" ? "remove it" : "set " + std::string(instead) + " instead"));
  }
}

}  // namespace

std::string_view find_replacing_photo_key(std::string_view key) {
  struct Replacement {
    std::string_view key, by;
  };
  static constexpr std::array replacements{
      Replacement{"planner.density", "photo.gsd"},
      Replacement{"planner.density_per_m2", "photo.gsd"},
      Replacement{"planner.spacing", "photo.gsd"},
      Replacement{"planner.view_distance", "photo.gsd"},
      Replacement{"planner.resolution_radius", "photo.gsd"},
      Replacement{"planner.name", "photo.pattern"},
      Replacement{"planner.min_gain", "photo.target_share"},
      Replacement{"evaluation.coverage_distance", "photo.gsd"},
      Replacement{"limits.max_views", "photo.max_photos"},
      Replacement{"pattern.forward_overlap", "photo.forward_overlap"},
      Replacement{"pattern.side_overlap", "photo.side_overlap"},
      Replacement{"flight.initial_pattern", "photo.pattern"},
  };
  const auto found = std::ranges::find(replacements, key, &Replacement::key);
  if (found != replacements.end()) return found->by;
  const bool is_of_depth =
      (key.starts_with("sensor.") && key != "sensor.photo_camera") ||
      (key.starts_with("planner.") && !key.starts_with("planner.scene_box")) ||
      key.starts_with("volumetric.") || key.starts_with("uniform.") || key.starts_with("pb_nbv.") ||
      key.starts_with("pattern.") || key.starts_with("start.") || key.starts_with("live.") ||
      key == "flight.views" || key == "flight.vehicles" || key == "flight.pads";
  return is_of_depth ? "-" : std::string_view();
}

void check_photo(const MissionDocument& document) {
  if (!document.is_photo()) {
    check_without_camera(document);
    return;
  }
  check_other_sensors(document);
  if (document.is_inspection()) return;  // the section inspection replaces the section photo
  if (!document.photo.gsd) {
    document.reject("photo.gsd",
                    "is missing; set the ground sampling distance in metres, for "
                    "example 0.005");
  }
  if (!has_target(document)) {
    document.reject("sensor.photo_camera",
                    "requires a target whose shape is known; add prior data with role: target (a "
                    "mesh, a city model or an outline with a height). With an outline, plan two "
                    "flights: first photo.pass: coarse, then photo.pass: final with the mesh "
                    "reconstructed from the photos of the first flight");
  }
  if (document.photo.rule.min_parallax >= document.photo.rule.max_parallax) {
    document.reject("photo.min_parallax_deg",
                    "must be less than photo.max_parallax_deg; swap the two");
  }
  patterns_of(document);
  if (document.photo.pattern) pattern_of(document, "photo.pattern", *document.photo.pattern);
}

void complete_photo(MissionDocument& document, const geometry::PhotoCameraConfig& config) {
  const geometry::PhotoCamera camera(config);
  document.sensor.photo = config;
  sim::SurveySensorOptions& sensor = document.sensor.options;
  sensor.camera.camera = {.width = camera.width(),
                          .height = camera.height(),
                          .horizontal_fov = camera.horizontal_fov(),
                          .vertical_fov = camera.vertical_fov()};
  sensor.camera.noise.sigma = 0.0;
  sensor.camera.noise.table = {};
  sensor.shutter = {.exposure = config.exposure, .readout = config.readout};
  if (document.is_inspection()) document.photo.gsd = camera.gsd(*document.inspection.range);
  const double gsd = planned_gsd(document);
  document.planner.sampling.view_distance = camera.distance(gsd);
  document.planner.sampling.spacing = gsd;
  document.evaluation.registration_distance = gsd;
}

PhotoSetup photo_setup(const MissionDocument& document) {
  const PhotoSection& photo = document.photo;
  constexpr int partners_of_coarse = 4, partners_of_final = 3;
  PhotoSetup setup;
  setup.free_space = document.flight.free_space;
  setup.pass = photo.pass;
  survey::photo::PhotoPlanOptions& options = setup.options;
  options.camera = document.sensor.photo.value();
  options.gsd = planned_gsd(document);
  options.rule = photo.rule;
  options.rule.min_partners = photo.min_partners.value_or(
      photo.pass == PhotoPass::coarse ? partners_of_coarse : partners_of_final);
  options.poses = photo.poses;
  options.patterns = patterns_of(document);
  if (photo.pattern) options.flown_pattern = survey::photo::pattern_named(*photo.pattern);
  options.forward_overlap = photo.forward_overlap;
  options.side_overlap = photo.side_overlap;
  options.target_share = photo.target_share;
  options.max_photos = static_cast<std::size_t>(photo.max_photos);
  return setup;
}

}  // namespace skycap::missions::config
