/// Reconstructed fraction of a building: compares a plan of photos with flight patterns. The
/// fraction is measured with simulated photos and the multi-view matcher of sim/photos, and
/// compared with the predicted one.
///
///   photo_benchmark [--model FILE.obj | --scene courtyard] [--distance M, 6] [--partners K, 3]
///                   [--samples N, 3000] [--width PX, 400] [--rounds N, 900] [--threads N, 0]
///                   [--contrast C, 1] [--unknown-poses] [--no-patterns] [--photos FOLDER]
///
/// FILE.obj has its y axis up. Without a model or scene, the target is a hut of 6 x 4 x 3 m.
/// --samples is the number of samples for the measurement, which are independent of the planner's
/// samples. --photos writes the plan's photos (PNG) to FOLDER/images and the input of COLMAP to
/// FOLDER/colmap, for tests/checks/colmap.
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "flight/route/route.h"
#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh_distance.h"
#include "geometry/surfaces/sight_lines.h"
#include "missions/photo/colmap_model.h"
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
  double distance = 6.0, contrast = 1.0;
  int partners = 3, width = 400;
  std::size_t samples = 3000, rounds = 900;
  unsigned threads = 0;
  PosesGiven poses = PosesGiven::known;
  bool has_patterns = true;
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
    if (i + 1 == argc) {
      std::fprintf(stderr, "%s requires a value\n", argv[i]);
      std::exit(2);
    }
    const char* value = argv[++i];
    if (name == "--model") options.model = value;
    if (name == "--scene") options.scene = value;
    if (name == "--photos") options.photos = value;
    if (name == "--distance") options.distance = std::atof(value);
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
    std::printf("view distance %.2f m, GSD %.1f mm, planned in %.1f s\n", result.view_distance,
                1e3 * plan.gsd, time.count());
    std::printf("%-8s %7s %24s %24s\n", "", "", "expected completeness", "measured completeness");
    std::printf("%-8s %7s %12s %11s %12s %11s\n", "plan", "photos", "1 depth", "3 depths",
                "1 depth", "3 depths");
    sample();
    const auto images = photograph(result.views);
    show("plan", result.views, images, result.figures);
    for (const PatternResult& pattern : result.patterns) {
      show(to_string(pattern.pattern), pattern.views, photograph(pattern.views), pattern.figures);
    }
    if (!options_.photos.empty()) write(result, images);
  }

 private:
  static geometry::Mesh find_target(const Options& options) {
    if (!options.model.empty()) return model(options.model);
    if (options.scene == "courtyard") return courtyard();
    geometry::Mesh hut;
    add_box(hut, {-3, -2, 0}, {3, 2, 3});
    return hut;
  }

  /// Samples of exposed surface, with another seed than the planner's.
  void sample() {
    const TargetSamples samples =
        sample_target(target_, sight_lines_,
                      {.count = options_.samples,
                       .seed = measuring_seed,
                       .free_length = 1.5 * options_.distance,
                       .min_standoff = min_standoff,
                       .ground = [](const Eigen::Vector2d&) { return 0.0; },
                       .threads = options_.threads});
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples_.push_back({samples.points[i].cast<double>(), samples.normals[i].cast<double>()});
    }
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

  void show(const char* name, const std::vector<geometry::View>& views,
            const std::vector<sim::GreyImage>& images, const PhotoFigures& figures) const {
    sim::MatchOptions matching;
    matching.threads = options_.threads;
    const auto right = sim::right_depths(
        samples_, images, views, camera_,
        [&](const geometry::View& view, const sim::MatchSample& sample) {
          return sight_lines_.is_clear(view.position, sample.point, 0.999);
        },
        matching);
    std::printf("%-8s %7zu %11.1f%% %10.1f%% %11.1f%% %10.1f%%\n", name, views.size(),
                100.0 * figures.completeness, 100.0 * figures.threefold,
                100.0 * sim::completeness(right, 1), 100.0 * sim::completeness(right, 3));
  }

  void write(const PhotoPlanResult& result, const std::vector<sim::GreyImage>& images) const {
    PhotoPlan plan;
    plan.camera = camera_.config();
    plan.gsd = camera_.gsd(options_.distance);
    plan.view_distance = result.view_distance;
    const std::filesystem::path folder = options_.photos;
    std::filesystem::create_directories(folder / "images");
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
    missions::photo::write_colmap(plan, pairs_of(result), {}, folder / "colmap", ".png");
    std::printf("%zu photos are in %s\n", images.size(), folder.c_str());
  }

  /// Returns the pairs of photos that share samples of the measurement.
  std::vector<PhotoPair> pairs_of(const PhotoPlanResult& result) const {
    const TargetSamples samples =
        sample_target(target_, sight_lines_,
                      {.count = options_.samples,
                       .seed = measuring_seed,
                       .free_length = 1.5 * options_.distance,
                       .min_standoff = min_standoff,
                       .ground = [](const Eigen::Vector2d&) { return 0.0; },
                       .threads = options_.threads});
    StereoRule rule;
    rule.view_distance = result.view_distance;
    const Observer observer(camera_, rule, sight_lines_, samples);
    IndexLists observed;
    for (const geometry::View& view : result.views) {
      for (const std::uint32_t i : observer.observed(view)) observed.items.push_back(i);
      observed.begin.push_back(static_cast<std::uint32_t>(observed.items.size()));
    }
    return shared_pairs(result.views, observed, samples, missions::photo::min_shared_to_match,
                        options_.threads);
  }

  Options options_;
  geometry::PhotoCamera camera_;
  geometry::Mesh target_;
  sim::Scene scene_;
  geometry::SightLines sight_lines_;
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
