#include "missions/scene/survey_scene.h"

#include <fstream>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/place/camera.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/mission_priors.h"
#include "missions/derived/site.h"
#include "missions/derived/survey_sensor.h"
#include "missions/file/mission_keys.h"
#include "missions/scene/model_store.h"
#include "missions/scene/scene_source.h"
#include "missions/scene/sha256.h"

namespace skycap::missions::scene {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t sample_seed = 1;  // coverage is measured by the same samples in all runs
constexpr std::uint64_t ceiling_seed = 1;

sim::Scene scene_of(const geometry::Mesh& model, const file::Mission& mission,
                    const std::filesystem::path& folder) {
  if (mission.sensor.scanner) {  // what a laser measures depends on the surfaces' reflectances
    return reflecting_scene(mission, folder).scene(mission.threads);
  }
  if (!mission.scene.ground) return sim::Scene(model, mission.threads);
  geometry::Mesh mesh = model;
  geometry::append(mesh, ground_of(mission, model));
  return sim::Scene(mesh, mission.threads);
}

Vector3d uniform_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  for (;;) {
    // From z to x, one a declarator: arguments of a call are drawn in an order that is each
    // compiler's own.
    const double z = normal(random), y = normal(random), x = normal(random);
    const Vector3d direction(x, y, z);
    if (direction.norm() > 1e-3) return direction.normalized();
  }
}

ViewSphere sphere_around(std::span<const Eigen::Vector3f> surface, double view_distance) {
  Vector3d centroid = Vector3d::Zero();
  for (const auto& point : surface) centroid += point.cast<double>();
  centroid /= static_cast<double>(surface.size());
  double mean_distance = 0.0;
  for (const auto& point : surface) mean_distance += (point.cast<double>() - centroid).norm();
  mean_distance /= static_cast<double>(surface.size());
  return {centroid, view_distance + mean_distance};
}

std::optional<double> number_in_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  double number = 0.0;
  return stream >> number ? std::optional(number) : std::nullopt;
}

}  // namespace

geometry::Mesh placed_model(const file::Mission& mission, const std::filesystem::path& folder) {
  if (derived::is_truth_prior(mission)) return derived::prior_truth(mission);
  const file::SceneConfig& scene = mission.scene;
  geometry::Mesh model = load_model(scene, folder);
  place_model(scene, model);
  return scene.copies.empty() ? model : with_copies(scene, model);
}

SurveyScene::SurveyScene(const file::Mission& mission, const std::filesystem::path& folder)
    : mission_(mission),
      model_(placed_model(mission, folder)),
      scene_(scene_of(model_, mission, folder)),
      samples_(geometry::sample_surface(model_, mission.evaluation.samples, sample_seed)),
      view_distance_(mission.planner.see.view_distance.value_or(geometry::view_distance(
          geometry::Camera(mission.sensor.camera.camera), mission.planner.see.density))),
      view_sphere_(sphere_around(samples_.points, view_distance_)) {
  if (derived::view_limits(mission).stand_off > 0.0) {
    truth_ = std::make_shared<geometry::MeshDistance>(model_);
  }
}

geometry::View SurveyScene::first_view(std::uint64_t seed) const {
  if (const auto start = derived::given_start(mission_)) return *start;

  const survey::ViewLimits limits = derived::view_limits(mission_);
  std::mt19937_64 random(seed);
  constexpr int most_attempts = 10'000;
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    const Vector3d position = view_sphere_.centre + view_sphere_.radius * uniform_direction(random);
    const geometry::View view = geometry::look_at(position, view_sphere_.centre);
    if (limits.allow(view) && derived::is_in_known_airspace(mission_, position)) return view;
  }
  throw Error(
      ErrorKind::bad_config,
      "limits.ground_clearance, the gimbal's pitch, the site and flight.unknown_box leave no place "
      "for a random start at the view distance of " +
          file::to_text(view_distance_) + " m; loosen them or give start.position");
}

judge::Admissible SurveyScene::admissible() const {
  survey::ViewLimits limits = derived::view_limits(mission_);
  // A surface need not be in the middle of the image.
  const double half_fov = 0.5 * mission_.sensor.camera.camera.vertical_fov;
  limits.least_pitch -= half_fov;
  limits.most_pitch += half_fov;
  const auto allows = [limits, truth = truth_](const geometry::View& view) {
    return limits.allow(view) &&
           (limits.stand_off == 0.0 || truth->distance(view.position) >= limits.stand_off);
  };
  return {.view_distance = view_distance_,
          .allows = allows,
          .directions = mission_.evaluation.visible_directions,
          .clearance = 0.01 * mission_.evaluation.registration_distance};
}

std::vector<std::uint8_t> SurveyScene::visible(unsigned threads, std::stop_token stop) const {
  return judge::visible_samples(samples_.points, scene_, admissible(), threads, std::move(stop));
}

std::optional<double> SurveyScene::ceiling(const std::vector<std::uint8_t>& is_visible,
                                           unsigned threads, std::stop_token stop) const {
  if (mission_.evaluation.ceiling_views == 0) return std::nullopt;
  const std::filesystem::path cached = user_cache() / "ceilings" / ceiling_key();
  if (const auto known = number_in_file(cached); known && *known >= 0.0 && *known <= 1.0) {
    return known;
  }

  judge::CeilingConfig config;
  config.views = mission_.evaluation.ceiling_views;
  config.spacing = mission_.planner.see.effective_spacing();
  config.registration_distance = mission_.evaluation.registration_distance;
  if (mission_.planner.see.scene_box) config.box = *mission_.planner.see.scene_box;
  config.seed = ceiling_seed;
  const derived::SurveySensor sensor(mission_.sensor, mission_.sensor.camera.noise.seed);
  const auto take_scan = [&](const geometry::View& view, std::uint64_t frame,
                             geometry::Scan recycled) {
    return sensor.scan(scene_, view, frame, threads, std::move(recycled));
  };
  const double ceiling = judge::coverage_ceiling(samples_.points, is_visible, scene_, take_scan,
                                                 admissible(), config, stop);
  if (stop.stop_requested()) return std::nullopt;
  try {
    std::ostringstream text;
    text.precision(17);
    text << ceiling << "\n";
    geometry::write_file(cached, text.str());
  } catch (const Error&) {
    // Without a cache it is computed again next time.
  }
  return ceiling;
}

std::string SurveyScene::ceiling_key() const {
  std::ostringstream inputs;
  inputs.precision(17);
  inputs << "ceiling 2\n" << view_distance_ << " " << mission_.planner.see.effective_spacing();
  for (const file::Key& key : file::mission_keys()) {
    if (!key.path.starts_with("scene.") && !key.path.starts_with("sensor.") &&
        !key.path.starts_with("evaluation.") && !key.path.starts_with("planner.scene_box") &&
        !key.path.starts_with("site.") && key.path != "limits.ground_clearance" &&
        key.path != "limits.stand_off" && !key.path.ends_with("_pitch_deg") &&
        key.path != "flight.vehicle" && key.path != "flight.clearance") {
      continue;
    }
    const auto value = key.get(mission_);
    inputs << "\n" << key.path << " " << (value ? file::to_text(*value) : "-");
  }
  // The surface's samples stand for the mesh that was found under the model's name.
  inputs << "\n" << sha256(std::as_bytes(std::span(samples_.points)));
  const std::string text = inputs.str();
  return sha256(std::as_bytes(std::span(text)));
}

}  // namespace skycap::missions::scene
