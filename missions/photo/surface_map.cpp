#include "missions/photo/surface_map.h"

#include <algorithm>
#include <cmath>

#include "flight/export/text.h"
#include "geometry/angle.h"
#include "geometry/parallel.h"
#include "geometry/surfaces/sight_lines.h"
#include "missions/config/mission_document.h"
#include "missions/config/photo_rules.h"
#include "survey/photo/stereo_quality.h"
#include "survey/photo/target_samples.h"
#include "survey/photo/visibility.h"

namespace skycap::missions::photo {
namespace {

using survey::photo::Observation;
using survey::photo::StereoPairs;

constexpr std::size_t map_samples = 8000;

/// The planner's samples have the seeds 2 n and 2 n + 1.
constexpr std::uint64_t seed_of_map = 0x6d61707365656473;

/// Returns the observations of a sample. Photos at the same position count once.
std::vector<Observation> list_observations(std::span<const std::uint32_t> photos,
                                           const std::vector<geometry::View>& views,
                                           const survey::photo::Observer& observer,
                                           std::size_t sample) {
  std::vector<Observation> kept;
  for (const std::uint32_t photo : photos) {
    const Eigen::Vector3d& position = views[photo].position;
    const bool is_same = std::ranges::any_of(kept, [&](const Observation& other) {
      return (views[other.photo].position - position).norm() < observer.rule().same_position();
    });
    if (is_same) continue;
    kept.push_back(make_observation(position, photo, observer.samples(), sample));
  }
  return kept;
}

void add_figures(const std::vector<Observation>& observations, const StereoPairs& pairs,
                 const geometry::PhotoCamera& camera, SurfaceSample& sample) {
  sample.observations = static_cast<std::uint32_t>(observations.size());
  sample.partners = stereo_partners(observations, pairs);
  const double h = reconstructability(observations, pairs);
  if (sample.partners >= 3 || h >= 1.0) {
    sample.quality = SurfaceClass::good;
  } else if (sample.partners == 2 || h >= 0.2) {
    sample.quality = SurfaceClass::weak;
  }
  double max_cosine = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const double gsd = camera.gsd(observations[i].distance);
    sample.gsd = i == 0 ? gsd : std::min(sample.gsd, gsd);
    max_cosine = std::max(max_cosine, static_cast<double>(observations[i].cosine));
    for (std::size_t j = 0; j < i; ++j) {
      if (!pairs.are_partners(observations[i], observations[j])) continue;
      const double cosine = std::min(1.0F, observations[i].ray.dot(observations[j].ray));
      sample.parallax = std::max(sample.parallax, std::acos(cosine));
    }
  }
  if (!observations.empty()) sample.incidence = std::acos(std::min(1.0, max_cosine));
}

}  // namespace

const char* to_string(SurfaceClass value) {
  switch (value) {
    case SurfaceClass::good:
      return "good";
    case SurfaceClass::weak:
      return "weak";
    case SurfaceClass::missing:
      break;
  }
  return "missing";
}

std::vector<SurfaceSample> evaluate_surface(const config::MissionSetup& setup,
                                            const PhotoAirspace& airspace,
                                            const survey::photo::PhotoPlan& plan) {
  const survey::photo::PhotoSite site = photo_site(setup, airspace);
  const geometry::PhotoCamera camera(plan.camera);
  survey::photo::StereoRule rule = config::photo_setup(*setup.document).options.rule;
  rule.view_distance = plan.view_distance;
  rule.nearest_focus = plan.camera.nearest_focus;
  const unsigned threads = setup.run.threads;
  geometry::Mesh obstructions = site.target;
  append(obstructions, site.surroundings);
  const geometry::SightLines sights(obstructions, threads);
  const survey::photo::TargetSamples targets =
      survey::photo::sample_target(site.target, sights,
                                   {.count = map_samples,
                                    .seed = setup.run.seed + seed_of_map,
                                    .free_length = 1.5 * rule.view_distance,
                                    .min_standoff = site.space.min_standoff,
                                    .ground = site.ground,
                                    .threads = threads});
  std::vector<geometry::View> views;
  for (const survey::photo::PlannedPhoto& photo : plan.photos) views.push_back(photo.view);
  const survey::photo::Observer observer(camera, rule, sights, targets);
  const survey::photo::IndexLists photos =
      transposed(observed_samples(observer, views, threads), targets.size());
  const StereoPairs pairs(rule);
  std::vector<SurfaceSample> samples(targets.size());
  geometry::parallel_for_each(samples.size(), threads, [&](std::size_t i) {
    samples[i].position = targets.points[i];
    add_figures(list_observations(photos[i], views, observer, i), pairs, camera, samples[i]);
  });
  return samples;
}

std::string surface_table(const std::vector<SurfaceSample>& samples) {
  using flight::fixed;
  constexpr double degrees = geometry::degrees_per_radian;
  std::string text = "x,y,z,class,partners,observations,gsd_m,parallax_deg,incidence_deg\n";
  for (const SurfaceSample& sample : samples) {
    for (const float value : sample.position) text += fixed(value, 3) + ",";
    text += std::string(to_string(sample.quality)) + "," + std::to_string(sample.partners) + "," +
            std::to_string(sample.observations) + ",";
    if (sample.observations > 0) text += fixed(sample.gsd, 5);
    text += ",";
    if (sample.parallax > 0.0) text += fixed(sample.parallax * degrees, 1);
    text += ",";
    if (sample.observations > 0) text += fixed(sample.incidence * degrees, 1);
    text += "\n";
  }
  return text;
}

}  // namespace skycap::missions::photo
