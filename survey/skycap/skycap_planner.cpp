#include "survey/skycap/skycap_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/error.h"
#include "survey/skycap/block_image.h"
#include "survey/skycap/chooser.h"
#include "survey/skycap/dose_map.h"
#include "survey/skycap/dose_model.h"
#include "survey/skycap/noise_estimate.h"
#include "survey/skycap/space_memory.h"
#include "survey/skycap/spaced_cloud.h"
#include "survey/skycap/unseen_surface.h"
#include "survey/skycap/view_gain.h"
#include "survey/stopwatch.h"

namespace skycap::survey::skycap {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::ScanSpan;
using geometry::View;

/// The survey ends after this number of consecutive scans that each add less than this fraction of
/// the area.
constexpr double idle_gain = 0.003;
constexpr int most_idle_scans = 8;
/// Fractions refer to the known area, but at most to this multiple of the maximum area that one
/// scan covered. Objects need about as many scans. For a larger scene, the same absolute gains are
/// then relevant as for an object.
constexpr double scans_of_an_object = 7.0;
/// Length of unknown space, as a fraction of d, with a line-of-sight confidence of 37%.
constexpr double clearness_scale = 0.15;
/// A depth discontinuity is at least six standard deviations, which noise rarely reaches within a
/// block. While the noise is unknown, it is a fraction of the scene.
constexpr double unknown_noise_jump = 0.05, noise_jump = 6.0;
/// Noise below the first fraction of r_d is treated as zero. A relative change of the estimate
/// below the second value does not justify recomputing the coverage model.
constexpr double negligible_noise = 0.12, noise_change = 0.03;

/// Returns the distance between neighbouring rays on a wall at distance 1, along the coarser image
/// axis.
double ray_spacing(const geometry::Camera& camera) {
  return 1.0 / camera.focal_length_px().minCoeff();
}

}  // namespace

struct SkycapPlanner::Impl {
  Impl(const SkycapConfig& given, const geometry::Camera& sensor)
      : config(given),
        camera(sensor),
        distance(given.view_distance.value_or(0.5 * given.coverage_radius / ray_spacing(camera))),
        clearness(static_cast<float>(clearness_scale * distance)),
        kept(given.spacing.value_or(0.5 * given.coverage_radius), distance * ray_spacing(camera)) {
    gain.view_distance = distance;
    gain.max_incidence = std::min(gain.max_incidence, static_cast<float>(given.max_incidence));
    chooser.view_distance = distance;
    chooser.view_price = given.view_price.value_or(3.0 * distance);
    chooser.threads = given.threads;
    chooser.frame_spacing = given.frame_spacing;
    chooser.counts_ways = given.counts_ways;
    chooser.sees_lines = given.sees_lines;
    if (!given.ideas.targeted_views) chooser.clusters = 0;
    if (!given.ideas.refinement) chooser.refinements = 0;
    if (!given.ideas.batch) chooser.batch = 1;
    if (given.scene_box) region = given.scene_box->cast<float>();
  }

  /// Sets the resolution from the first scan that contains a point.
  void start() {
    Eigen::AlignedBox3f seen;
    for (const Vector3f& point : kept.cloud().positions) seen.extend(point);
    const double extent =
        config.scene_box ? config.scene_box->sizes().maxCoeff() : seen.sizes().maxCoeff();
    const auto [h, block_px, jump] =
        scale_of(extent, distance * ray_spacing(camera), config.resolution);
    blocks.block_px = block_px;
    blocks.threads = config.threads;
    least_jump = jump;
    blocks.jump = static_cast<float>(std::max(least_jump, unknown_noise_jump * extent));
    map.emplace(static_cast<float>(h), config.threads);
    space.emplace(static_cast<float>(0.6 * h), config.misses_are_empty);
    dose.emplace(config.coverage_radius, with_pose_errors({}), ray_spacing(camera));
    unseen.emplace(
        UnseenSurfaceSettings{.steps = config.ideas.unseen_surface ? config.continuation_steps : 0,
                              .learns_rates = config.ideas.learned_rates,
                              .threads = config.threads});
    if (config.prior) unseen->expect({*config.prior, static_cast<float>(h)});
  }

  /// Adds the configured pose errors, which cannot be estimated from scans.
  Noise with_pose_errors(Noise learnt) const {
    learnt.place = config.place_error;
    learnt.angle = config.angle_error;
    return learnt;
  }

  void learn_noise(const std::vector<BlockImage>& images) {
    for (const BlockImage& image : images) noise.add(image);
    if (!config.ideas.dose) return;
    const auto estimate = noise.noise(negligible_noise * config.coverage_radius, distance);
    if (!estimate) return;
    if (!dose->noise().is_like(*estimate, noise_change)) {
      dose.emplace(config.coverage_radius, with_pose_errors(*estimate), ray_spacing(camera));
    }
    blocks.jump = static_cast<float>(std::max(least_jump, noise_jump * dose->noise().across(1.0)));
  }

  void take_in(const ScanSpan& scan) {
    // En-route scans have already shown a part of the predicted gain. For lines, the prediction
    // refers to paths.
    if (is_field_old && !config.sees_lines) predict();
    const std::vector<BlockImage> images = make_block_images(scan, camera, blocks);
    learn_noise(images);
    const View view = geometry::view_of(scan.world_from_sensor);
    Promise promised;
    if (!config.sees_lines && field) {
      promised = promise_of(*field, *map, field->sights(view));
    } else if (proposed && (proposed->position - view.position).norm() < 0.1 * distance) {
      promised = std::exchange(promise, {});
    }
    const std::size_t first_new = promised.surfels();
    const double here = add(images), with_way = here + std::exchange(covered_on_way, 0.0);
    const double newly_covered = config.sees_lines ? with_way : here;
    most_covered_at_once = std::max(most_covered_at_once, config.counts_ways ? with_way : here);
    if (field) {
      grade(promised, *field, *map, *unseen, *space);
    } else {
      unseen->grade({}, *map, *space, 0);
    }
    yield.learn(promised.guessed, newly_covered - promised.seen, map->new_territory(first_new));
    idle_scans = with_way < idle_gain * reference_area() ? idle_scans + 1 : 0;
  }

  /// Adds a scan to the model and returns the newly covered area [m^2].
  double add(const std::vector<BlockImage>& images) {
    const double covered_before = map->covered_area();
    const auto noise_along = static_cast<float>(dose->noise().across(1.0));
    // Noise may have displaced a point to this position without measuring it.
    const double reach = config.coverage_radius - 2.0 * dose->noise().across(1.0);
    const IsMeasured was_measured = [&](const Vector3f& place) {
      return reach > 0.0 && kept.has_near(place, reach, points_before);
    };
    for (const BlockImage& image : images) {
      if (config.ideas.free_space) space->add(image, noise_along);
      map->add(image, *dose, blocks.jump, region, was_measured);
    }
    space->compare_misses(map->surfels().positions, map->surfels().normals);
    return map->covered_area() - covered_before;
  }

  /// Predicts how the surface continues and updates all targets.
  void predict() {
    is_field_old = false;
    unseen->predict(*map, *space, region);
    clearness.update(unseen->patches(), *space, config.threads);
    field.emplace(*map, unseen->patches(), camera, *dose, gain, unseen->prior_occluders(),
                  &clearness);
    asked = {};
  }

  /// Returns the box in which unknown space may contain obstacles.
  Eigen::AlignedBox3d obstacle_box() const {
    if (config.scene_box) return *config.scene_box;
    Eigen::AlignedBox3f box;
    for (const Vector3f& p : map->surfels().positions) box.extend(p);
    return box.cast<double>();
  }

  bool is_free(const View& view, const Eigen::AlignedBox3d& kept_clear_of) const {
    if (!kept_clear_of.contains(view.position)) return true;
    const Vector3f at = view.position.cast<float>();
    const auto radius =
        static_cast<float>(std::max<double>(config.limits.stand_off, map->spacing()));
    return space->is_proven_empty(at, radius) && !map->has_surfel_near(at, radius);
  }

  Admission admission() const {
    const Vector3d stand_off = Vector3d::Constant(config.limits.stand_off);
    const Eigen::AlignedBox3d seen = obstacle_box(),
                              box(seen.min() - stand_off, seen.max() + stand_off);
    return [this, box](const View& view) {
      const bool is_refused = std::any_of(refused.begin(), refused.end(), [&](const View& other) {
        return (view.position - other.position).norm() < 0.1 * distance;
      });
      return !is_refused && is_free(view, box) && (!may_be_at || may_be_at(view.position));
    };
  }

  /// Returns the maximum distance of the next view for the limits of length and time [m].
  double most_way() const {
    double way = std::numeric_limits<double>::infinity();
    if (config.stop.most_length) way = std::min(way, *config.stop.most_length - length);
    if (config.stop.most_time) {
      const double left = *config.stop.most_time - length / config.stop.speed -
                          static_cast<double>(scans + 1) * config.stop.time_per_view;
      way = std::min(way, left * config.stop.speed);
    }
    return way;
  }

  std::optional<View> choose() {
    const double way = most_way();
    chooser.unseen_yield = yield.value();
    const auto choice =
        choose_view(*field, config.limits, admission(), present, way, chooser, asked);
    chances = choice ? choice->chances : std::vector<float>(field->targets().size(), 0.0F);
    next_gain = choice && map->area() > 0.0 ? choice->best_gain / map->area() : 0.0;
    stop = reason_to_stop();
    if (stop != SkycapStop::running) return std::nullopt;
    if (!choice) {
      stop = config.stop.most_length && std::isfinite(way) ? SkycapStop::most_length
             : std::isfinite(way)                          ? SkycapStop::most_time
                                                           : SkycapStop::nothing_in_reach;
      return std::nullopt;
    }
    if (choice->best_gain < config.stop.least_gain * reference_area()) {
      stop = SkycapStop::little_gain;
      return std::nullopt;
    }
    proposed = choice->view;
    if (config.sees_lines) promise = promise_of(*field, *map, choice->with_way);
    return proposed;
  }

  /// Returns the area to which the fractions of the stop rule refer [m^2].
  double reference_area() const {
    return std::min(map->area(), scans_of_an_object * most_covered_at_once);
  }

  SkycapStop reason_to_stop() const {
    const StopRule& rule = config.stop;
    if (predicted_coverage() >= rule.wanted_coverage) return SkycapStop::wanted_coverage;
    if (idle_scans >= most_idle_scans) return SkycapStop::little_gain;
    if (rule.most_length && length >= *rule.most_length) return SkycapStop::most_length;
    if (rule.most_time && most_way() <= 0.0) return SkycapStop::most_time;
    return SkycapStop::running;
  }

  /// Returns the expected area of the visible predictions [m^2]. The others are usually inside an
  /// object.
  double guessed_area() const {
    double area = 0.0;
    for (std::size_t t = 0; t < chances.size(); ++t) {
      if (field->is_patch(t)) area += chances[t] * field->targets()[t].weight;
    }
    return yield.value() * area;
  }

  double predicted_coverage() const {
    if (!map || map->surfels().size() == 0) return 0.0;
    return map->covered_area() / (map->area() + guessed_area());
  }

  std::size_t insert(const ScanSpan& scan) {
    points_before = kept.cloud().size();
    return kept.insert(scan, camera, region, static_cast<std::uint32_t>(taken++), config.threads);
  }

  void pass(const ScanSpan& scan) {
    Stopwatch stopwatch(on_way.times);
    on_way.points_new += insert(scan);
    stopwatch.lap("insert");
    const std::vector<BlockImage> images = make_block_images(scan, camera, blocks);
    learn_noise(images);
    const double newly_covered = add(images);
    if (!config.counts_ways) most_covered_at_once = std::max(most_covered_at_once, newly_covered);
    covered_on_way += newly_covered;
    is_field_old = true;
    stopwatch.lap("update");
  }

  std::optional<View> next_view(const ScanSpan& scan) {
    step = std::exchange(on_way, {});
    Stopwatch stopwatch(step.times);
    step.points_new += insert(scan);
    if (kept.cloud().size() == 0) {
      throw Error(ErrorKind::bad_geometry,
                  "the first scan contains no point of the scene; start from a view that sees it");
    }
    stopwatch.lap("insert");
    if (!map) start();
    take_in(scan);
    if (scans > 0) length += (scan.sensor_position() - present.position).norm();
    present = geometry::view_of(scan.world_from_sensor);
    ++scans;
    refused.clear();
    proposed.reset();
    stopwatch.lap("update");
    predict();
    step.frontiers = unseen->patches().size();
    stopwatch.lap("predict");
    auto view = choose();
    stopwatch.lap("choose");
    return view;
  }

  SurveyBelief belief() const;

  const SkycapConfig config;
  const geometry::Camera camera;
  const double distance;
  GainSettings gain;
  ChooserSettings chooser;
  std::optional<Eigen::AlignedBox3f> region;

  Clearness clearness;
  GuessYield yield;
  SpacedCloud kept;
  PlanningStep step;
  PlanningStep on_way;    ///< contribution to the next step of the scans since the last view
  std::size_t taken = 0;  ///< number of scans, including en-route scans
  std::size_t points_before = 0;  ///< points kept before the last scan
  bool is_field_old = false;      ///< the field does not include the latest scans
  double covered_on_way = 0.0;    ///< newly covered area since the last view [m^2]

  BlockSettings blocks;
  double least_jump = 0.0;
  NoiseEstimate noise;
  std::optional<DoseModel> dose;
  std::optional<DoseMap> map;
  std::optional<SpaceMemory> space;
  std::optional<UnseenSurface> unseen;
  std::optional<GainField> field;
  ChoiceMemory asked;          ///< cached gains of the field from the present view
  Promise promise;             ///< predicted gain of the path to the proposed view, for lines
  std::vector<float> chances;  ///< probability that a good view sees each target, if it exists

  double next_gain = 0.0;             ///< gain of the best view, as a fraction of the known area
  double most_covered_at_once = 0.0;  ///< maximum area newly covered by one scan [m^2]
  std::size_t scans = 0;
  double length = 0.0;
  int idle_scans = 0;
  View present;          ///< view of the last scan
  PlaceCheck may_be_at;  ///< null: all positions allowed
  std::optional<View> proposed;
  std::vector<View> refused;  ///< rejected views since the last scan
  SkycapStop stop = SkycapStop::running;
};

SurveyBelief SkycapPlanner::Impl::belief() const {
  SurveyBelief belief;
  if (!map) return belief;
  belief.patches =
      believed_patches(*map, *field, unseen->patches(), chances, static_cast<float>(yield.value()));
  add_up(belief);
  belief.coverage = predicted_coverage();
  belief.next_gain = next_gain;
  belief.noise = dose->noise().across(1.0);
  belief.growing_noise = dose->noise().growing;
  return belief;
}

SkycapPlanner::SkycapPlanner(const SkycapConfig& config, const geometry::Camera& camera) {
  config.validate();
  impl_ = std::make_unique<Impl>(config, camera);
}

SkycapPlanner::~SkycapPlanner() = default;

std::optional<View> SkycapPlanner::next_view(const ScanSpan& scan) {
  return impl_->next_view(scan);
}

void SkycapPlanner::pass(const ScanSpan& scan) { impl_->pass(scan); }
void SkycapPlanner::keep_to(PlaceCheck may_be_at) { impl_->may_be_at = std::move(may_be_at); }

std::optional<View> SkycapPlanner::next_view_instead() {
  if (impl_->proposed) impl_->refused.push_back(*std::exchange(impl_->proposed, std::nullopt));
  return impl_->field ? impl_->choose() : std::nullopt;
}

const geometry::PointCloud& SkycapPlanner::cloud() const { return impl_->kept.cloud(); }
geometry::PointCloud SkycapPlanner::release_cloud() { return impl_->kept.release_cloud(); }
const PlanningStep& SkycapPlanner::last_step() const { return impl_->step; }
void SkycapPlanner::stop_on(const std::stop_token& stop) { impl_->chooser.stop = stop; }
SkycapStop SkycapPlanner::stop() const { return impl_->stop; }

StopReason SkycapPlanner::stop_reason() const {
  if (impl_->stop == SkycapStop::most_length) return StopReason::distance_limit;
  return impl_->stop == SkycapStop::most_time ? StopReason::time_limit : StopReason::complete;
}

std::string_view SkycapPlanner::stop_rule() const {
  switch (impl_->stop) {
    case SkycapStop::wanted_coverage:
      return "target_coverage";
    case SkycapStop::little_gain:
      return "min_gain";
    case SkycapStop::most_length:
      return "max_length";
    case SkycapStop::most_time:
      return "max_time";
    case SkycapStop::nothing_in_reach:
      return "no_reachable_view";
    case SkycapStop::running:
      break;
  }
  return "running";
}

double SkycapPlanner::predicted_coverage() const { return impl_->predicted_coverage(); }
SurveyBelief SkycapPlanner::belief() const { return impl_->belief(); }

std::shared_ptr<const GainField> SkycapPlanner::known_surface(std::size_t most_targets) const {
  if (!impl_->map) return nullptr;
  return std::make_shared<const GainField>(GainField::of_known_surface(
      *impl_->map, impl_->camera, *impl_->dose, impl_->gain, most_targets));
}

}  // namespace skycap::survey::skycap
