#include "survey/patterns/pattern_config.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "geometry/error.h"
#include "geometry/requirement.h"

namespace skycap::survey::patterns {
namespace {

using geometry::View;

constexpr double right_angle = 0.5 * std::numbers::pi;

/// Pitch that a pattern uses by default, within the limits of gimbal or mount [rad].
std::optional<double> usable_pitch(const PatternConfig& config) {
  if (config.settings.pitch) return config.settings.pitch;
  const bool is_level = config.pattern == Pattern::facade || config.pattern == Pattern::rings;
  const double usual = is_level ? 0.0 : -0.5 * right_angle;
  const double pitch = std::clamp(usual, config.limits.min_pitch, config.limits.max_pitch);
  return pitch == usual ? std::nullopt : std::optional(pitch);
}

void check_pitch(const PatternConfig& config) {
  const double degrees = 90.0 / right_angle;
  const std::optional<double> pitch = usable_pitch(config);
  if (!pitch) return;
  if (config.pattern == Pattern::oblique) {
    constexpr double steepest = -80.0, flattest = -15.0;
    require(*pitch * degrees > steepest - 1e-6 && *pitch * degrees < flattest + 1e-6,
            "pattern.pitch", *pitch * degrees, "between -80 and -15 degrees for oblique grids");
  } else if (config.pattern == Pattern::facade || config.pattern == Pattern::rings) {
    constexpr double steepest = 80.0;
    require(std::abs(*pitch * degrees) < steepest + 1e-6, "pattern.pitch", *pitch * degrees,
            "between -80 and 80 degrees for facade rows and rings");
  } else if (config.pattern == Pattern::corridor) {
    constexpr double flattest = 80.0;
    require(*pitch * degrees < flattest + 1e-6, "pattern.pitch", *pitch * degrees,
            "between -90 and 80 degrees for corridors");
  }
}

PatternOptions pattern_options(const PatternConfig& config) {
  // Views of the lowest row see down to the base.
  const double half_height = 0.5 * config.footprint.y();
  const double base = std::max(config.ground, config.target.value().box.min().z());
  const double low = base + std::min(half_height, 0.5 * config.view_distance);
  return {.view_distance = config.view_distance,
          .forward_overlap = config.settings.forward_overlap,
          .side_overlap = config.settings.side_overlap,
          .ground = base,
          .min_height = std::max(low, config.limits.min_height.value_or(low)),
          .pitch = usable_pitch(config),
          .is_swept = config.is_swept};
}

/// Raises a view to the minimum height, by at most half the view distance.
void raise(const PatternConfig& config, View& view) {
  constexpr double margin = 1e-6, max_share = 0.5;
  double floor = config.limits.min_height.value_or(view.position.z());
  if (config.limits.min_height_at) {
    floor = std::max(floor, config.limits.min_height_at(view.position.head<2>()) + margin);
  }
  if (floor - view.position.z() > max_share * config.view_distance) return;
  view.position.z() = std::max(view.position.z(), floor);
}

/// Returns the views without those between which the sensor measures en route. The views of rows
/// are kept if the sensor's frames are farther apart than the pattern's views.
std::vector<View> stops_of(const PatternConfig& config, std::vector<View> views) {
  const double spacing = (1.0 - config.settings.forward_overlap) * config.footprint.minCoeff();
  if (!config.frame_spacing || *config.frame_spacing > spacing) return views;
  constexpr double position_share = 0.1, angle = 10.0 / 90.0 * right_angle;
  return without_passed_views(views, position_share * config.view_distance, angle);
}

}  // namespace

void PatternConfig::validate() const {
  constexpr double max_overlap = 0.95;
  const auto is_overlap = [](double overlap) { return overlap >= 0.0 && overlap <= max_overlap; };
  require(is_overlap(settings.forward_overlap), "pattern.forward_overlap", settings.forward_overlap,
          "between 0 and 0.95");
  require(is_overlap(settings.side_overlap), "pattern.side_overlap", settings.side_overlap,
          "between 0 and 0.95");
  require(std::isfinite(spacing) && spacing >= 0.0, "spacing", spacing,
          "zero or a positive number of metres");
  require(std::isfinite(view_distance) && view_distance > 0.0, "view_distance", view_distance,
          "a positive number of metres");
  if (limits.min_standoff >= view_distance) {
    throw Error(ErrorKind::bad_config,
                "stand_off is " + std::to_string(limits.min_standoff) +
                    "; it must be less than the view distance of the pattern (" +
                    std::to_string(view_distance) + " m)");
  }
  check_pitch(*this);
}

std::vector<View> find_choices(const PatternConfig& config, const View& view) {
  constexpr std::array steps{0.0, 0.25, 0.5};
  std::vector<View> choices;
  for (const double step : steps) {
    if (step > 0.0 && (1.0 + step) * config.view_distance > config.max_distance) break;
    View choice{view.position - step * config.view_distance * view.direction, view.direction};
    raise(config, choice);
    if (config.limits.allow(choice)) choices.push_back(choice);
  }
  return choices;
}

PlannedPattern plan_pattern(const PatternConfig& config) {
  const std::string name = to_string(config.pattern);
  if (!config.target) {
    throw Error(ErrorKind::bad_config,
                "the pattern " + name +
                    " requires a target; add prior data with role: target, or set pattern.polygon "
                    "or pattern.line with pattern.top");
  }
  const PatternViews all =
      pattern_views(config.pattern, config.footprint, *config.target, pattern_options(config));
  if (all.is_too_large) {
    throw Error(ErrorKind::bad_config,
                "the pattern " + name +
                    " has more than 20,000 views; lower pattern.forward_overlap or "
                    "pattern.side_overlap, or raise planner.view_distance");
  }
  PlannedPattern plan;
  for (const View& view : all.views) {
    (find_choices(config, view).empty() ? plan.dropped : plan.views).push_back(view);
  }
  if (plan.views.empty()) {
    throw Error(ErrorKind::bad_config,
                all.views.empty()
                    ? "the pattern " + name +
                          " has no views, because the target has no horizontal extent; check the "
                          "target"
                    : "none of the " + std::to_string(all.views.size()) + " views of the pattern " +
                          name +
                          " is within the limits of pitch, height and airspace; change "
                          "pattern.pitch_deg, planner.view_distance or the limits");
  }
  plan.views = stops_of(config, std::move(plan.views));
  return plan;
}

}  // namespace skycap::survey::patterns
