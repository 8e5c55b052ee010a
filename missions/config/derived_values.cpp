#include "missions/config/derived_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "flight/motion/motion.h"
#include "flight/route/route.h"
#include "geometry/error.h"
#include "geometry/pose/camera.h"
#include "missions/config/photo_rules.h"
#include "missions/config/photo_shutter.h"
#include "missions/session/own_planner_loader.h"
#include "missions/site_data/site_priors.h"
#include "missions/site_data/surface_points.h"
#include "sim/sensors/scanner_field.h"

namespace skycap::missions::config {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using sim::ScannerKind;
using site_data::Role;

/// Default of V for volumetric surveys outside a benchmark: the paper's value for its last two
/// models.
constexpr std::size_t usual_view_limit = 130;

/// scene.model of missions whose targets serve as ground truth.
constexpr const char* targets_as_truth = "prior";

/// Maximum number of points per target in the prior surface.
constexpr std::size_t max_target_points = 300'000;

bool has_role(const MissionDocument& document, Role role) {
  return std::ranges::find(document.prior, role, &site_data::Source::role) != document.prior.end();
}

/// Returns how scans of a flown scanner provide free space. Returns nullopt for single-line
/// scanners, because the space between their scan lines is unobserved.
std::optional<flight::SweepRays> make_sweep_rays(const MissionDocument& document) {
  const sim::SurveySensorOptions& sensor = document.sensor.options;
  const sim::LidarConfig& scanner = *sensor.scanner;
  const double speed = document.flight.options.cruise_speed;
  const double lever_arm = sensor.mount.value().body_from_scanner.translation().norm();
  switch (find_scanner_kind(scanner)) {
    case ScannerKind::ring: {
      // The cells are slightly larger than those of a revolution, so that each contains a ray. The
      // ray origins deviate from the vehicle position by the lever arm, half the distance flown per
      // revolution, and the spacing of the revolutions.
      constexpr double wider = 1.02;
      return flight::SweepRays{.spacing = wider * ray_spacing(scanner),
                               .axis = Vector3d::UnitX(),
                               .origin_spread = lever_arm + 0.5 * sim::revolution_spread +
                                                0.5 * speed / std::abs(scanner.rotation_rate)};
    }
    case ScannerKind::rosette: {
      // In flight, the rays of a rosette do not interleave as at rest but are distributed almost
      // randomly. The cells are enlarged to contain at least four times as many rays.
      constexpr double wider = 2.0;
      const double travelled = sensor.is_moving() ? speed * sensor.frame_period : 0.0;
      return flight::SweepRays{.spacing = wider * document.sensor.rosette.value().gap,
                               .axis = Vector3d::UnitX(),
                               .origin_spread = lever_arm + 0.5 * travelled,
                               .is_scattered = true};
    }
    case ScannerKind::line:
      break;
  }
  return std::nullopt;
}

flight::AirspaceOptions airspace_options(const MissionDocument& document) {
  flight::AirspaceOptions airspace{.base = document.scene.position,
                                   .ground_height = compute_ground_height(document),
                                   .geofence = document.site.geofence,
                                   .no_fly = document.site.no_fly,
                                   .max_height = document.site.max_height};
  const std::shared_ptr<const site_data::SitePriors>& priors = document.scene.priors;
  if (!priors) return airspace;
  airspace.priors = priors->obstacles;
  if (priors->ground) {
    airspace.ground = [priors](const Eigen::Vector2d& at) { return priors->ground(at).value(); };
  }
  if (priors->terrain) {
    airspace.terrain = [terrain = priors->terrain](const Eigen::Vector2d& at) {
      return terrain->height(at);
    };
  }
  return airspace;
}

flight::CaptureOptions capture_options(const MissionDocument& document) {
  const sim::SurveySensorOptions& sensor = document.sensor.options;
  flight::CaptureOptions capture{.camera = sensor.camera.camera,
                                 .view_distance = compute_view_distance(document),
                                 .is_scanner = document.sensor.lidar.has_value(),
                                 .mount = sensor.mount,
                                 .shutter = sensor.shutter,
                                 .settle = sensor.settle,
                                 .is_moving = sensor.is_moving(),
                                 .frame_period = sensor.frame_period};
  if (sensor.mount) capture.rays = make_sweep_rays(document);
  if (document.is_photo()) {
    const survey::photo::PhotoPlanOptions photo = photo_setup(document).options;
    capture.photo = make_photo_shutter(photo.camera, photo.gsd);
  }
  return capture;
}

/// Returns the cost of a stop as an equivalent path length [m] at cruise speed. It includes the
/// rest and the acceleration phases of the straight segments before it: 2.5 on average in surveys
/// of buildings.
double compute_stop_price(const flight::FlightOptions& flight) {
  constexpr double segments = 2.5, long_leg = 100.0;
  const flight::Motion motion(flight.required_vehicle(), flight.route(Vector3d::Zero()).conditions);
  const double speed = motion.leg_speed(Vector3d::UnitX());
  const double ramps = motion.leg_time({long_leg, 0.0, 0.0}) - long_leg / speed;
  return speed *
         (flight.rest_before() + flight.rest_after() + segments * (ramps + flight::corner_hold));
}

/// Returns the cost of a view for the planner skycap, excluding the path to it, as a path length
/// [m] according to planner.goal. Returns nullopt if the planner's own default applies.
std::optional<double> compute_view_price(const MissionDocument& document,
                                         const flight::FlightOptions& flight) {
  if (document.planner.goal == PlannerGoal::views) return std::nullopt;
  return flight.has_vehicle() ? compute_stop_price(flight) : compute_view_distance(document);
}

survey::surfel::SurfelConfig skycap_config(const MissionDocument& document,
                                           const flight::FlightOptions& flight) {
  const sim::SurveySensorOptions& sensor = document.sensor.options;
  survey::surfel::SurfelConfig config{.coverage_radius = compute_planned_distance(document),
                                      .spacing = compute_spacing(document),
                                      .view_distance = compute_view_distance(document),
                                      .max_incidence = sensor.camera.max_incidence,
                                      .scene_box = document.planner.sampling.scene_box,
                                      .limits = view_limits(document),
                                      .stop = document.planner.surfel_stop,
                                      .ablation = document.planner.ablation};
  // With the limits, the planner selects the best view that is still within reach of them.
  const LimitsSection& limits = document.limits;
  config.stop.max_length = limits.options.max_distance;
  if (limits.max_minutes) config.stop.max_time = 60.0 * *limits.max_minutes;
  config.stop.speed = limits.options.speed;
  config.stop.time_per_view = limits.options.time_per_view;
  config.view_price = compute_view_price(document, flight);
  if (sensor.is_moving()) {
    config.frame_spacing = flight.cruise_speed * sensor.frame_period;
    const auto& scanner = sensor.scanner;
    config.counts_en_route = scanner && find_scanner_kind(*scanner) != ScannerKind::ring;
    config.sees_lines = scanner && find_scanner_kind(*scanner) == ScannerKind::line;
  }
  if (flight.has_vehicle()) {  // isotropic approximation of the pose errors
    const sim::NavigationErrors& poses = document.scan.navigation;
    const auto mean = [](double twice, double once) {
      return std::sqrt((2.0 * twice * twice + once * once) / 3.0);
    };
    config.position_error = mean(poses.horizontal_sigma, poses.vertical_sigma);
    config.angle_error = mean(poses.tilt_sigma, poses.heading_sigma);
  }
  return config;
}

survey::volumetric::VolumetricConfig volumetric_config(
    const MissionDocument& document, survey::volumetric::VolumetricMetric metric) {
  const survey::volumetric::VolumetricSettings& settings = document.planner.volumetric;
  const double views = static_cast<double>(view_limit(document)) * settings.candidates_per_view;
  survey::volumetric::VolumetricConfig config{
      .metric = metric,
      .resolution = document.planner.sampling.resolution_radius,
      .spacing = compute_spacing(document),
      .scene_box = document.planner.sampling.scene_box,
      .candidates = static_cast<std::size_t>(std::lround(views)),
      .min_height = min_view_height(document),
      .settings = settings};
  if (settings.sphere_centre) config.sphere_centre = *settings.sphere_centre;
  if (settings.sphere_radius) config.sphere_radius = *settings.sphere_radius;
  return config;
}

survey::pb_nbv::PbNbvConfig pb_nbv_config(const MissionDocument& document,
                                          const survey::PlannerOptions& planner) {
  using survey::pb_nbv::Reading;
  return {.settings = document.planner.pb_nbv,
          .reading = planner.name == survey::PlannerName::pb_nbv_released ? Reading::released
                                                                          : Reading::published,
          .view_distance = planner.view_distance,
          .spacing = planner.spacing,
          .scene_box = planner.scene_box,
          .limits = planner.limits};
}

survey::fixed_views::FixedViewsConfig fixed_views_config(const MissionDocument& document,
                                                         const survey::PlannerOptions& planner) {
  survey::fixed_views::FixedViewsConfig config{
      .settings = document.planner.fixed_views,
      .spacing = planner.spacing,
      .scene_box = planner.scene_box,
      .limits = planner.limits,
      .sphere_centre = document.planner.volumetric.sphere_centre,
      .sphere_radius = document.planner.volumetric.sphere_radius};
  if (planner.name == survey::PlannerName::random) {
    config.settings.set = survey::fixed_views::ViewSet::random;
  }
  return config;
}

/// Returns the target that the mission specifies, or nullopt if the scene must grant it.
std::optional<survey::patterns::PatternTarget> pattern_target(const MissionDocument& document) {
  using namespace survey::patterns;
  const PatternSettings& settings = document.planner.patterns;
  if (settings.top) {
    const double base = settings.base.value_or(compute_ground_height(document));
    if (!settings.polygon.empty()) return target_of_polygon(settings.polygon, base, *settings.top);
    return target_of_line(settings.line, settings.width, base, *settings.top);
  }
  if (!document.scene.priors) return std::nullopt;
  const site_data::SitePriors& site = *document.scene.priors;
  const geometry::Mesh surfaces = make_surfaces(site, Role::target);
  if (!surfaces.triangles.empty()) return target_of(triangle_corners(surfaces));
  AlignedBox3d box;
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role == Role::target) box.extend(site.priors[i].box);
  }
  return box.isEmpty() ? std::nullopt : std::optional(target_of(box));
}

survey::patterns::PatternConfig pattern_config(const MissionDocument& document,
                                               survey::patterns::Pattern pattern,
                                               const survey::PlannerOptions& planner) {
  const sim::SurveySensorOptions& sensor = document.sensor.options;
  const Eigen::Vector2d half_fov(0.5 * planner.camera.horizontal_fov,
                                 0.5 * planner.camera.vertical_fov);
  survey::patterns::PatternConfig config{
      .pattern = pattern,
      .settings = document.planner.patterns,
      .spacing = planner.spacing,
      .scene_box = planner.scene_box,
      .limits = planner.limits,
      .view_distance = planner.view_distance,
      .max_distance = planner.camera.max_range,
      .footprint = {2.0 * planner.view_distance * std::tan(half_fov.x()),
                    2.0 * planner.view_distance * std::tan(half_fov.y())},
      .ground = compute_ground_height(document),
      .is_swept = sensor.mount && find_scanner_kind(*sensor.scanner) != ScannerKind::rosette,
      .target = pattern_target(document)};
  if (document.flight.has_vehicle() && sensor.is_moving()) {
    config.frame_spacing = document.flight.options.cruise_speed * sensor.frame_period;
  }
  return config;
}

survey::external::ExternalConfig external_config(const MissionDocument& document,
                                                 const survey::PlannerOptions& planner) {
  survey::external::ExternalConfig config;
  config.file = document.planner.file.value_or("");
  config.make = [file = config.file, is_by_user = document.planner.is_file_by_user](
                    const survey::OwnPlannerTask& task) {
    if (!is_by_user) {
      throw Error(ErrorKind::bad_config,
                  "planner.file (" + file +
                      ") is code and is executed only if the command line names it; inspect the "
                      "file and add --set planner.file=" +
                      file);
    }
    return session::load_own_planner(file, task);
  };
  config.task = {.seed = 1,
                 .camera = planner.camera,
                 .spacing = planner.spacing,
                 .view_distance = planner.view_distance,
                 .scene_box = planner.scene_box};
  return config;
}

/// Returns the surfaces of the targets as prior surface for the planner, or null without targets.
std::shared_ptr<const survey::surfel::PriorSurface> prior_surface(
    const site_data::SitePriors& site, const geometry::CameraConfig& camera, double distance) {
  auto surface = std::make_shared<survey::surfel::PriorSurface>();
  // Spacing of the points: the planner's finest resolution is four pixels, so that one point each
  // suffices.
  const double pixel = distance / geometry::Camera(camera).focal_length_px().minCoeff();
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != Role::target) continue;
    for (const site_data::Object& object : site.priors[i].objects) {
      const site_data::SurfacePoints points =
          site_data::spread_over(object, max_target_points, 2.0 * pixel);
      surface->positions.insert(surface->positions.end(), points.positions.begin(),
                                points.positions.end());
      surface->normals.insert(surface->normals.end(), points.normals.begin(), points.normals.end());
      surface->areas.resize(surface->positions.size(), static_cast<float>(points.area_per_point));
      surface->uncertainties.resize(surface->positions.size(),
                                    static_cast<float>(site.priors[i].uncertainty));
    }
  }
  return surface->size() > 0 ? surface : nullptr;
}

}  // namespace

bool is_georeferenced(const MissionDocument& document) {
  return document.georeference.latitude_deg && document.georeference.longitude_deg;
}

flight::Site make_site(const MissionDocument& document) {
  const Georeference& georeference = document.georeference;
  flight::Site site;
  site.origin = {georeference.latitude_deg.value_or(0.0), georeference.longitude_deg.value_or(0.0),
                 georeference.ellipsoid_height};
  site.geoid_undulation = georeference.geoid_undulation;
  return site;
}

survey::see::SeeConfig see_config(const MissionDocument& document) {
  const SamplingSection& sampling = document.planner.sampling;
  survey::see::SeeConfig see = document.planner.see;
  see.density = sampling.density;
  see.resolution_radius = sampling.resolution_radius;
  see.spacing = sampling.spacing;
  see.view_distance = sampling.view_distance;
  see.scene_box = sampling.scene_box;
  return see;
}

double compute_density_distance(const MissionDocument& document) {
  const std::optional<double>& density = document.planner.sampling.density_per_m2;
  if (!density) return std::numeric_limits<double>::infinity();
  return std::sqrt(2.0 / (3.0 * std::numbers::sqrt3 * *density));
}

double compute_volume_density(const MissionDocument& document) {
  const SamplingSection& sampling = document.planner.sampling;
  return 0.75 * sampling.density_per_m2.value() / sampling.resolution_radius;
}

double compute_planned_distance(const MissionDocument& document) {
  return std::min(document.evaluation.registration_distance, compute_density_distance(document));
}

double compute_spacing(const MissionDocument& document) {
  return see_config(document).effective_spacing();
}

double compute_view_distance(const MissionDocument& document) {
  const SamplingSection& sampling = document.planner.sampling;
  return sampling.view_distance.value_or(geometry::view_distance(
      geometry::Camera(document.sensor.options.camera.camera), sampling.density));
}

AlignedBox3d compute_unknown_box(const MissionDocument& document) {
  return document.flight.unknown_box ? *document.flight.unknown_box
                                     : document.planner.sampling.scene_box.value_or(AlignedBox3d());
}

double compute_ground_height(const MissionDocument& document) {
  double height = document.scene.position.z();
  if (!document.scene.priors) return height;
  const site_data::SitePriors& site = *document.scene.priors;
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    const site_data::Prior& known = site.priors[i];
    if (site.sources[i].role != Role::terrain) continue;
    height = std::min(height, known.box.min().z() - known.uncertainty);
  }
  return height;
}

std::optional<double> min_view_height(const MissionDocument& document) {
  const std::optional<double>& clearance = document.limits.ground_clearance;
  return clearance ? std::optional(compute_ground_height(document) + *clearance) : std::nullopt;
}

survey::ViewLimits view_limits(const MissionDocument& document) {
  const LimitsSection& limits = document.limits;
  const sim::SurveySensorOptions& sensor = document.sensor.options;
  survey::ViewLimits result{.min_height = document.site.min_height,
                            .max_height = document.site.max_height,
                            .geofence = document.site.geofence,
                            .no_fly = document.site.no_fly,
                            .min_standoff = limits.min_standoff,
                            .min_pitch = limits.min_pitch,
                            .max_pitch = limits.max_pitch};
  if (const std::optional<double> min = min_view_height(document)) {
    result.min_height = std::max(*min, result.min_height.value_or(*min));
  }
  const auto terrain = document.scene.priors ? document.scene.priors->terrain : nullptr;
  if (terrain && limits.ground_clearance) {
    result.min_height_at = [terrain, plane = document.scene.position.z(),
                            clearance = *limits.ground_clearance](const Eigen::Vector2d& at) {
      return terrain->height(at).value_or(plane) + clearance;
    };
  }
  if (document.flight.has_vehicle()) {
    const flight::Vehicle& vehicle = document.flight.options.required_vehicle();
    constexpr double hair = 1e-5;  // tolerance, so that the pitch interval is not empty
    if (!sensor.mount) {           // only cameras are mounted on a gimbal
      // Less than the tolerance of flight::can_aim().
      const double margin = vehicle.gimbal_min == vehicle.gimbal_max ? 5e-7 : 0.0;
      result.min_pitch = std::max(result.min_pitch, vehicle.gimbal_min - margin);
      result.max_pitch = std::min(result.max_pitch, vehicle.gimbal_max + margin);
    } else if (find_scanner_kind(*sensor.scanner) == ScannerKind::rosette) {
      result.min_pitch = std::max(result.min_pitch, sensor.mount->view_pitch - hair);
      result.max_pitch = std::min(result.max_pitch, sensor.mount->view_pitch + hair);
    }
    result.min_standoff = std::max(result.min_standoff, document.flight.options.clearance);
  }
  return result;
}

std::size_t view_limit(const MissionDocument& document) {
  const std::size_t max_views = document.limits.options.max_views;
  if (survey::find_title(document.planner.name).metric) {
    return std::min(document.planner.volumetric.view_limit.value_or(usual_view_limit), max_views);
  }
  if (survey::is_pb_nbv(document.planner.name)) {
    return std::min(document.planner.pb_nbv.views, max_views);
  }
  return max_views;
}

bool has_target(const MissionDocument& document) {
  return has_role(document, Role::target) || has_outline_as_truth(document);
}

bool has_outline_as_truth(const MissionDocument& document) {
  const survey::patterns::PatternSettings& outline = document.planner.patterns;
  return document.scene.model == targets_as_truth && document.prior.empty() && outline.top &&
         (!outline.polygon.empty() || !outline.line.empty());
}

bool has_obstacle(const MissionDocument& document) { return has_role(document, Role::obstacle); }

std::optional<Role> truth_role(const MissionDocument& document) {
  if (document.scene.model == targets_as_truth) return Role::target;
  if (document.scene.model.empty() && has_role(document, Role::truth)) return Role::truth;
  return std::nullopt;
}

flight::FlightOptions flight_options(const MissionDocument& document) {
  flight::FlightOptions options = document.flight.options;
  options.unknown_box = compute_unknown_box(document);
  options.has_own_box = document.flight.unknown_box.has_value();
  const std::vector<Vector3d>& corners = document.flight.extra_unknown_boxes;
  for (std::size_t i = 0; i + 1 < corners.size(); i += 2) {
    options.extra_unknown_boxes.emplace_back(corners[i], corners[i + 1]);
  }
  options.airspace = airspace_options(document);
  options.capture = capture_options(document);
  options.site = make_site(document);
  options.is_georeferenced = is_georeferenced(document);
  return options;
}

survey::PlannerOptions planner_options(const MissionDocument& document,
                                       const flight::FlightOptions& flight) {
  const SamplingSection& sampling = document.planner.sampling;
  survey::PlannerOptions options{.name = document.planner.name,
                                 .camera = document.sensor.options.camera.camera,
                                 .spacing = compute_spacing(document),
                                 .view_distance = compute_view_distance(document),
                                 .resolution_radius = sampling.resolution_radius,
                                 .scene_box = sampling.scene_box,
                                 .max_incidence = document.sensor.options.camera.max_incidence,
                                 .limits = view_limits(document)};
  if (const auto metric = survey::find_title(options.name).metric) {
    options.method = volumetric_config(document, *metric);
  } else if (options.name == survey::PlannerName::skycap) {
    options.method = skycap_config(document, flight);
    if (document.scene.priors) {
      options.prior_surface = [priors = document.scene.priors, camera = options.camera,
                               distance = options.view_distance] {
        return prior_surface(*priors, camera, distance);
      };
    }
  } else if (survey::is_pb_nbv(options.name)) {
    options.method = pb_nbv_config(document, options);
  } else if (survey::has_fixed_views(options.name)) {
    options.method = fixed_views_config(document, options);
  } else if (const auto pattern = survey::pattern_of(options.name)) {
    options.method = pattern_config(document, *pattern, options);
  } else if (options.name == survey::PlannerName::external) {
    options.method = external_config(document, options);
  } else {
    survey::see::SeeConfig see = see_config(document);
    see.min_height = min_view_height(document);
    options.method = see;
  }
  return options;
}

session::StartOptions start_options(const MissionDocument& document,
                                    const flight::FlightOptions& flight) {
  const double base = document.scene.position.z();
  const auto& scanner = document.sensor.options.scanner;
  session::StartOptions start{
      .box = flight.unknown_box,
      .clearance = flight.clearance,
      .min_height = std::max(view_limits(document).min_height.value_or(base), base),
      .view_distance = flight.capture.view_distance,
      .mount = document.sensor.options.mount,
      .sees_lines = scanner && find_scanner_kind(*scanner) == ScannerKind::line};
  if (flight.has_vehicle()) start.initial_pattern = document.flight.initial_pattern;
  if (const auto& position = document.start.position) {
    start.view = document.start.look_at
                     ? geometry::look_at(*position, *document.start.look_at)
                     : geometry::View{*position, document.start.direction->normalized()};
  }
  return start;
}

}  // namespace skycap::missions::config
