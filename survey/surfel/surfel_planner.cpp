#include "survey/surfel/surfel_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/error.h"
#include "survey/stopwatch.h"
#include "survey/surfel/block_image.h"
#include "survey/surfel/coverage_model.h"
#include "survey/surfel/free_space_history.h"
#include "survey/surfel/noise_estimate.h"
#include "survey/surfel/predicted_surface.h"
#include "survey/surfel/spaced_cloud.h"
#include "survey/surfel/surfel_map.h"
#include "survey/surfel/view_gain.h"
#include "survey/surfel/view_selector.h"

namespace skycap::survey::surfel {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::ScanSpan;
using geometry::View;

/// The survey ends after this number of consecutive scans that each add less than this fraction of
/// the area.
constexpr double idle_gain = 0.003;
constexpr int max_idle_scans = 8;
/// Fractions refer to the known area, but at most to this multiple of the maximum area that one
/// scan covered. Objects need about as many scans. For a larger scene, the same absolute gains are
/// then relevant as for an object.
constexpr double scans_per_object = 7.0;
/// Length of unknown space, as a fraction of d, with a line-of-sight confidence of 37%.
constexpr double line_of_sight_scale = 0.15;
/// Patches per chain where no scan could have shown surface: up to 26 surfel spacings.
constexpr int unobserved_steps = 5;
/// Clusters of the remaining surface. They are small, because few positions near them are verified.
constexpr int max_remaining_clusters = 300, remaining_cells_across = 16;
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

struct SurfelPlanner::Impl {
  Impl(const SurfelConfig& given, const geometry::Camera& sensor)
      : config(given),
        camera(sensor),
        distance(given.view_distance.value_or(0.5 * given.coverage_radius / ray_spacing(camera))),
        line_of_sight(static_cast<float>(line_of_sight_scale * distance)),
        remaining_line_of_sight(static_cast<float>(line_of_sight_scale * distance)),
        kept(given.spacing.value_or(0.5 * given.coverage_radius), distance * ray_spacing(camera)) {
    gain.view_distance = distance;
    gain.max_incidence = std::min(gain.max_incidence, static_cast<float>(given.max_incidence));
    view_selector.view_distance = distance;
    view_selector.view_price = given.view_price.value_or(3.0 * distance);
    view_selector.threads = given.threads;
    view_selector.frame_spacing = given.frame_spacing;
    view_selector.counts_en_route = given.counts_en_route;
    view_selector.sees_lines = given.sees_lines;
    if (!given.ablation.targeted_views) view_selector.clusters = 0;
    if (!given.ablation.refinement) view_selector.refinements = 0;
    if (!given.ablation.batch) view_selector.batch = 1;
    if (given.scene_box) region = given.scene_box->cast<float>();
  }

  /// Sets the resolution from the first scan that contains a point.
  void start() {
    Eigen::AlignedBox3f seen;
    for (const Vector3f& point : kept.cloud().positions) seen.extend(point);
    const double extent =
        config.scene_box ? config.scene_box->sizes().maxCoeff() : seen.sizes().maxCoeff();
    const auto [h, block_px, jump] =
        make_scale(extent, distance * ray_spacing(camera), config.resolution);
    blocks.block_px = block_px;
    blocks.threads = config.threads;
    min_jump = jump;
    blocks.jump = static_cast<float>(std::max(min_jump, unknown_noise_jump * extent));
    map.emplace(static_cast<float>(h), config.threads);
    space.emplace(static_cast<float>(0.6 * h), config.misses_are_empty,
                  MeasurableRange{.min = static_cast<float>(camera.config().min_range),
                                  .max = static_cast<float>(camera.config().max_range)});
    coverage_model.emplace(config.coverage_radius, with_pose_errors({}), ray_spacing(camera));
    predicted.emplace(PredictedSurfaceSettings{
        .steps = config.ablation.surface_prediction ? config.continuation_steps : 0,
        .learns_rates = config.ablation.learned_rates,
        .threads = config.threads});
    unobserved.emplace(
        PredictedSurfaceSettings{.steps = config.ablation.surface_prediction ? unobserved_steps : 0,
                                 .learns_rates = false,
                                 .threads = config.threads,
                                 .is_unobserved_only = true});
    if (config.prior) predicted->expect({*config.prior, static_cast<float>(h)});
  }

  /// Adds the configured pose errors, which cannot be estimated from scans.
  Noise with_pose_errors(Noise learnt) const {
    learnt.position = config.position_error;
    learnt.angle = config.angle_error;
    return learnt;
  }

  void learn_noise(const std::vector<BlockImage>& images) {
    for (const BlockImage& image : images) noise.add(image);
    if (!config.ablation.coverage_model) return;
    const auto estimate = noise.noise(negligible_noise * config.coverage_radius, distance);
    if (!estimate) return;
    if (!coverage_model->noise().is_similar(*estimate, noise_change)) {
      coverage_model.emplace(config.coverage_radius, with_pose_errors(*estimate),
                             ray_spacing(camera));
    }
    blocks.jump =
        static_cast<float>(std::max(min_jump, noise_jump * coverage_model->noise().across(1.0)));
  }

  void add_scan(const ScanSpan& scan) {
    // En-route scans have already shown a part of the predicted gain. For lines, the prediction
    // refers to paths.
    if (is_field_old && !config.sees_lines) predict();
    const std::vector<BlockImage> images = make_block_images(scan, camera, blocks);
    learn_noise(images);
    const View view = geometry::to_view(scan.world_from_sensor);
    GainPrediction expected_gain;
    if (!config.sees_lines && field) {
      expected_gain = compute_prediction(*field, *map, field->visible_targets(view));
    } else if (proposed && (proposed->position - view.position).norm() < 0.1 * distance) {
      expected_gain = std::exchange(gain_prediction, {});
    }
    const std::size_t first_new = expected_gain.surfels();
    const double here = add(images), with_leg = here + std::exchange(covered_en_route, 0.0);
    const double newly_covered = config.sees_lines ? with_leg : here;
    max_covered_at_once = std::max(max_covered_at_once, config.counts_en_route ? with_leg : here);
    if (field) {
      grade(expected_gain, *field, *map, *predicted, *space);
    } else {
      predicted->grade({}, *map, *space, 0);
    }
    yield.learn(expected_gain.predicted, newly_covered - expected_gain.seen,
                map->new_territory(first_new));
    idle_scans = with_leg < idle_gain * reference_area() ? idle_scans + 1 : 0;
  }

  /// Adds a scan to the model and returns the newly covered area [m^2].
  double add(const std::vector<BlockImage>& images) {
    const double covered_before = map->covered_area();
    const auto noise_along = static_cast<float>(coverage_model->noise().across(1.0));
    // Noise may have displaced a point to this position without measuring it.
    const double reach = config.coverage_radius - 2.0 * coverage_model->noise().across(1.0);
    const IsMeasured was_measured = [&](const Vector3f& position) {
      return reach > 0.0 && kept.has_near(position, reach, points_before);
    };
    for (const BlockImage& image : images) {
      if (config.ablation.free_space) space->add(image, noise_along);
      map->add(image, *coverage_model, blocks.jump, region, was_measured);
    }
    space->compare_misses(map->surfels().positions, map->surfels().normals);
    return map->covered_area() - covered_before;
  }

  /// Predicts how the surface continues and updates all targets.
  void predict() {
    is_field_old = false;
    predicted->predict(*map, *space, region);
    line_of_sight.update(predicted->patches(), *space, config.threads);
    field.emplace(*map, predicted->patches(), camera, *coverage_model, gain,
                  predicted->prior_occluders(), &line_of_sight);
    asked = {};
    remaining_field.reset();
  }

  /// Updates the targets of the remaining surface: the predicted patches with their yield. Patches
  /// that no scan could have shown have their initial rates and longer chains.
  void predict_remaining() {
    if (remaining_field) return;
    unobserved->predict(*map, *space, region);
    remaining.clear();
    const auto prediction_weight = static_cast<float>(std::min(1.0, yield.value()));
    for (PredictedPatch patch : predicted->patches()) {
      patch.weight *= prediction_weight;
      if (!patch.is_unobserved) remaining.push_back(patch);
    }
    remaining.insert(remaining.end(), unobserved->patches().begin(), unobserved->patches().end());
    remaining_line_of_sight.update(remaining, *space, config.threads);
    remaining_field.emplace(*map, remaining, camera, *coverage_model, gain,
                            predicted->prior_occluders(), &remaining_line_of_sight);
    remaining_asked = {};
    unverified_asked = {};
  }

  /// Returns the box in which unknown space may contain obstacles.
  Eigen::AlignedBox3d obstacle_box() const {
    if (config.scene_box) return *config.scene_box;
    Eigen::AlignedBox3f box;
    for (const Vector3f& p : map->surfels().positions) box.extend(p);
    return box.cast<double>();
  }

  /// Evidence required that a position is free.
  enum class Proof { one_scan, several_scans };

  bool is_free(const View& view, const Eigen::AlignedBox3d& keep_out_box, Proof proof) const {
    if (!keep_out_box.contains(view.position)) return true;
    const Vector3f at = view.position.cast<float>();
    const float radius = clearance();
    if (proof == Proof::one_scan) {
      return space->is_verified_empty(at, radius) && !map->has_surfel_near(at, radius);
    }
    return !map->has_surfel_near(at, radius) && space->is_jointly_verified_empty(at, radius);
  }

  /// Returns the minimum distance of views from unknown space and measured surface [m].
  float clearance() const {
    return static_cast<float>(std::max<double>(config.limits.min_standoff, map->spacing()));
  }

  Eigen::AlignedBox3d keep_out_box() const {
    const Vector3d min_standoff = Vector3d::Constant(config.limits.min_standoff);
    const Eigen::AlignedBox3d seen = obstacle_box();
    return {seen.min() - min_standoff, seen.max() + min_standoff};
  }

  Admission admission(Proof proof) const {
    return [this, box = keep_out_box(), proof](const View& view) {
      const bool is_rejected =
          std::any_of(rejected.begin(), rejected.end(), [&](const View& other) {
            return (view.position - other.position).norm() < 0.1 * distance;
          });
      return !is_rejected && is_free(view, box, proof) && (!may_be_at || may_be_at(view.position));
    };
  }

  /// Returns a function that admits the other positions which may be free: they are not verified,
  /// but no scan shows that they are behind or near surface.
  Admission unverified_admission() const {
    return [this, box = keep_out_box()](const View& view) {
      const Vector3f at = view.position.cast<float>();
      const SpaceState state = space->query(at);
      if (state == SpaceState::hidden || state == SpaceState::measured) return false;
      if (map->has_surfel_near(at, clearance())) return false;
      return !is_free(view, box, Proof::several_scans) || (may_be_at && !may_be_at(view.position));
    };
  }

  /// Returns the maximum distance of the next view for the limits of length and time [m].
  double max_path_length() const {
    double path_length = std::numeric_limits<double>::infinity();
    if (config.stop.max_length)
      path_length = std::min(path_length, *config.stop.max_length - length);
    if (config.stop.max_time) {
      const double left = *config.stop.max_time - length / config.stop.speed -
                          static_cast<double>(scans + 1) * config.stop.time_per_view;
      path_length = std::min(path_length, left * config.stop.speed);
    }
    return path_length;
  }

  std::optional<View> choose() {
    const double path_length = max_path_length();
    view_selector.prediction_yield = yield.value();
    const auto choice = choose_view(*field, config.limits, admission(Proof::one_scan), present,
                                    path_length, view_selector, asked);
    chances = choice ? choice->chances : std::vector<float>(field->targets().size(), 0.0F);
    next_gain = choice && map->area() > 0.0 ? choice->best_gain / map->area() : 0.0;
    remaining_patches.clear();
    remaining_area = 0.0;
    has_remaining = false;
    stop = reason_to_stop();
    if (stop == SurfelStop::max_length || stop == SurfelStop::max_time) return std::nullopt;
    const double min_gain = config.stop.min_gain * reference_area();
    if (stop == SurfelStop::running && choice && choice->best_gain >= min_gain) {
      return propose(*choice, true);
    }
    if (stop == SurfelStop::running && !choice && std::isfinite(path_length)) {
      stop = config.stop.max_length ? SurfelStop::max_length : SurfelStop::max_time;
      return std::nullopt;
    }
    const auto remaining_choice = assess_remaining(path_length);
    if (stop == SurfelStop::target_coverage) {
      stop = reason_to_stop();  // the estimate now includes the remaining surface
      if (stop == SurfelStop::target_coverage) return std::nullopt;
      if (stop == SurfelStop::running && choice && choice->best_gain >= min_gain) {
        return propose(*choice, true);
      }
    }
    if (stop == SurfelStop::running && remaining_choice) return propose(*remaining_choice, false);
    if (stop == SurfelStop::running) {
      stop = choice && !has_remaining ? SurfelStop::little_gain : SurfelStop::nothing_in_reach;
    } else if (has_remaining) {
      stop = SurfelStop::nothing_in_reach;
    }
    return std::nullopt;
  }

  View propose(const Choice& choice, bool is_of_field) {
    proposed = choice.view;
    if (config.sees_lines) {
      gain_prediction =
          is_of_field ? compute_prediction(*field, *map, choice.with_leg) : GainPrediction{};
    }
    return choice.view;
  }

  /// Determines the remaining surface: predicted patches that only views at unverified positions
  /// would show, and patches that no scan could have shown. If a view of it would gain enough, adds
  /// it to the estimate. Returns the best view from a position that several scans together verify,
  /// possibly at a shorter distance, or nullopt if no such view gains enough.
  std::optional<Choice> assess_remaining(double path_length) {
    // A single line shows next to nothing, so that most surface is outside all images.
    if (config.sees_lines) return std::nullopt;
    predict_remaining();
    ViewSelectorSettings settings = view_selector;
    settings.prediction_yield = 1.0;
    const auto unverified =
        choose_view(*remaining_field, config.limits, unverified_admission(), present,
                    std::numeric_limits<double>::infinity(), settings, unverified_asked);
    settings.distances = {1.0, 0.8, 0.65, 0.5, 0.4, 0.3};
    if (settings.clusters > 0) settings.clusters = max_remaining_clusters;
    settings.cells_across = remaining_cells_across;
    const double min_gain = config.stop.min_gain * reference_area();
    double unobserved_area = 0.0;
    for (const PredictedPatch& patch : unobserved->patches()) unobserved_area += patch.weight;
    std::optional<Choice> verified;
    if (unobserved_area >= min_gain) {
      verified = choose_view(*remaining_field, config.limits, admission(Proof::several_scans),
                             present, path_length, settings, remaining_asked);
      if (verified && verified->best_gain < min_gain) verified.reset();
    }
    has_remaining = verified || (unverified && unverified->best_gain >= min_gain);
    if (!has_remaining) return std::nullopt;
    for (std::size_t t = 0; t < remaining_field->targets().size(); ++t) {
      if (!remaining_field->is_patch(t)) continue;
      const PredictedPatch& patch = remaining[remaining_field->source(t)];
      float chance = unverified ? unverified->chances[t] : 0.0F;
      if (patch.is_unobserved) {
        if (verified) chance = std::max(chance, verified->chances[t]);
        // The unknown space in front of it is part of what remains.
        chance = chance > 0.0F ? 1.0F : 0.0F;
      }
      if (!(chance > 0.0F)) continue;
      remaining_patches.push_back(
          {patch.position, patch.normal, chance * patch.weight, 0.0F, MissingReason::unreachable});
      remaining_area += remaining_patches.back().area;
    }
    // The estimate already contains the patches that no scan could have shown.
    for (std::size_t t = 0; t < chances.size(); ++t) {
      if (field->is_patch(t) && predicted->patches()[field->source(t)].is_unobserved) {
        chances[t] = 0.0F;
      }
    }
    return verified;
  }

  /// Returns the area to which the fractions of the stopping rule refer [m^2].
  double reference_area() const {
    return std::min(map->area(), scans_per_object * max_covered_at_once);
  }

  SurfelStop reason_to_stop() const {
    const StopRule& rule = config.stop;
    if (predicted_coverage() >= rule.target_coverage) return SurfelStop::target_coverage;
    if (idle_scans >= max_idle_scans) return SurfelStop::little_gain;
    if (rule.max_length && length >= *rule.max_length) return SurfelStop::max_length;
    if (rule.max_time && max_path_length() <= 0.0) return SurfelStop::max_time;
    return SurfelStop::running;
  }

  /// Returns the expected area of the visible predictions [m^2]. The others are usually inside an
  /// object.
  double predicted_area() const {
    double area = 0.0;
    for (std::size_t t = 0; t < chances.size(); ++t) {
      if (field->is_patch(t)) area += chances[t] * field->targets()[t].weight;
    }
    return yield.value() * area;
  }

  double predicted_coverage() const {
    if (!map || map->surfels().size() == 0) return 0.0;
    return map->covered_area() / (map->area() + predicted_area() + remaining_area);
  }

  std::size_t insert(const ScanSpan& scan) {
    points_before = kept.cloud().size();
    return kept.insert(scan, camera, region, static_cast<std::uint32_t>(scan_count++),
                       config.threads);
  }

  void pass(const ScanSpan& scan) {
    Stopwatch stopwatch(en_route.times);
    en_route.points_new += insert(scan);
    stopwatch.lap("insert");
    const std::vector<BlockImage> images = make_block_images(scan, camera, blocks);
    learn_noise(images);
    const double newly_covered = add(images);
    if (!config.counts_en_route) max_covered_at_once = std::max(max_covered_at_once, newly_covered);
    covered_en_route += newly_covered;
    is_field_old = true;
    stopwatch.lap("update");
  }

  std::optional<View> next_view(const ScanSpan& scan) {
    step = std::exchange(en_route, {});
    Stopwatch stopwatch(step.times);
    step.points_new += insert(scan);
    if (kept.cloud().size() == 0) {
      throw Error(ErrorKind::bad_geometry,
                  "the first scan contains no point of the scene; start from a view that sees it");
    }
    stopwatch.lap("insert");
    if (!map) start();
    add_scan(scan);
    if (scans > 0) length += (scan.sensor_position() - present.position).norm();
    present = geometry::to_view(scan.world_from_sensor);
    ++scans;
    rejected.clear();
    proposed.reset();
    stopwatch.lap("update");
    predict();
    step.frontiers = predicted->patches().size();
    stopwatch.lap("predict");
    auto view = choose();
    stopwatch.lap("choose");
    return view;
  }

  SurveyEstimate estimate() const;

  const SurfelConfig config;
  const geometry::Camera camera;
  const double distance;
  GainSettings gain;
  ViewSelectorSettings view_selector;
  std::optional<Eigen::AlignedBox3f> region;

  LineOfSightModel line_of_sight, remaining_line_of_sight;
  PredictionYield yield;
  SpacedCloud kept;
  PlanningStep step;
  PlanningStep en_route;       ///< contribution to the next step of the scans since the last view
  std::size_t scan_count = 0;  ///< number of scans, including en-route scans
  std::size_t points_before = 0;  ///< points kept before the last scan
  bool is_field_old = false;      ///< the field does not include the latest scans
  double covered_en_route = 0.0;  ///< newly covered area since the last view [m^2]

  BlockSettings blocks;
  double min_jump = 0.0;
  NoiseEstimate noise;
  std::optional<CoverageModel> coverage_model;
  std::optional<SurfelMap> map;
  std::optional<FreeSpaceHistory> space;
  std::optional<PredictedSurface> predicted;
  std::optional<GainField> field;
  ViewGainCache asked;                         ///< cached gains of the field from the present view
  std::optional<PredictedSurface> unobserved;  ///< patches that no scan could have shown
  std::vector<PredictedPatch> remaining;       ///< see predict_remaining()
  std::optional<GainField> remaining_field;    ///< none: not up to date
  ViewGainCache remaining_asked, unverified_asked;
  std::vector<EstimatedPatch> remaining_patches;  ///< see assess_remaining()
  double remaining_area = 0.0;                    ///< sum of the areas of remaining_patches [m^2]
  bool has_remaining = false;      ///< a view of the remaining surface would gain enough
  GainPrediction gain_prediction;  ///< predicted gain of the path to the proposed view, for lines
  std::vector<float> chances;      ///< probability that a good view sees each target, if it exists

  double next_gain = 0.0;            ///< gain of the best view, as a fraction of the known area
  double max_covered_at_once = 0.0;  ///< maximum area newly covered by one scan [m^2]
  std::size_t scans = 0;
  double length = 0.0;
  int idle_scans = 0;
  View present;             ///< view of the last scan
  PositionCheck may_be_at;  ///< null: all positions allowed
  std::optional<View> proposed;
  std::vector<View> rejected;  ///< rejected views since the last scan
  SurfelStop stop = SurfelStop::running;
};

SurveyEstimate SurfelPlanner::Impl::estimate() const {
  SurveyEstimate estimate;
  if (!map) return estimate;
  estimate.patches = estimated_patches(*map, *field, predicted->patches(), chances,
                                       static_cast<float>(yield.value()));
  estimate.patches.insert(estimate.patches.end(), remaining_patches.begin(),
                          remaining_patches.end());
  add_up(estimate);
  estimate.coverage = predicted_coverage();
  estimate.next_gain = next_gain;
  estimate.noise = coverage_model->noise().across(1.0);
  estimate.growing_noise = coverage_model->noise().growing;
  return estimate;
}

SurfelPlanner::SurfelPlanner(const SurfelConfig& config, const geometry::Camera& camera) {
  config.validate();
  impl_ = std::make_unique<Impl>(config, camera);
}

SurfelPlanner::~SurfelPlanner() = default;

std::optional<View> SurfelPlanner::next_view(const ScanSpan& scan) {
  return impl_->next_view(scan);
}

void SurfelPlanner::pass(const ScanSpan& scan) { impl_->pass(scan); }
void SurfelPlanner::keep_to(PositionCheck may_be_at) { impl_->may_be_at = std::move(may_be_at); }

std::optional<View> SurfelPlanner::next_alternative_view() {
  if (impl_->proposed) impl_->rejected.push_back(*std::exchange(impl_->proposed, std::nullopt));
  return impl_->field ? impl_->choose() : std::nullopt;
}

const geometry::PointCloud& SurfelPlanner::cloud() const { return impl_->kept.cloud(); }
geometry::PointCloud SurfelPlanner::take_cloud() { return impl_->kept.take_cloud(); }
const PlanningStep& SurfelPlanner::last_step() const { return impl_->step; }
void SurfelPlanner::stop_on(const std::stop_token& stop) { impl_->view_selector.stop = stop; }
SurfelStop SurfelPlanner::stop() const { return impl_->stop; }

StopReason SurfelPlanner::stop_reason() const {
  if (impl_->stop == SurfelStop::max_length) return StopReason::distance_limit;
  if (impl_->stop == SurfelStop::max_time) return StopReason::time_limit;
  if (impl_->stop == SurfelStop::target_coverage) return StopReason::complete;
  return impl_->has_remaining ? StopReason::nowhere_to_go : StopReason::complete;
}

std::string_view SurfelPlanner::stop_rule() const {
  switch (impl_->stop) {
    case SurfelStop::target_coverage:
      return "target_coverage";
    case SurfelStop::little_gain:
      return "min_gain";
    case SurfelStop::max_length:
      return "max_length";
    case SurfelStop::max_time:
      return "max_time";
    case SurfelStop::nothing_in_reach:
      return "no_reachable_view";
    case SurfelStop::running:
      break;
  }
  return "running";
}

double SurfelPlanner::predicted_coverage() const { return impl_->predicted_coverage(); }
SurveyEstimate SurfelPlanner::estimate() const { return impl_->estimate(); }

std::shared_ptr<const GainField> SurfelPlanner::known_surface(std::size_t max_targets) const {
  if (!impl_->map) return nullptr;
  return std::make_shared<const GainField>(GainField::from_known_surface(
      *impl_->map, impl_->camera, *impl_->coverage_model, impl_->gain, max_targets));
}

}  // namespace skycap::survey::surfel
