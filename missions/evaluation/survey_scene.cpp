#include "missions/evaluation/survey_scene.h"

#include <algorithm>
#include <array>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/random_numbers.h"
#include "missions/scene/model_store.h"
#include "missions/scene/scene_source.h"
#include "missions/session/initial_pattern_flight.h"
#include "missions/support/sha256.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::evaluation {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t sample_seed = 1;  // coverage is evaluated at the same samples in all runs
constexpr std::uint64_t attainable_seed = 1;

/// Returns the surfaces of the triangles of placed_model(); empty if all are matt.
std::vector<sim::Surface> make_surfaces(const scene::SceneOptions& options,
                                        const std::filesystem::path& folder) {
  if (options.is_truth_prior()) return {};
  const std::vector<sim::Surface> one = scene::load_surfaces(options, folder);
  std::vector<sim::Surface> all;
  for (std::size_t i = 0; i <= options.copies.size(); ++i) {
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

sim::Scene make_scene(const geometry::Mesh& model, const SimulationOptions& options,
                      const std::filesystem::path& folder, unsigned threads) {
  if (options.sensor.scanner) {  // laser measurements depend on the reflectance of surfaces
    return scene::reflecting_scene(options.scene, folder).scene(threads);
  }
  geometry::Mesh mesh = model;
  geometry::append(mesh, scene::make_surroundings(options.scene, geometry::bounding_box(model)));
  std::vector<sim::Surface> surfaces = make_surfaces(options.scene, folder);
  if (!surfaces.empty()) surfaces.resize(mesh.triangles.size(), sim::Surface::matt);
  return sim::Scene(std::array{sim::ScenePart{mesh, {}, {}, surfaces}}, threads);
}

std::string metres_text(double length) { return fmt::format("{:.12g}", length); }

Vector3d uniform_direction(geometry::RandomNumbers& random) {
  std::normal_distribution<double> normal;
  for (;;) {
    // Drawn in separate declarators, because the evaluation order of function arguments depends on
    // the compiler.
    const double z = normal(random), y = normal(random), x = normal(random);
    const Vector3d direction(x, y, z);
    if (direction.norm() > 1e-3) return direction.normalized();
  }
}

/// The sphere does not depend on evaluation.samples, so neither do the views of a survey.
survey::ViewSphere sphere_around(const geometry::Mesh& model, double view_distance) {
  constexpr std::size_t samples = 100'000;
  const std::vector<Eigen::Vector3f> surface =
      geometry::sample_surface(model, samples, sample_seed).points;
  Vector3d centroid = Vector3d::Zero();
  for (const auto& point : surface) centroid += point.cast<double>();
  centroid /= static_cast<double>(surface.size());
  double mean_distance = 0.0;
  for (const auto& point : surface) mean_distance += (point.cast<double>() - centroid).norm();
  mean_distance /= static_cast<double>(surface.size());
  return {centroid, view_distance + mean_distance};
}

/// Reads marks of samples, one digit per sample. Returns nullopt if the file does not contain
/// `count` digits.
std::optional<std::vector<std::uint8_t>> marks_in_file(const std::filesystem::path& file,
                                                       std::size_t count) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  const std::string digits = geometry::read_file(file);
  const auto is_mark = [](char digit) { return digit == '0' || digit == '1'; };
  if (digits.size() != count || !std::ranges::all_of(digits, is_mark)) return std::nullopt;
  std::vector<std::uint8_t> marks;
  for (const char digit : digits) marks.push_back(digit == '1' ? 1 : 0);
  return marks;
}

/// Stores a result. Errors are ignored, because it can be computed again.
void keep(const std::filesystem::path& file, const std::string& bytes) {
  try {
    geometry::write_file(file, bytes);
  } catch (const Error&) {
    return;
  }
}

void keep_marks(const std::filesystem::path& file, const std::vector<std::uint8_t>& marks) {
  std::string digits;
  for (const std::uint8_t mark : marks) digits += mark != 0 ? '1' : '0';
  keep(file, digits);
}

}  // namespace

geometry::Mesh placed_model(const scene::SceneOptions& options,
                            const std::filesystem::path& folder) {
  if (options.is_truth_prior()) return scene::prior_truth(options);
  geometry::Mesh model = scene::load_model(options, folder);
  scene::place_model(options, model);
  return options.copies.empty() ? model : scene::with_copies(options, model);
}

SurveyScene::SurveyScene(const SimulationOptions& options, const std::filesystem::path& folder,
                         unsigned threads, const std::filesystem::path& kept)
    : options_(options),
      threads_(threads),
      model_(placed_model(options.scene, folder)),
      scene_(make_scene(model_, options, folder, threads)),
      samples_(geometry::sample_surface(model_, options.evaluation.samples, sample_seed)),
      view_distance_(options.survey.planner.view_distance),
      view_sphere_(sphere_around(model_, view_distance_)),
      radius_(options.evaluation.radius.value_or(options.survey.planner.limits.min_standoff)),
      kept_(kept) {}

const ReachableSpace& SurveyScene::reachable() const {
  std::call_once(lazily_->reached_once, [&] {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(kept_, ignored)) {
      lazily_->reached = ReachableSpace::read(geometry::read_file(kept_));
    }
    if (lazily_->reached) return;
    lazily_->reached = reachable_space();
    if (!kept_.empty()) keep(kept_, lazily_->reached->bytes());
  });
  return *lazily_->reached;
}

const geometry::MeshDistance& SurveyScene::truth() const {
  std::call_once(lazily_->distance_once, [&] {
    geometry::Mesh all = model_;
    geometry::append(all, scene::prior_neighbours(options_.scene));
    lazily_->distance.emplace(all, threads_);
  });
  return *lazily_->distance;
}

ReachableSpace SurveyScene::reachable_space() const {
  const survey::ViewLimits& limits = options_.survey.planner.limits;
  const std::optional<geometry::View>& start = options_.survey.start.view;
  return {truth(),
          geometry::bounding_box(model_),
          {.radius = radius_,
           .min_height = limits.min_height,
           .max_height = limits.max_height,
           .start = start ? std::optional(start->position) : std::nullopt,
           .threads = threads_},
          [this](const Vector3d& position, const Vector3d& reached) {
            return has_line_of_sight(position, reached);
          }};
}

bool SurveyScene::has_line_of_sight(const Vector3d& a, const Vector3d& b) const {
  return !scene_.is_blocked(a, b);
}

bool SurveyScene::is_reachable(const Vector3d& position) const {
  return reachable().leads_to(position, [this](const Vector3d& from, const Vector3d& reached) {
    return has_line_of_sight(from, reached);
  });
}

geometry::View SurveyScene::first_view(std::uint64_t seed,
                                       const survey::PlannerOptions& planner) const {
  const session::StartOptions& begins = options_.survey.start;
  const std::vector<geometry::View> initial_pattern = session::initial_pattern_views(begins, seed);
  if (!initial_pattern.empty()) return initial_pattern.front();
  if (const auto& start = begins.view) {
    if (!reachable().is_empty()) return *start;
    throw Error(ErrorKind::bad_config,
                "start.position is inside the model or enclosed by it: a sphere with a radius of " +
                    metres_text(radius_ + reachable().cell()) +
                    " m does not fit through any opening; move start.position or lower "
                    "evaluation.passage_radius");
  }

  if (const auto view = first_pattern_view(planner)) return *view;
  const survey::ViewLimits& limits = options_.survey.planner.limits;
  geometry::RandomNumbers random(seed);
  constexpr int max_attempts = 10'000;
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    const Vector3d position = view_sphere_.centre + view_sphere_.radius * uniform_direction(random);
    geometry::View view = geometry::look_at(position, view_sphere_.centre);
    if (limits.allow(view) && options_.survey.flight.is_in_known_airspace(position) &&
        is_reachable(position)) {
      return view;
    }
  }
  throw Error(ErrorKind::bad_config,
              "no random start view at the view distance of " + metres_text(view_distance_) +
                  " m satisfies limits.ground_clearance, the gimbal's pitch limits, "
                  "evaluation.passage_radius, the site limits and flight.unknown_box; relax these "
                  "limits or set start.position");
}

std::optional<survey::patterns::PatternTarget> SurveyScene::pattern_target(
    const survey::PlannerOptions& planner) const {
  const auto* config = std::get_if<survey::patterns::PatternConfig>(&planner.method);
  if (config == nullptr || config->target) return std::nullopt;
  const std::vector<Eigen::Vector3d> corners = geometry::triangle_corners(model_);
  std::vector<Eigen::Vector3d> inside = corners;
  std::erase_if(inside, [&](const Eigen::Vector3d& corner) {
    return planner.scene_box && !planner.scene_box->contains(corner);
  });
  return survey::patterns::target_of(inside.empty() ? corners : inside);
}

/// Returns the first view of the pattern from which a survey can begin. If all of them are in
/// unknown space, returns the first one moved away from what it faces until it is outside. Nullopt
/// without a pattern, and if no such view exists.
std::optional<geometry::View> SurveyScene::first_pattern_view(
    const survey::PlannerOptions& planner) const {
  const auto* given = std::get_if<survey::patterns::PatternConfig>(&planner.method);
  if (given == nullptr) return std::nullopt;
  survey::patterns::PatternConfig config = *given;
  if (!config.target) config.target = pattern_target(planner);
  const survey::patterns::PlannedPattern plan = survey::patterns::plan_pattern(config);
  const flight::FlightOptions& flight = options_.survey.flight;
  const auto may_begin = [&](const geometry::View& view) {
    return flight.is_in_known_airspace(view.position) && is_reachable(view.position);
  };
  for (const geometry::View& view : plan.views) {
    for (const geometry::View& choice : survey::patterns::find_choices(config, view)) {
      if (may_begin(choice)) return choice;
    }
  }
  constexpr int steps = 40;
  const double step = (config.view_distance + 2.0 * flight.unknown_box.sizes().maxCoeff()) / steps;
  for (const geometry::View& view : plan.views) {
    for (int i = 1; i <= steps; ++i) {
      const geometry::View outside{view.position - i * step * view.direction, view.direction};
      if (config.limits.allow(outside) && may_begin(outside)) return outside;
    }
  }
  return std::nullopt;
}

Admissible SurveyScene::admissible() const {
  survey::ViewLimits limits = options_.survey.planner.limits;
  // The target may be anywhere in the image, not only at its centre.
  const double half_fov = 0.5 * options_.survey.planner.camera.vertical_fov;
  limits.min_pitch -= half_fov;
  limits.max_pitch += half_fov;
  const auto joins = [this](const Vector3d& position, const Vector3d& reached) {
    return radius_ > 0.0 ? truth().keeps(position, reached, radius_)
                         : has_line_of_sight(position, reached);
  };
  // Paths already keep the radius from the model. Neighbours are outside its box and require a
  // separate test.
  const bool asks_distance = limits.min_standoff > radius_ || options_.scene.neighbours;
  const double min = std::max(limits.min_standoff, radius_);
  const auto allows = [this, limits, joins, asks_distance, min](const geometry::View& view) {
    return limits.allow(view) && reachable().leads_to(view.position, joins) &&
           (!asks_distance || truth().distance(view.position) >= min);
  };
  return {.view_distance = view_distance_,
          .allows = allows,
          .directions = options_.evaluation.visible_directions,
          .clearance = 0.01 * options_.evaluation.registration_distance};
}

std::vector<std::uint8_t> SurveyScene::visible(unsigned threads,
                                               const std::stop_token& stop) const {
  const std::filesystem::path cached = scene::user_cache() / "visible" / attainable_key();
  if (auto known = marks_in_file(cached, samples_.points.size())) return std::move(*known);
  std::vector<std::uint8_t> marks =
      visible_samples(samples_.points, scene_, admissible(), threads, stop);
  // Glass and mirrors return no measurements.
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (scene_.surface(samples_.triangles[i]) != sim::Surface::matt) marks[i] = 0;
  }
  if (!stop.stop_requested()) keep_marks(cached, marks);
  return marks;
}

std::optional<std::vector<std::uint8_t>> SurveyScene::attainable(
    const std::vector<std::uint8_t>& is_visible, unsigned threads,
    const std::stop_token& stop) const {
  if (options_.evaluation.attainable_views == 0) return std::nullopt;
  const std::filesystem::path cached = scene::user_cache() / "ceilings" / attainable_key();
  if (auto known = marks_in_file(cached, samples_.points.size())) return known;

  AttainableConfig config;
  config.views = options_.evaluation.attainable_views;
  config.spacing = options_.survey.planner.spacing;
  config.registration_distance = options_.evaluation.registration_distance;
  config.box = options_.scene_box();
  config.seed = attainable_seed;
  const sim::SurveySensor sensor(options_.sensor, options_.sensor.camera.noise.seed);
  const auto capture_scan = [&](const geometry::View& view, std::uint64_t frame,
                                geometry::Scan buffer) {
    return sensor.scan(scene_, view, frame, threads, std::move(buffer));
  };
  std::vector<std::uint8_t> marks = attainable_samples(samples_.points, is_visible, scene_,
                                                       capture_scan, admissible(), config, stop);
  if (stop.stop_requested()) return std::nullopt;
  keep_marks(cached, marks);
  return marks;
}

std::string SurveyScene::attainable_key() const {
  std::ostringstream inputs;
  inputs.exceptions(std::ios::badbit);  // reports text lost because of low memory
  inputs.precision(17);
  inputs << "ceiling 4\n" << view_distance_ << " " << options_.survey.planner.spacing;
  inputs << options_.attainable_inputs;
  // The contents of a vehicle file, not only its name.
  const survey::ViewLimits& limits = options_.survey.planner.limits;
  inputs << "\n" << limits.min_pitch << " " << limits.max_pitch << " " << limits.min_standoff;
  // The surface samples identify the mesh found under the model's name.
  inputs << "\n" << support::sha256(std::as_bytes(std::span(samples_.points)));
  // Their materials identify the contents of a material file.
  for (std::size_t i = 0; i < samples_.triangles.size(); ++i) {
    const sim::Surface surface = scene_.surface(samples_.triangles[i]);
    if (surface != sim::Surface::matt) inputs << "\n" << i << " " << static_cast<int>(surface);
  }
  const std::string text = inputs.str();
  return support::sha256(std::as_bytes(std::span(text)));
}

}  // namespace skycap::missions::evaluation
