#include "missions/simulation/feasibility.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/pose/camera.h"
#include "geometry/surfaces/mesh.h"
#include "missions/evaluation/coverage.h"
#include "missions/session/survey_flight.h"
#include "sim/sensors/survey_sensor.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::simulation {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

// Far above the numbers of views on the largest sites, so that a wrong unit is likely.
constexpr double max_views = 1e5;
constexpr std::size_t samples_requested = 2000;  // Number of surface samples tested for visibility.
constexpr double little = 0.1;                   // Fraction of these samples that causes a warning.
constexpr double cut_off = 0.02;  // Fraction of the surface outside a box that causes a warning.

std::string format_position(const Vector3d& position) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", position.x(), position.y(), position.z());
}

/// Reports all problems, even if one may be a consequence of another, because each has its own
/// remedy.
class Inspection {
 public:
  Inspection(const evaluation::SimulationOptions& options, const evaluation::SurveyScene& scene,
             const session::RunOptions& run)
      : options_(options),
        scene_(scene),
        run_(run),
        camera_(options.sensor.camera.camera),
        bounds_(geometry::bounding_box(scene.model())),
        longest_(bounds_.sizes().maxCoeff()),
        distance_(scene.view_distance()) {}

  Feasibility found() {
    check_first_view();
    check_size();
    check_distances();
    check_boxes();
    check_density();
    check_positions();
    return std::move(found_);
  }

 private:
  template <class... Values>
  void problem(fmt::format_string<Values...> text, Values&&... values) {
    found_.problems.push_back(fmt::format(text, std::forward<Values>(values)...));
  }
  template <class... Values>
  void warn(fmt::format_string<Values...> text, Values&&... values) {
    found_.warnings.push_back(fmt::format(text, std::forward<Values>(values)...));
  }

  void check_size() {
    const double footprint = distance_ * distance_ * camera_.width() * camera_.height() /
                             camera_.focal_length_px().prod();
    const double views = geometry::surface_area(scene_.model()) / footprint;
    if (views > max_views) {
      problem(
          "the model is {:.4g} m long, but a view from the view distance ({:.4g} m) covers {:.3g} "
          "m^2, so that more than {:.2g} views are required. If the model is in millimetres, set "
          "scene.scale: 0.001; otherwise raise planner.view_distance",
          longest_, distance_, footprint, views);
    }
    const double radius = options_.evaluation.registration_distance;
    if (longest_ < 2.0 * radius) {
      problem(
          "the model ({:.4g} m long) must be at least twice evaluation.coverage_distance "
          "({:.4g} m); check its unit (scene.scale), or lower the distance",
          longest_, radius);
    }
  }

  void check_distances() {
    const double min_standoff = options_.survey.planner.limits.min_standoff;
    const flight::FlightOptions& flight = options_.survey.flight;
    if (min_standoff >= distance_) {
      problem(
          "{0} ({1:.4g} m) must be smaller than the view distance ({2:.4g} m); lower {0} or raise "
          "planner.view_distance",
          flight.has_vehicle() && min_standoff == flight.clearance ? "flight.clearance"
                                                                   : "limits.stand_off",
          min_standoff, distance_);
    }
    const geometry::CameraConfig& camera = camera_.config();
    if (camera.max_range <= distance_) {
      problem(
          "the maximum range of the sensor ({:.4g} m) must be at least the view distance ({:.4g} "
          "m); lower planner.view_distance or raise sensor.max_range",
          camera.max_range, distance_);
    }
    if (camera.min_range >= distance_) {
      problem(
          "the minimum range of the sensor ({:.4g} m) must be at most the view distance ({:.4g} "
          "m); raise planner.view_distance or lower sensor.min_range",
          camera.min_range, distance_);
    }
  }

  /// Returns the fraction of the surface outside a box, except for surface on its faces.
  double share_outside(AlignedBox3d box) const {
    const double slack = options_.evaluation.registration_distance;
    box = AlignedBox3d(box.min().array() - slack, box.max().array() + slack);
    const auto& points = scene_.samples().points;
    const auto outside = std::ranges::count_if(
        points, [&](const Vector3f& point) { return !box.contains(point.cast<double>()); });
    return static_cast<double>(outside) / static_cast<double>(points.size());
  }

  void check_boxes() {
    const std::string reach =
        format_position(bounds_.min()) + " to " + format_position(bounds_.max());
    if (const auto& box = options_.survey.planner.scene_box) {
      const double outside = share_outside(*box);
      if (outside >= 1.0) {
        problem(
            "planner.scene_box contains no part of the model, which extends from {}; move the box",
            reach);
      } else if (outside > cut_off) {
        warn(
            "planner.scene_box excludes {:.3g}% of the surface, which no survey can cover; extend "
            "it to contain the model, {}",
            100.0 * outside, reach);
      }
    }
    const flight::FlightOptions& flight = options_.survey.flight;
    if (!flight.has_vehicle()) return;
    const double outside = share_outside(flight.unknown_box);
    if (outside > cut_off) {
      problem(
          "{} excludes {:.3g}% of the surface, where unknown space would be assumed free; extend "
          "it to contain the model, {}",
          flight.has_own_box ? "flight.unknown_box" : "planner.scene_box", 100.0 * outside, reach);
    }
  }

  void check_density() {
    // Rays per m^2.
    const double rays = camera_.focal_length_px().prod() / (distance_ * distance_);
    const double radius = options_.evaluation.registration_distance;
    // The distance of a sample from the nearest of the four surrounding rays is at most half the
    // diagonal of their square.
    const double gap = std::sqrt(0.5 / rays);
    if (gap > radius) {
      warn(
          "the ray spacing at the view distance ({:.4g} m) is {:.3g} m on a wall; a view covers "
          "only part of its visible surface within evaluation.coverage_distance ({:.4g} m). Lower "
          "planner.view_distance to {:.4g} m",
          distance_, std::sqrt(1.0 / rays), radius, distance_ * radius / gap);
    }
    const double spacing = options_.survey.planner.spacing;
    if (spacing > std::sqrt(3.0) * radius) {  // Points leave gaps even in a hexagonal lattice.
      warn(
          "the spacing of stored points ({:.4g} m) must be at most "
          "evaluation.coverage_distance ({:.4g} m) for gapless coverage; lower planner.spacing "
          "to {:.4g} m",
          spacing, radius, 0.8 * radius);
    }
  }

  void check_positions() {
    const auto& all = scene_.samples().points;
    const std::size_t step = std::max<std::size_t>(1, all.size() / samples_requested);
    std::vector<Vector3f> some;
    for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
    const double share = evaluation::marked_share(
        evaluation::visible_samples(some, scene_.scene(), scene_.admissible(), run_.threads));
    const char* remedy =
        "widen the height limits, the geofence and the gimbal limits, or lower limits.stand_off, "
        "flight.clearance or evaluation.passage_radius";
    if (share == 0.0) {
      problem("no part of the model is visible from {:.4g} m away within the limits; {}", distance_,
              remedy);
    } else if (share < little) {
      warn("only {:.2g}% of the surface is visible within the limits; {}", 100.0 * share, remedy);
    }
  }

  void check_first_view() {
    try {
      const geometry::View first = scene_.first_view(run_.seed);
      const geometry::Scan scan = sim::SurveySensor(options_.sensor, run_.seed)
                                      .scan(scene_.scene(), first, 0, run_.threads);
      const auto& box = options_.survey.planner.scene_box;
      const bool sees = std::ranges::any_of(scan.points, [&](const Vector3f& point) {
        return !box || box->contains(point.cast<double>());
      });
      // The corner of a grid need not see the target.
      const bool is_pattern = survey::pattern_of(options_.survey.planner.name).has_value();
      if (!sees && !is_pattern) {
        problem("the first scan contains no point of the scene; start from a view that sees it");
      } else if (options_.survey.flight.has_vehicle()) {
        const session::SurveyFlight session_flight(options_.survey.flight, first, run_.threads);
      }
    } catch (const Error& error) {
      problem("{}", error.what());
    }
  }

  const evaluation::SimulationOptions& options_;
  const evaluation::SurveyScene& scene_;
  session::RunOptions run_;
  geometry::Camera camera_;
  AlignedBox3d bounds_;
  double longest_, distance_;
  Feasibility found_;
};

}  // namespace

Feasibility feasibility(const evaluation::SimulationOptions& options,
                        const evaluation::SurveyScene& scene, const session::RunOptions& run) {
  return Inspection(options, scene, run).found();
}

void require_feasible(const evaluation::SimulationOptions& options,
                      const evaluation::SurveyScene& scene, const session::RunOptions& run) {
  const Feasibility found = feasibility(options, scene, run);
  if (found.problems.empty()) return;
  throw Error(ErrorKind::bad_config, fmt::format("{}", fmt::join(found.problems, "; and ")));
}

}  // namespace skycap::missions::simulation
