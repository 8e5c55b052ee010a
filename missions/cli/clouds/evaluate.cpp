#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/mesh_io.h"
#include "missions/cli/clouds/evaluation.h"
#include "missions/evaluation/accuracy.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/scene/scene_source.h"
#include "missions/support/json_text.h"

namespace skycap::missions::cli {
namespace {

bool is_mission_file(const std::filesystem::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

/// Piece by piece: laser scans are longer than memory.
evaluation::CloudJudgement judged_cloud(const EvaluateOptions& options, const Truth& truth,
                                        ProgressLine& progress, const Console& console) {
  const std::filesystem::path& file = options.cloud;
  evaluation::CloudJudge judge(truth.model, truth.samples, truth.registration_distance,
                               options.threads, truth.beside);
  const auto take = [&](std::span<const Eigen::Vector3f> piece, double share) {
    if (console.stop.stop_requested()) throw Error(ErrorKind::bad_usage, "interrupted");
    progress.show(fmt::format("{}: {:.0f} %", file.string(), 100.0 * share));
    judge.add(piece);
  };
  const std::size_t skipped = geometry::read_positions(file, take);
  progress.clear();
  if (skipped > 0) {
    warn(console, fmt::format("{}: {} points skipped (NaN or infinite)", file.string(), skipped));
  }
  return judge.judgement();
}

/// Of a mesh the whole surface counts, not its vertices.
evaluation::CloudJudgement judged_mesh(const EvaluateOptions& options, const Truth& truth) {
  const geometry::Mesh mesh = geometry::read_mesh(options.mesh);
  evaluation::AccuracyMeter accuracy(truth.model, options.threads, truth.beside);
  evaluation::AccuracyMeter completeness(mesh, options.threads);
  constexpr std::uint64_t seed = 2;  // not the places that are asked about
  accuracy.add(geometry::sample_surface(mesh, truth.samples, seed).points);
  completeness.add(evaluation::places_asked(truth.model, truth.samples));
  return {accuracy.points(), accuracy.beside(),
          completeness.share_within(truth.registration_distance), accuracy.accuracy(),
          geometry::surface_area(truth.model)};
}

/// Of what is visible; nothing where nobody says from where.
std::optional<double> visible_share(const evaluation::CloudJudgement& judged, const Truth& truth) {
  if (judged.is_covered.size() != truth.is_visible.size()) return std::nullopt;
  return evaluation::covered_share(judged.is_covered, truth.is_visible);
}

}  // namespace

Truth truth_of(const EvaluateOptions& options, bool wants_visible, const config::Report& report,
               const std::stop_token& stop) {
  if (is_mission_file(options.model)) {
    const std::filesystem::path file = options.model;
    const config::MissionSetup setup = config::read_mission(file, {}, report);
    const double distance = options.distance.value_or(setup.evaluation().registration_distance);
    const auto beside = [&](const geometry::Mesh& model) {
      return scene::surroundings_of(setup.scene(), geometry::bounding_box(model));
    };
    if (!wants_visible) {
      const geometry::Mesh model = evaluation::placed_model(setup.scene(), file.parent_path());
      return {model, beside(model), distance, setup.evaluation().samples};
    }
    const evaluation::SurveyScene scene(setup.simulation, file.parent_path(), setup.run.threads);
    return {scene.model(), beside(scene.model()), distance, setup.evaluation().samples,
            scene.visible(setup.run.threads, stop)};
  }
  if (!options.distance) {
    throw Error(ErrorKind::bad_usage,
                "missing argument: --distance, the coverage distance in metres");
  }
  const scene::SceneOptions scene{.model = options.model};
  try {
    return {scene::load_model(scene, ""), {}, *options.distance, options.samples};
  } catch (const Error& error) {
    throw Error(error.kind(), std::string("--model: ") + error.what());
  }
}

nlohmann::ordered_json evaluation_json(const EvaluateOptions& options, const Truth& truth,
                                       const evaluation::CloudJudgement& judged) {
  const evaluation::CloudAccuracy& accuracy = judged.accuracy;
  const std::optional<double> visible = visible_share(judged, truth);
  const bool is_mesh = !options.mesh.empty();
  return {
      {is_mesh ? "mesh" : "cloud", (is_mesh ? options.mesh : options.cloud).string()},
      {"model", options.model},
      {"points", judged.points},
      {"points_beside", judged.beside},
      {"registration_distance_m", truth.registration_distance},
      {"samples", truth.samples},
      {"coverage", judged.coverage},
      {"coverage_visible", visible ? nlohmann::ordered_json(*visible) : nlohmann::ordered_json()},
      {"distance_to_model_m",
       {{"mean", accuracy.mean},
        {"root_mean_square", accuracy.root_mean_square},
        {"median", accuracy.median},
        {"percentile_95", accuracy.percentile_95},
        {"largest", accuracy.largest}}},
      {"area_m2", judged.area},
      {"points_per_m2", judged.density()}};
}

void print_evaluation(const EvaluateOptions& options, const Truth& truth,
                      const evaluation::CloudJudgement& judged, std::ostream& out) {
  if (options.is_json) {
    out << support::json_text(evaluation_json(options, truth, judged));
    return;
  }
  const evaluation::CloudAccuracy& accuracy = judged.accuracy;
  const std::optional<double> visible = visible_share(judged, truth);
  const std::filesystem::path& file = options.mesh.empty() ? options.cloud : options.mesh;
  out << fmt::format(
      "{}: {} points against {}{}\n  coverage  {:.2f}% of the surface within {:g} m{}\n  accuracy  "
      "mean {:.4g} m, rms {:.4g} m, median {:.4g} m, 95% below {:.4g} m, maximum {:.4g} m\n  "
      "density   {:.4g} points per m^2 of the surface ({:.4g} m^2)\n",
      file.filename().string(), judged.points, options.model,
      truth.beside.triangles.empty()
          ? ""
          : fmt::format("; {} more on the ground and on neighbours", judged.beside),
      100.0 * judged.coverage, truth.registration_distance,
      visible ? fmt::format(", {:.2f}% of the visible surface", 100.0 * *visible) : "",
      accuracy.mean, accuracy.root_mean_square, accuracy.median, accuracy.percentile_95,
      accuracy.largest, judged.density(), judged.area);
}

int evaluate(const EvaluateOptions& options, const Console& console) {
  if (options.pieces > 0) return split_evaluation(options, console);
  if (options.task.is_given() || options.out) {
    throw Error(ErrorKind::bad_usage,
                "--out, --index, --chunk, --collect and --submit require --pieces");
  }
  ProgressLine progress(console, options.is_quiet);
  progress.show("loading " + options.model);
  const Truth truth = truth_of(options, true, progress.teller(), console.stop);
  const bool is_mesh = !options.mesh.empty();
  progress.show("reading " + (is_mesh ? options.mesh : options.cloud).string());
  const evaluation::CloudJudgement judged =
      is_mesh ? judged_mesh(options, truth) : judged_cloud(options, truth, progress, console);
  progress.clear();
  print_evaluation(options, truth, judged, console.out);
  return 0;
}

}  // namespace skycap::missions::cli
