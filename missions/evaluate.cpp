#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "geometry/cloud_io.h"
#include "geometry/error.h"
#include "geometry/mesh.h"
#include "missions/coverage.h"
#include "missions/evaluation.h"
#include "missions/json_text.h"
#include "missions/scene_source.h"
#include "missions/survey_scene.h"
#include "missions/verbs.h"

namespace skycap::missions {
namespace {

/// What a cloud is compared with.
struct Truth {
  geometry::Mesh model;
  double registration_distance;
  std::size_t samples;
};

bool is_mission_file(const std::filesystem::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

Truth truth_of(const EvaluateOptions& options) {
  if (is_mission_file(options.model)) {
    const std::filesystem::path file = options.model;
    const Mission mission = read_mission(file);
    return {placed_model(mission.scene, file.parent_path()),
            options.distance.value_or(mission.evaluation.registration_distance),
            mission.evaluation.samples};
  }
  if (!options.distance) {
    throw Error(ErrorKind::bad_usage,
                "--distance is missing; give the distance within which a surface point counts as "
                "covered, in metres");
  }
  SceneConfig scene;
  scene.model = options.model;
  return {load_model(scene, ""), *options.distance, options.samples};
}

}  // namespace

int evaluate(const EvaluateOptions& options, const Console& console) {
  const std::vector<Eigen::Vector3f> points = geometry::read_cloud(options.cloud).positions;
  const Truth truth = truth_of(options);
  const geometry::SurfaceSamples samples = geometry::sample_surface(truth.model, truth.samples, 1);
  CoverageMeter meter(samples.points, truth.registration_distance);
  meter.add(points);
  const CloudAccuracy accuracy = cloud_accuracy(points, truth.model);
  const double area = geometry::surface_area(truth.model);
  const double density = static_cast<double>(points.size()) / area;

  if (options.is_json) {
    const nlohmann::ordered_json json{{"cloud", options.cloud.string()},
                                      {"model", options.model},
                                      {"points", points.size()},
                                      {"registration_distance_m", truth.registration_distance},
                                      {"samples", truth.samples},
                                      {"coverage", meter.share()},
                                      {"distance_to_model_m",
                                       {{"mean", accuracy.mean},
                                        {"root_mean_square", accuracy.root_mean_square},
                                        {"median", accuracy.median},
                                        {"percentile_95", accuracy.percentile_95},
                                        {"largest", accuracy.largest}}},
                                      {"area_m2", area},
                                      {"points_per_m2", density}};
    console.out << json_text(json);
    return 0;
  }
  char text[640];
  std::snprintf(text, sizeof text,
                "%s: %zu points against %s\n"
                "  coverage  %.2f %% of the surface within %g m\n"
                "  accuracy  mean %.4g m, rms %.4g m, median %.4g m, 95 %% below %.4g m, largest "
                "%.4g m\n"
                "  density   %.4g points per m^2 of the surface's %.4g m^2\n",
                options.cloud.filename().c_str(), points.size(), options.model.c_str(),
                100.0 * meter.share(), truth.registration_distance, accuracy.mean,
                accuracy.root_mean_square, accuracy.median, accuracy.percentile_95,
                accuracy.largest, density, area);
  console.out << text;
  return 0;
}

}  // namespace skycap::missions
