/// Reconstructed fraction of a building: compares a plan of photos with flight patterns. The
/// fraction is predicted on samples that no planner used, and measured there with simulated photos
/// and the multi-view matcher of sim/photos.
///
///   photo_benchmark [--model FILE.obj | --scene NAME] [--size M] [--distance M, 6]
///                   [--partners K, 3] [--samples N, 3000] [--width PX, 400] [--rounds N, 900]
///                   [--threads N, 0] [--contrast C, 1] [--unknown-poses] [--no-patterns]
///                   [--no-photos] [--photos FOLDER]
///
/// FILE.obj has its y axis up. NAME is hut (a box of 6 x 4 x 3 m, the default), courtyard, or a
/// model of sim/models/models.h, such as radcliffe-camera, with few triangles. --size scales the
/// target to this largest dimension. --no-photos skips the measurement with the matcher.
/// --photos writes the plan's photos (PNG) to FOLDER/images and the input of COLMAP to
/// FOLDER/colmap, for tests/checks/colmap.
///
/// Minutes are those of a closed tour with a stop of 2 s at each photo, without take-off and
/// landing, with the default vehicle of flight/motion.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <sys/resource.h>

#include "flight/motion/motion.h"
#include "flight/route/route.h"
#include "flight/route/tour.h"
#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh_distance.h"
#include "geometry/surfaces/sight_lines.h"
#include "missions/photo/colmap_model.h"
#include "sim/models/models.h"
#include "sim/photos/photo_matcher.h"
#include "sim/photos/simulated_photo.h"
#include "survey/photo/photo_planner.h"

namespace {

using namespace skycap;
using namespace skycap::survey::photo;
using Eigen::Vector3d;

constexpr double min_standoff = 3.0, min_height = 2.0;  // [m]
constexpr std::uint64_t seed = 1, measuring_seed = 77;

void add_box(geometry::Mesh& mesh, const Vector3d& low, const Vector3d& high) {
  constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                               i & 4 ? high.z() : low.z());
  }
  for (const auto& [a, b, c, d] : sides) {
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.triangles.push_back({first + a, first + c, first + d});
  }
}

geometry::Mesh courtyard() {
  geometry::Mesh mesh;
  add_box(mesh, {-8, -8, 0}, {-3.5, 8, 8});
  add_box(mesh, {3.5, -8, 0}, {8, 8, 8});
  add_box(mesh, {-3.5, -8, 0}, {3.5, -3.5, 8});
  add_box(mesh, {-3.5, 4, 0}, {3.5, 8, 5});
  add_box(mesh, {8, -2, 3.2}, {10.5, 2, 3.5});
  add_box(mesh, {-5, -5.5, 8}, {-4, -4.5, 9.5});
  return mesh;
}

/// Returns the mesh with z up, centred above the origin, with its base at 0.
geometry::Mesh model(const std::string& file) {
  geometry::Mesh mesh = geometry::read_mesh(file);
  for (Vector3d& vertex : mesh.vertices) vertex = {vertex.x(), -vertex.z(), vertex.y()};
  const Eigen::AlignedBox3d box = geometry::bounding_box(mesh);
  const Vector3d shift(-box.center().x(), -box.center().y(), -box.min().z());
  for (Vector3d& vertex : mesh.vertices) vertex += shift;
  return mesh;
}

/// Returns the camera of a Mavic 3E with this image width.
geometry::PhotoCameraConfig make_camera(int width) {
  geometry::PhotoCameraConfig camera;
  camera.name = "mavic_3e_wide";
  camera.focal_length = 0.01229;
  camera.sensor_size = {0.0173, 0.01297};
  camera.width = width;
  camera.height = width * 3 / 4;
  return camera;
}

struct Options {
  std::string model, scene = "hut", photos;
  double distance = 6.0, contrast = 1.0, size = 0.0;
  int partners = 3, width = 400;
  std::size_t samples = 3000, rounds = 900;
  unsigned threads = 0;
  PosesGiven poses = PosesGiven::known;
  bool has_patterns = true;
  bool has_photos = true;
};

Options make_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name == "--unknown-poses") {
      options.poses = PosesGiven::unknown;
      continue;
    }
    if (name == "--no-patterns") {
      options.has_patterns = false;
      continue;
    }
    if (name == "--no-photos") {
      options.has_photos = false;
      continue;
    }
    if (i + 1 == argc) {
      std::fprintf(stderr, "%s requires a value\n", argv[i]);
      std::exit(2);
    }
    const char* value = argv[++i];
    if (name == "--model") options.model = value;
    if (name == "--scene") options.scene = value;
    if (name == "--photos") options.photos = value;
    if (name == "--distance") options.distance = std::atof(value);
    if (name == "--size") options.size = std::atof(value);
    if (name == "--contrast") options.contrast = std::atof(value);
    if (name == "--partners") options.partners = std::atoi(value);
    if (name == "--width") options.width = std::atoi(value);
    if (name == "--samples") options.samples = std::strtoul(value, nullptr, 10);
    if (name == "--rounds") options.rounds = std::strtoul(value, nullptr, 10);
    if (name == "--threads") options.threads = static_cast<unsigned>(std::atoi(value));
  }
  return options;
}

class Bench {
 public:
  explicit Bench(const Options& options)
      : options_(options),
        camera_(make_camera(options.width)),
        target_(find_target(options)),
        scene_(target_, options.threads),
        sight_lines_(target_, options.threads) {}

  void run() {
    const geometry::MeshDistance distance(target_, options_.threads);
    PhotoSite site{.target = target_, .surroundings = {}, .ground = {}, .space = {}};
    site.ground = [](const Eigen::Vector2d&) { return 0.0; };
    site.min_height = min_height;
    site.space.min_standoff = min_standoff;
    site.space.limits.min_height = min_height;
    site.space.is_free = [&](const Vector3d& position) {
      return distance.distance(position) >= min_standoff - 1e-6;
    };
    PhotoPlanOptions plan;
    plan.camera = camera_.config();
    plan.gsd = camera_.gsd(options_.distance);
    plan.rule.min_partners = options_.partners;
    plan.poses = options_.poses;
    plan.patterns.clear();
    if (options_.has_patterns) plan.patterns = {Pattern::dome, Pattern::facade};
    plan.repair_rounds = options_.rounds;
    const auto start = std::chrono::steady_clock::now();
    const PhotoPlanResult result =
        plan_photos(plan, site, {.seed = seed, .threads = options_.threads});
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    show_run(result, plan.gsd, time.count());
    sample();
    show("plan", result.views);
    for (const PatternResult& pattern : result.patterns) {
      show(to_string(pattern.pattern), pattern.views);
    }
    if (!options_.photos.empty()) write(result);
  }

 private:
  static geometry::Mesh find_target(const Options& options) {
    geometry::Mesh target = unscaled_target(options);
    if (options.size > 0.0) {
      const double scale = options.size / geometry::bounding_box(target).sizes().maxCoeff();
      for (Vector3d& vertex : target.vertices) vertex *= scale;
    }
    return target;
  }

  static geometry::Mesh unscaled_target(const Options& options) {
    if (!options.model.empty()) return model(options.model);
    if (options.scene == "courtyard") return courtyard();
    if (options.scene != "hut") {
      sim::ModelOptions coarse;
      coarse.detail = sim::LevelOfDetail::coarse;
      coarse.has_ground = false;
      return sim::builtin_model(options.scene, coarse);
    }
    geometry::Mesh hut;
    add_box(hut, {-3, -2, 0}, {3, 2, 3});
    return hut;
  }

  void show_run(const PhotoPlanResult& result, double gsd, double seconds) const {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const PhotoFigures& figures = result.figures;
    std::printf("view distance %.2f m, GSD %.1f mm, %zu candidates, planned in %.1f s, %.0f MiB\n",
                result.view_distance, 1e3 * gsd, result.candidates, seconds,
                static_cast<double>(usage.ru_maxrss) / 1024.0);
    std::printf("photos: greedy %zu, searched %zu, bound %.1f (gap %.1f%%), connecting %zu\n",
                result.greedy_photos, result.repaired_photos, result.bound.relaxed,
                100.0 * static_cast<double>(result.repaired_photos) /
                        static_cast<double>(std::max<std::size_t>(result.bound.photos, 1)) -
                    100.0,
                result.connecting);
    std::printf("satisfied %.1f%% of the attainable surface, attainable %.1f%%\n",
                100.0 * figures.attainable_share(figures.satisfied),
                100.0 * figures.share(figures.attainable));
    std::printf("%-8s %7s %7s %7s %9s %17s %17s\n", "", "", "", "", "", "expected", "measured");
    std::printf("%-8s %7s %7s %7s %9s %8s %8s %8s %8s\n", "plan", "photos", "tour m", "minutes",
                "satisfied", "1 depth", "3 depths", "1 depth", "3 depths");
  }

  /// Samples the exposed surface with a different seed from the planner's.
  void sample() {
    fresh_ = sample_target(target_, sight_lines_,
                           {.count = options_.samples,
                            .seed = measuring_seed,
                            .free_length = 1.5 * options_.distance,
                            .min_standoff = min_standoff,
                            .ground = [](const Eigen::Vector2d&) { return 0.0; },
                            .threads = options_.threads});
    for (std::size_t i = 0; i < fresh_.size(); ++i) {
      samples_.push_back({fresh_.points[i].cast<double>(), fresh_.normals[i].cast<double>()});
    }
    rule_.view_distance = options_.distance;
    rule_.nearest_focus = camera_.config().nearest_focus;
    rule_.min_partners = options_.partners;
  }

  std::vector<sim::GreyImage> photograph(const std::vector<geometry::View>& views) const {
    std::vector<sim::GreyImage> images;
    for (std::size_t i = 0; i < views.size(); ++i) {
      images.push_back(sim::simulate_photo(scene_, camera_, views[i],
                                           {.gsd = camera_.gsd(options_.distance),
                                            .contrast = options_.contrast,
                                            .ground = 0.0,
                                            .seed = i + 1,
                                            .threads = options_.threads}));
    }
    return images;
  }

  void show(const char* name, const std::vector<geometry::View>& views) const {
    const Observer observer(camera_, rule_, sight_lines_, fresh_);
    const PhotoChoiceProblem problem =
        photo_choice_problem(views, observer, true, options_.threads);
    PhotoChoice all(problem);
    for (std::uint32_t i = 0; i < views.size(); ++i) all.add(i);
    double once = 0.0, threefold = 0.0;
    for (std::size_t s = 0; s < fresh_.size(); ++s) {
      once += expected_completeness(all.partners(s));
      threefold += expected_threefold(all.partners(s));
    }
    const double percent = 100.0 / static_cast<double>(fresh_.size());
    const auto [length, minutes] = tour(views);
    std::printf("%-8s %7zu %7.0f %7.1f %8.1f%% %7.1f%% %7.1f%%", name, views.size(), length,
                minutes, percent * static_cast<double>(all.satisfied()), percent * once,
                percent * threefold);
    if (options_.has_photos) {
      const auto right = right_depths(views);
      std::printf(" %7.1f%% %7.1f%%", 100.0 * sim::completeness(right, 1),
                  100.0 * sim::completeness(right, 3));
    }
    std::printf("\n");
    std::fflush(stdout);
  }

  std::vector<std::uint8_t> right_depths(const std::vector<geometry::View>& views) const {
    sim::MatchOptions matching;
    matching.threads = options_.threads;
    return sim::right_depths(
        samples_, photograph(views), views, camera_,
        [&](const geometry::View& view, const sim::MatchSample& sample) {
          return sight_lines_.is_clear(view.position, sample.point, 0.999);
        },
        matching);
  }

  struct TourFigures {
    double length = 0.0;   ///< [m]
    double minutes = 0.0;  ///< [min]
  };
  /// Computes a closed tour through the photos.
  static TourFigures tour(const std::vector<geometry::View>& views) {
    if (views.size() < 2) return {};
    const flight::Tour found = flight::plan_tour(
        static_cast<std::uint32_t>(views.size()),
        [&](auto a, auto b) { return (views[a].position - views[b].position).norm(); });
    const flight::Motion motion(flight::Vehicle{}, flight::Conditions{});
    constexpr double stop = 2.0;  // [s]
    double seconds = 0.0;
    std::uint32_t last = 0;
    std::vector<std::uint32_t> order = found.order;
    order.push_back(0);
    for (const std::uint32_t next : order) {
      const double yaw =
          std::remainder(flight::compute_yaw(views[next]) - flight::compute_yaw(views[last]),
                         2.0 * std::numbers::pi);
      const double pitch = flight::compute_pitch(views[next]) - flight::compute_pitch(views[last]);
      const double leg = motion.leg_time(views[next].position - views[last].position);
      seconds += motion.aimed_time(leg, yaw, pitch) + stop;
      last = next;
    }
    return {found.cost, seconds / 60.0};
  }

  void write(const PhotoPlanResult& result) const {
    PhotoPlan plan;
    plan.camera = camera_.config();
    plan.gsd = camera_.gsd(options_.distance);
    plan.view_distance = result.view_distance;
    const std::filesystem::path folder = options_.photos;
    std::filesystem::create_directories(folder / "images");
    const auto images = photograph(result.views);
    for (std::size_t i = 0; i < result.views.size(); ++i) {
      char name[32];
      std::snprintf(name, sizeof name, "photo_%04zu", i + 1);
      PlannedPhoto photo;
      photo.name = name;
      photo.view = result.views[i];
      photo.yaw = flight::compute_yaw(photo.view);
      photo.pitch = flight::compute_pitch(photo.view);
      plan.photos.push_back(photo);
      sim::write_png(images[i], folder / "images" / missions::photo::image_name(photo, ".png"));
    }
    missions::photo::write_colmap(plan, result.matching_pairs, {}, folder / "colmap", ".png");
    std::printf("%zu photos are in %s\n", images.size(), folder.c_str());
  }

  Options options_;
  geometry::PhotoCamera camera_;
  geometry::Mesh target_;
  sim::Scene scene_;
  geometry::SightLines sight_lines_;
  StereoRule rule_;
  TargetSamples fresh_;  ///< Samples that no planner used.
  std::vector<sim::MatchSample> samples_;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    Bench(make_options(argc, argv)).run();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "photo_benchmark: %s\n", error.what());
    return 1;
  }
}
