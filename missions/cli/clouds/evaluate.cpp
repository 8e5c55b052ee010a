#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/mesh_io.h"
#include "geometry/io/output_folder.h"
#include "geometry/io/record_log.h"
#include "geometry/parallel.h"
#include "geometry/surfaces/mesh.h"
#include "missions/cli/clouds/evaluate_change.h"
#include "missions/cli/clouds/evaluate_flight.h"
#include "missions/cli/commands.h"
#include "missions/cli/tasks.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/accuracy.h"
#include "missions/evaluation/cloud_evaluator.h"
#include "missions/evaluation/surface_density.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/evaluation/tally_file.h"
#include "missions/scan/scan_journal.h"
#include "missions/scene/scene_source.h"
#include "missions/support/json_text.h"
#include "missions/version.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

/// Ground truth for the evaluation of a cloud.
struct Truth {
  geometry::Mesh model;
  /// Adjacent objects that a mission's sensor observes: ground, neighbours.
  geometry::Mesh surroundings{};
  double registration_distance;
  std::size_t samples;
  std::vector<std::uint8_t> is_visible{};  ///< for each sample, if a mission says from where
  std::optional<flight::Site> site{};      ///< if a mission says where on the Earth it is
};

constexpr const char* density_raster_name = "density.tif";
constexpr const char* density_name = "density.json";

/// How densely the cloud covers the model, and the ground beside it.
class Density {
 public:
  Density(const EvaluateOptions& options, const Truth& truth)
      : options_(options),
        truth_(truth),
        meter_(evaluation::density_samples(truth.model, truth.surroundings,
                                           options.density_cell / samples_per_cell, margin),
               options.density_cell, options.threads),
        raster_(make_plan(truth.model), options.density_cell) {}

  void add(std::span<const Eigen::Vector3f> points) {
    meter_.add(points);
    raster_.add(points);
  }

  /// The files, and what is printed of them.
  std::string write() const {
    geometry::OutputFolder folder(*options_.density);
    folder.write(density_raster_name, raster_.geotiff(truth_.site));
    folder.write(density_name, support::json_text(json()));
    folder.commit();
    std::string text;
    for (const evaluation::SurfaceClass of : evaluation::surface_classes) {
      const auto figures = meter_.figures(options_.min_density, of);
      if (!figures) continue;
      text += fmt::format(
          "  {:<9} {:.2f}% of {:.4g} m^2 with at least {:g} points per m^2; mean "
          "{:.4g}, median {:.4g}, 5% below {:.4g}\n",
          evaluation::to_string(of), 100.0 * figures->share, figures->area, options_.min_density,
          figures->mean, figures->median, figures->percentile_5);
    }
    return text + fmt::format("  density   {}, {}\n",
                              (folder.path() / density_raster_name).string(),
                              (folder.path() / density_name).string());
  }

 private:
  static constexpr double samples_per_cell = 4.0, margin = 5.0;

  static Eigen::AlignedBox2d make_plan(const geometry::Mesh& model) {
    const Eigen::AlignedBox3d box = geometry::bounding_box(model);
    return {box.min().head<2>().array() - margin, box.max().head<2>().array() + margin};
  }

  static nlohmann::ordered_json figures_json(const evaluation::DensityFigures& figures) {
    return {{"area_m2", figures.area},
            {"share_with_min_density", figures.share},
            {"mean", figures.mean},
            {"median", figures.median},
            {"percentile_5", figures.percentile_5},
            {"histogram", figures.histogram}};
  }

  nlohmann::ordered_json json() const {
    nlohmann::ordered_json classes = nlohmann::ordered_json::object();
    for (const evaluation::SurfaceClass of : evaluation::surface_classes) {
      const auto figures = meter_.figures(options_.min_density, of);
      if (figures) classes[evaluation::to_string(of)] = figures_json(*figures);
    }
    return {{"cloud", options_.cloud.string()},
            {"model", options_.model},
            {"min_density", options_.min_density},
            {"radius_m", options_.density_cell},
            {"histogram_from", evaluation::density_bins},
            {"all", figures_json(meter_.figures(options_.min_density).value())},
            {"classes", classes},
            {"raster",
             {{"file", density_raster_name},
              {"cell_m", options_.density_cell},
              {"columns", raster_.columns()},
              {"rows", raster_.rows()}}}};
  }

  const EvaluateOptions& options_;
  const Truth& truth_;
  evaluation::DensityMeter meter_;
  evaluation::DensityRaster raster_;
};

bool is_mission_file(const fs::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

/// Evaluates a cloud in pieces, because laser scans may exceed memory.
evaluation::CloudEvaluation evaluate_cloud(const EvaluateOptions& options, const Truth& truth,
                                           ProgressLine& progress, const Console& console,
                                           Density* density) {
  const fs::path& file = options.cloud;
  evaluation::CloudEvaluator evaluator(truth.model, truth.samples, truth.registration_distance,
                                       options.threads, truth.surroundings);
  const auto add_points = [&](std::span<const Eigen::Vector3f> chunk, double share) {
    if (console.stop.stop_requested()) throw Error(ErrorKind::bad_usage, "interrupted");
    progress.show(fmt::format("{}: {:.0f} %", file.string(), 100.0 * share));
    evaluator.add(chunk);
    if (density != nullptr) density->add(chunk);
  };
  const std::size_t skipped = geometry::read_positions(file, add_points);
  progress.clear();
  if (skipped > 0) {
    warn(console, fmt::format("{}: {} points skipped (NaN or infinite)", file.string(), skipped));
  }
  return evaluator.result();
}

/// Evaluates a mesh by samples of its surface, because its vertices are unevenly distributed.
evaluation::CloudEvaluation evaluate_mesh(const EvaluateOptions& options, const Truth& truth) {
  const geometry::Mesh mesh = geometry::read_mesh(options.mesh);
  evaluation::AccuracyMeter accuracy(truth.model, options.threads, truth.surroundings);
  evaluation::AccuracyMeter completeness(mesh, options.threads);
  constexpr std::uint64_t seed = 2;  // differs from the seed of the ground-truth samples
  accuracy.add(geometry::sample_surface(mesh, truth.samples, seed).points);
  completeness.add(evaluation::sample_positions(truth.model, truth.samples));
  return {accuracy.points(), accuracy.surroundings(),
          completeness.share_within(truth.registration_distance), accuracy.accuracy(),
          geometry::surface_area(truth.model)};
}

/// Returns the covered fraction of the visible surface, or nullopt if the visibility is unknown.
std::optional<double> visible_share(const evaluation::CloudEvaluation& evaluated,
                                    const Truth& truth) {
  if (evaluated.is_covered.size() != truth.is_visible.size()) return std::nullopt;
  return evaluation::covered_share(evaluated.is_covered, truth.is_visible);
}

/// Reads the ground truth of options.model. The visibility is computed only if `wants_visible`.
/// Throws Error.
Truth make_truth(const EvaluateOptions& options, bool wants_visible, const config::Report& report,
                 const std::stop_token& stop) {
  if (is_mission_file(options.model)) {
    const fs::path file = options.model;
    const config::MissionSetup setup = config::read_mission(file, {}, report);
    const double distance = options.distance.value_or(setup.evaluation().registration_distance);
    const auto surroundings = [&](const geometry::Mesh& model) {
      return scene::make_surroundings(setup.scene(), geometry::bounding_box(model));
    };
    const std::optional<flight::Site> site =
        setup.flight().is_georeferenced ? std::optional(setup.flight().site) : std::nullopt;
    if (!wants_visible) {
      const geometry::Mesh model = evaluation::placed_model(setup.scene(), file.parent_path());
      return {model, surroundings(model), distance, setup.evaluation().samples, {}, site};
    }
    const evaluation::SurveyScene scene(setup.simulation, file.parent_path(), setup.run.threads);
    return {scene.model(),
            surroundings(scene.model()),
            distance,
            setup.evaluation().samples,
            scene.visible(setup.run.threads, stop),
            site};
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

/// Returns the results as JSON.
nlohmann::ordered_json evaluation_json(const EvaluateOptions& options, const Truth& truth,
                                       const evaluation::CloudEvaluation& evaluated) {
  const evaluation::CloudAccuracy& accuracy = evaluated.accuracy;
  const std::optional<double> visible = visible_share(evaluated, truth);
  const bool is_mesh = !options.mesh.empty();
  return {
      {is_mesh ? "mesh" : "cloud", (is_mesh ? options.mesh : options.cloud).string()},
      {"model", options.model},
      {"points", evaluated.points},
      {"points_beside", evaluated.surroundings},
      {"registration_distance_m", truth.registration_distance},
      {"samples", truth.samples},
      {"coverage", evaluated.coverage},
      {"coverage_visible", visible ? nlohmann::ordered_json(*visible) : nlohmann::ordered_json()},
      {"distance_to_model_m",
       {{"mean", accuracy.mean},
        {"root_mean_square", accuracy.root_mean_square},
        {"median", accuracy.median},
        {"percentile_95", accuracy.percentile_95},
        {"largest", accuracy.largest}}},
      {"area_m2", evaluated.area},
      {"points_per_m2", evaluated.density()}};
}

/// Prints the results in the format of options.is_json.
void print_evaluation(const EvaluateOptions& options, const Truth& truth,
                      const evaluation::CloudEvaluation& evaluated, std::ostream& out) {
  if (options.is_json) {
    out << support::json_text(evaluation_json(options, truth, evaluated));
    return;
  }
  const evaluation::CloudAccuracy& accuracy = evaluated.accuracy;
  const std::optional<double> visible = visible_share(evaluated, truth);
  const fs::path& file = options.mesh.empty() ? options.cloud : options.mesh;
  out << fmt::format(
      "{}: {} points against {}{}\n  coverage  {:.2f}% of the surface within {:g} m{}\n  accuracy  "
      "mean {:.4g} m, rms {:.4g} m, median {:.4g} m, 95% below {:.4g} m, maximum {:.4g} m\n  "
      "density   {:.4g} points per m^2 of the surface ({:.4g} m^2)\n",
      file.filename().string(), evaluated.points, options.model,
      truth.surroundings.triangles.empty()
          ? ""
          : fmt::format("; {} further points lie on the ground or on neighbouring buildings",
                        evaluated.surroundings),
      100.0 * evaluated.coverage, truth.registration_distance,
      visible ? fmt::format(", {:.2f}% of the visible surface", 100.0 * *visible) : "",
      accuracy.mean, accuracy.root_mean_square, accuracy.median, accuracy.percentile_95,
      accuracy.largest, evaluated.density(), evaluated.area);
}

constexpr const char* evaluation_name = "evaluation.json";

std::string checksum(const geometry::Mesh& mesh) {
  const auto compute_checksum = [](const auto& items) {
    return geometry::compute_crc32(
        {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(items[0])});
  };
  return fmt::format("{:08x} {:08x}", compute_checksum(mesh.vertices),
                     compute_checksum(mesh.triangles));
}

/// Evaluation of a cloud whose points are divided into pieces in file order.
class CloudShards final : public ShardedJob {
 public:
  CloudShards(const EvaluateOptions& options, const Console& console)
      : options_(options),
        console_(console),
        progress_(console, options.is_quiet),
        truth_(read_truth()),
        content_checksum_(checksum(truth_.model) + " beside " + checksum(truth_.surroundings)) {}

  bool process_shard(std::size_t number) override {
    geometry::OutputFolder folder(own_shard_folder(number));
    if (evaluation::has_tally(folder.path(), identity(number))) return true;
    evaluation::CloudEvaluator evaluator(truth_.model, truth_.samples, truth_.registration_distance,
                                         options_.threads, truth_.surroundings);
    double begin = 0.0;  // file position of the next points, as a fraction
    geometry::read_positions(
        options_.cloud, [&](std::span<const Eigen::Vector3f> points, double end) {
          const auto piece_index =
              static_cast<std::size_t>(begin * static_cast<double>(options_.shards));
          begin = end;
          const bool is_own = std::min(piece_index, options_.shards - 1) == number;
          if (!is_own || console_.stop.stop_requested()) return;
          progress_.show(
              fmt::format("{}: piece {}, {:.0f}%", options_.cloud.string(), number, 100.0 * end));
          evaluator.add(points);
        });
    if (console_.stop.stop_requested()) return false;
    evaluation::stage_tally(identity(number), evaluator.take_tally(), folder);
    folder.commit();
    return true;
  }

  bool load_shard(std::size_t number) override {
    if (!evaluation::has_tally(own_shard_folder(number), identity(number))) return false;
    all_.add(evaluation::read_tally(own_shard_folder(number), truth_.samples));
    return true;
  }

  int join(geometry::OutputFolder& folder) override {
    const evaluation::CloudEvaluation evaluated =
        evaluate_tally(all_, geometry::surface_area(truth_.model));
    nlohmann::ordered_json json = evaluation_json(options_, truth_, evaluated);
    json["complete"] = true;
    folder.write(evaluation_name, support::json_text(json));
    folder.commit();
    progress_.clear();
    if (!options_.is_quiet) print_evaluation(options_, truth_, evaluated, console_.out);
    return 0;
  }

 private:
  Truth read_truth() {
    progress_.show("loading " + options_.model);
    const bool wants_visible = !options_.task.index;  // only required for the whole cloud
    return make_truth(options_, wants_visible, progress_.progress_callback(), console_.stop);
  }

  fs::path own_shard_folder(std::size_t number) const {
    return shard_folder(*options_.out, number, options_.shards);
  }

  /// Returns a string that identifies the inputs of a piece.
  std::string identity(std::size_t number) const {
    const auto changed = fs::last_write_time(options_.cloud).time_since_epoch().count();
    return fmt::format("{} {} {} {} model {} distance {} samples {} piece {} of {}", version,
                       fs::absolute(options_.cloud).string(), fs::file_size(options_.cloud),
                       changed, content_checksum_, truth_.registration_distance, truth_.samples,
                       number, options_.shards);
  }

  const EvaluateOptions& options_;
  const Console& console_;
  ProgressLine progress_;
  Truth truth_;
  std::string content_checksum_;
  evaluation::CloudTally all_;
};

batch::Words make_command(const EvaluateOptions& options) {
  std::error_code missing;
  const bool is_file = fs::exists(options.model, missing);
  batch::Words words{"evaluate",
                     "--cloud",
                     fs::absolute(options.cloud),
                     "--model",
                     is_file ? fs::absolute(options.model).string() : options.model,
                     "--out",
                     fs::absolute(*options.out),
                     "--pieces",
                     std::to_string(options.shards),
                     "--samples",
                     std::to_string(options.samples)};
  if (options.distance) {
    words.insert(words.end(), {"--distance", fmt::format("{}", *options.distance)});
  }
  return words;
}

/// Evaluates a cloud in pieces according to the options. Returns the exit code.
int evaluate_shards(const EvaluateOptions& options, const Console& console) {
  if (!options.mesh.empty() || !options.out) {
    throw Error(ErrorKind::bad_usage, "--pieces requires --cloud and --out");
  }
  const batch::JobRequest job{.command = make_command(options),
                              .out = *options.out,
                              .title = "Evaluation of " + options.cloud.filename().string(),
                              .name = "evaluate",
                              .items = options.shards,
                              .jobs = geometry::thread_count(options.threads)};
  return run_shards(
      job, options.task, options.is_quiet, evaluation_name,
      [&] { return std::make_unique<CloudShards>(options, console); }, console);
}

/// Throws if the file to be evaluated does not exist. Loading the model can take much longer than
/// this check. Warns about the cloud of an interrupted scan, which contains part of the flight.
void check_input(const EvaluateOptions& options, const Console& console) {
  const fs::path& file = options.mesh.empty() ? options.cloud : options.mesh;
  if (!fs::exists(file)) {
    throw Error(ErrorKind::bad_file, file.string() + ": does not exist");
  }
  if (fs::is_directory(file.parent_path() / scan::ScanJournal::folder_name)) {
    warn(console, file.string() +
                      ": the scan was interrupted; the cloud contains only the first part of the "
                      "flight (continue it with skycap scan --resume)");
  }
}

}  // namespace

int evaluate(const EvaluateOptions& options, const Console& console) {
  if (!options.reference.empty()) return evaluate_change(options, console);
  if (!options.flight.empty()) return evaluate_flight_file(options, console);
  check_input(options, console);
  if (options.density && (options.shards > 0 || options.cloud.empty())) {
    throw Error(ErrorKind::bad_usage, "--density requires --cloud and conflicts with --pieces");
  }
  if (options.shards > 0) return evaluate_shards(options, console);
  if (options.task.is_set() || options.out) {
    throw Error(ErrorKind::bad_usage,
                "--out, --index, --chunk, --collect and --submit require --pieces");
  }
  ProgressLine progress(console, options.is_quiet);
  progress.show("loading " + options.model);
  const Truth truth = make_truth(options, true, progress.progress_callback(), console.stop);
  const bool is_mesh = !options.mesh.empty();
  progress.show("reading " + (is_mesh ? options.mesh : options.cloud).string());
  std::optional<Density> density;
  if (options.density) density.emplace(options, truth);
  const evaluation::CloudEvaluation evaluated =
      is_mesh ? evaluate_mesh(options, truth)
              : evaluate_cloud(options, truth, progress, console, density ? &*density : nullptr);
  progress.clear();
  print_evaluation(options, truth, evaluated, console.out);
  if (density) {
    const std::string text = density->write();
    if (!options.is_json) console.out << text;
  }
  return 0;
}

}  // namespace skycap::missions::cli
