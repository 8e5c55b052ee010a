#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/mesh_io.h"
#include "geometry/parallel.h"
#include "geometry/surfaces/mesh.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/derived/resolved_mission.h"
#include "missions/file/json_text.h"
#include "missions/judge/coverage.h"
#include "missions/judge/evaluation.h"
#include "missions/scene/scene_source.h"
#include "missions/scene/survey_scene.h"
#include "missions/verbs/verbs.h"

namespace skycap::missions::verbs {
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
    const file::Mission mission = derived::read_mission(file);
    return {scene::placed_model(mission, file.parent_path()),
            options.distance.value_or(mission.evaluation.registration_distance),
            mission.evaluation.samples};
  }
  if (!options.distance) {
    throw Error(ErrorKind::bad_usage,
                "--distance is missing; give the distance within which a surface point counts as "
                "covered, in metres");
  }
  file::SceneConfig scene;
  scene.model = options.model;
  try {
    return {scene::load_model(scene, ""), *options.distance, options.samples};
  } catch (const Error& error) {
    throw Error(error.kind(), std::string("--model: ") + error.what());
  }
}

/// What is compared with the truth.
struct Judged {
  std::filesystem::path file;
  std::vector<Eigen::Vector3f> points;  ///< measured, or spread over the mesh
  double coverage = 0.0;
};

Judged judged_cloud(const std::filesystem::path& file, const Truth& truth,
                    const geometry::SurfaceSamples& samples) {
  Judged judged{file, geometry::read_cloud(file).positions};
  judge::CoverageMeter meter(samples.points, truth.registration_distance);
  meter.add(judged.points);
  judged.coverage = meter.share();
  return judged;
}

/// Of a mesh the whole surface counts, not its vertices.
Judged judged_mesh(const std::filesystem::path& file, const Truth& truth,
                   const geometry::SurfaceSamples& samples) {
  const geometry::Mesh mesh = geometry::read_mesh(file);
  Judged judged{file, geometry::sample_surface(mesh, truth.samples, 2).points};
  const geometry::MeshDistance distance(mesh);
  std::vector<std::uint8_t> is_covered(samples.points.size());
  constexpr std::size_t batch = 256;
  const std::size_t batches = (is_covered.size() + batch - 1) / batch;
  geometry::parallel_for(batches, 0, [&](std::size_t part) {
    const std::size_t end = std::min(is_covered.size(), (part + 1) * batch);
    for (std::size_t i = part * batch; i < end; ++i) {
      is_covered[i] =
          distance.distance(samples.points[i].cast<double>()) <= truth.registration_distance;
    }
  });
  judged.coverage = static_cast<double>(std::ranges::count(is_covered, 1)) /
                    static_cast<double>(is_covered.size());
  return judged;
}

}  // namespace

int evaluate(const EvaluateOptions& options, const Console& console) {
  ProgressLine progress(console, false);
  progress.show("making " + options.model + " ready");
  const Truth truth = truth_of(options);
  const geometry::SurfaceSamples samples = geometry::sample_surface(truth.model, truth.samples, 1);
  const bool is_mesh = !options.mesh.empty();
  progress.show("reading " + (is_mesh ? options.mesh : options.cloud).string());
  const Judged judged = is_mesh ? judged_mesh(options.mesh, truth, samples)
                                : judged_cloud(options.cloud, truth, samples);
  const std::vector<Eigen::Vector3f>& points = judged.points;
  progress.show("measuring the distances of " + std::to_string(points.size()) + " points");
  const judge::CloudAccuracy accuracy = judge::cloud_accuracy(points, truth.model);
  progress.clear();
  const double area = geometry::surface_area(truth.model);
  const double density = static_cast<double>(points.size()) / area;

  if (options.is_json) {
    const nlohmann::ordered_json json{{is_mesh ? "mesh" : "cloud", judged.file.string()},
                                      {"model", options.model},
                                      {"points", points.size()},
                                      {"registration_distance_m", truth.registration_distance},
                                      {"samples", truth.samples},
                                      {"coverage", judged.coverage},
                                      {"distance_to_model_m",
                                       {{"mean", accuracy.mean},
                                        {"root_mean_square", accuracy.root_mean_square},
                                        {"median", accuracy.median},
                                        {"percentile_95", accuracy.percentile_95},
                                        {"largest", accuracy.largest}}},
                                      {"area_m2", area},
                                      {"points_per_m2", density}};
    console.out << file::json_text(json);
    return 0;
  }
  console.out << fmt::format(
      "{}: {} points against {}\n"
      "  coverage  {:.2f} % of the surface within {:g} m\n"
      "  accuracy  mean {:.4g} m, rms {:.4g} m, median {:.4g} m, 95 % below {:.4g} m, largest "
      "{:.4g} m\n"
      "  density   {:.4g} points per m^2 of the surface's {:.4g} m^2\n",
      judged.file.filename().string(), points.size(), options.model, 100.0 * judged.coverage,
      truth.registration_distance, accuracy.mean, accuracy.root_mean_square, accuracy.median,
      accuracy.percentile_95, accuracy.largest, density, area);
  return 0;
}

}  // namespace skycap::missions::verbs
