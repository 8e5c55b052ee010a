#include <filesystem>
#include <span>
#include <stop_token>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh.h"
#include "missions/derived/resolved_mission.h"
#include "missions/file/json_text.h"
#include "missions/judge/accuracy.h"
#include "missions/judge/coverage.h"
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

/// What is told of the cloud or mesh that is compared.
struct Judged {
  std::filesystem::path file;
  std::size_t points = 0;  ///< measured, or spread over the mesh
  double coverage = 0.0;
  judge::CloudAccuracy accuracy;
};

/// Piece by piece: laser scans are longer than memory.
Judged judged_cloud(const std::filesystem::path& file, const Truth& truth,
                    const geometry::SurfaceSamples& samples, ProgressLine& progress,
                    const std::stop_token& stop) {
  judge::CoverageMeter coverage(samples.points, truth.registration_distance);
  judge::AccuracyMeter accuracy(truth.model);
  geometry::read_positions(file, [&](std::span<const Eigen::Vector3f> piece, double share) {
    if (stop.stop_requested()) throw Error(ErrorKind::bad_usage, "interrupted");
    progress.show(fmt::format("{}: {:.0f} %", file.string(), 100.0 * share));
    coverage.add(piece);
    accuracy.add(piece);
  });
  return {file, accuracy.points(), coverage.share(), accuracy.accuracy()};
}

/// Of a mesh the whole surface counts, not its vertices.
Judged judged_mesh(const std::filesystem::path& file, const Truth& truth,
                   const geometry::SurfaceSamples& samples) {
  const geometry::Mesh mesh = geometry::read_mesh(file);
  const std::vector<Eigen::Vector3f> points =
      geometry::sample_surface(mesh, truth.samples, 2).points;
  judge::AccuracyMeter accuracy(truth.model), completeness(mesh);
  accuracy.add(points);
  completeness.add(samples.points);
  return {file, points.size(), completeness.share_within(truth.registration_distance),
          accuracy.accuracy()};
}

}  // namespace

int evaluate(const EvaluateOptions& options, const Console& console) {
  ProgressLine progress(console, false);
  progress.show("making " + options.model + " ready");
  const Truth truth = truth_of(options);
  const geometry::SurfaceSamples samples = geometry::sample_surface(truth.model, truth.samples, 1);
  const bool is_mesh = !options.mesh.empty();
  progress.show("reading " + (is_mesh ? options.mesh : options.cloud).string());
  const Judged judged = is_mesh
                            ? judged_mesh(options.mesh, truth, samples)
                            : judged_cloud(options.cloud, truth, samples, progress, console.stop);
  const judge::CloudAccuracy& accuracy = judged.accuracy;
  progress.clear();
  const double area = geometry::surface_area(truth.model);
  const double density = static_cast<double>(judged.points) / area;

  if (options.is_json) {
    const nlohmann::ordered_json json{{is_mesh ? "mesh" : "cloud", judged.file.string()},
                                      {"model", options.model},
                                      {"points", judged.points},
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
      judged.file.filename().string(), judged.points, options.model, 100.0 * judged.coverage,
      truth.registration_distance, accuracy.mean, accuracy.root_mean_square, accuracy.median,
      accuracy.percentile_95, accuracy.largest, density, area);
  return 0;
}

}  // namespace skycap::missions::verbs
