// Benchmark of one step of a volumetric planner, "insert a cloud and score 130 candidates", on one
// thread. Skycap and the reference on OctoMap (tests/survey/octomap_planning.h) run alternately for
// each gain.
//
// volumetric_benchmark [object|building] [clouds before, 10] [candidates of the twin, 10]
//
// The reference scores only some of the candidates; its time is scaled to 130.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "geometry/pose/pose.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "sim/sensors/depth_camera.h"
#include "survey/volumetric/volumetric_planner.h"
#include "tests/benchmarks/processor_time.h"
#include "tests/survey/volumetric/octomap_planning.h"

namespace {

using namespace skycap;
using survey::volumetric::VolumetricMetric;

constexpr std::size_t candidates = 130;

double cpu_seconds() { return seconds_on(CLOCK_THREAD_CPUTIME_ID); }

template <typename Work>
double timed(Work work) {
  const double start = cpu_seconds();
  work();
  return cpu_seconds() - start;
}

struct Gain {
  const char* name;
  VolumetricMetric metric;
};

constexpr Gain gains[] = {
    {"RSV", VolumetricMetric::rear_side_voxel}, {"RSE", VolumetricMetric::rear_side_entropy},
    {"OA", VolumetricMetric::occlusion_aware},  {"UV", VolumetricMetric::unobserved_voxel},
    {"PC", VolumetricMetric::proximity_count},  {"AF", VolumetricMetric::area_factor},
    {"AE", VolumetricMetric::average_entropy}};

void run(const std::string& name, const std::string& mission_text, double resolution,
         std::size_t clouds, std::size_t reference_candidates) {
  const missions::config::MissionSetup mission =
      missions::config::parse_mission(mission_text, name);
  const missions::evaluation::SurveyScene scene(mission.simulation, std::filesystem::current_path(),
                                                mission.run.threads);
  const sim::DepthCamera camera(mission.sensor().camera);
  const auto [centre, radius] = scene.view_sphere();
  const auto views =
      survey::volumetric::sphere_views(clouds + 1 + candidates, centre, radius, std::nullopt, 1);
  const auto directions =
      survey::volumetric::ray_directions(geometry::Camera(mission.sensor().camera.camera), {});

  const double shadow = 18.0 * resolution;
  survey::volumetric::VolumetricMap map(resolution, shadow);
  tests::ShadowTree tree(resolution, shadow);
  double insert = 0.0, reference_insert = 0.0;
  std::size_t returns = 0;
  for (std::size_t i = 0; i <= clouds; ++i) {
    const geometry::Scan scan = camera.scan(scene.scene(), views[i], i, 1);
    const Eigen::Vector3f origin = scan.sensor_position().cast<float>();
    insert = timed([&] { map.insert(origin, scan.points); });
    if (reference_candidates > 0)
      reference_insert = timed([&] { tree.insert(origin, scan.points); });
    returns = scan.points.size();
  }
  std::printf("%s: %zu clouds, the last of %zu points; %zu candidates of %zu rays; map %.0f MiB\n",
              name.c_str(), clouds + 1, returns, candidates, directions.size(),
              static_cast<double>(map.memory()) / (1 << 20));
  std::printf("  insert one cloud %8.3f s", insert);
  if (reference_candidates > 0)
    std::printf(", OctoMap %8.3f s, %.1f times", reference_insert, reference_insert / insert);
  std::printf("\n  gain      ours [s]  OctoMap [s]   times  largest relative difference\n");
  for (const Gain& gain : gains) {
    double sum = 0.0, difference = 0.0;
    const double ours = timed([&] {
      for (std::size_t i = 0; i < candidates; ++i) {
        sum += information_gain(gain.metric, map, views[clouds + 1 + i], directions, radius);
      }
    });
    double theirs = 0.0;
    for (std::size_t i = 0; i < reference_candidates; ++i) {
      const geometry::View& view = views[clouds + 1 + i];
      double reference = 0.0;
      theirs += timed([&] { reference = tree.gain(gain.metric, view, directions, radius, true); });
      const double own = information_gain(gain.metric, map, view, directions, radius);
      reference = tree.gain(gain.metric, view, directions, radius, false);
      if (reference != 0.0)
        difference = std::max(difference, std::abs(own - reference) / std::abs(reference));
    }
    std::printf("  %-4s %10.3f", gain.name, insert + ours);
    if (reference_candidates > 0) {
      const double all =
          reference_insert + theirs * candidates / static_cast<double>(reference_candidates);
      std::printf(" %12.2f %7.1f  %.1e", all, all / (insert + ours), difference);
    }
    std::printf("   (sum %.6g)\n", sum);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string which = argc > 1 ? argv[1] : "object";
  const auto number = [&](int argument, std::size_t fallback) {
    return argc > argument ? static_cast<std::size_t>(std::atol(argv[argument])) : fallback;
  };
  const std::string common =
      "evaluation: {coverage_distance: 0.05, samples: 20000, attainable_views: 0}\n";
  if (which == "building") {
    run(which,
        common +
            "scene: {model: 'builtin:radcliffe-camera', longest_side: 40.0}\n"
            "sensor: {preset: high_resolution}\n"
            "planner: {density: 213, resolution_radius: 0.15}\n",
        0.15, number(2, 10), number(3, 10));
  } else {
    run(which, common + "scene: {model: 'builtin:teapot', longest_side: 1.0}\n", 0.017,
        number(2, 10), number(3, 10));
  }
}
