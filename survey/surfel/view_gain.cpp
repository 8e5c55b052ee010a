#include "survey/surfel/view_gain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "survey/surfel/raster/depth_raster.h"

namespace skycap::survey::surfel {
namespace {

using Eigen::Vector3f;

// An observation that yields less than a quarter of a substantial predicted gain halves the trust
// in its surfel.
constexpr float min_promise = 0.2F, kept_prediction = 0.25F, broken_trust = 0.5F;

/// Surfels with a smaller missing area, relative to the maximum, are not targets. Their sum is far
/// below all stopping rules.
constexpr float min_weight_fraction = 2e-3F;
constexpr float raster_spacing = 1.0F;  // pixel size at the view distance, in units of h

constexpr std::size_t chunk =
    2048;  // targets projected at a time, so that their arrays fit into the cache

/// Depth images and projected targets of a chunk, reused between calls on the same thread.
struct Workspace {
  DepthRaster raster, prior_raster;
  std::array<std::uint32_t, chunk> in_view, pixels, numbers;
  std::array<float, chunk> depths, cosines, densities, slopes;
};

PointArrays to_arrays(const std::array<std::vector<float>, 3>& points, std::size_t first) {
  return {points[0].data() + first, points[1].data() + first, points[2].data() + first};
}

void append(std::array<std::vector<float>, 3>& points, const Vector3f& point) {
  for (int axis = 0; axis < 3; ++axis) points[axis].push_back(point[axis]);
}

}  // namespace

GainField::GainField(const SurfelMap& map, const geometry::Camera& camera,
                     const CoverageModel& coverage_model, const GainSettings& settings)
    : coverage_model_(coverage_model),
      spacing_(map.spacing()),
      min_cosine_(std::cos(settings.max_incidence)),
      focal_length_px_(camera.focal_length_px().cast<float>()),
      min_range_(std::max(1e-6F, static_cast<float>(camera.config().min_range))),
      max_range_(static_cast<float>(camera.config().max_range)) {
  half_slope_ = {0.5F * static_cast<float>(camera.width()) / focal_length_px_.x(),
                 0.5F * static_cast<float>(camera.height()) / focal_length_px_.y()};
  raster_focal_length_px_ =
      static_cast<float>(settings.view_distance) / (raster_spacing * spacing_);
  raster_width_ = static_cast<int>(std::ceil(2.0F * half_slope_.x() * raster_focal_length_px_)) + 1;
  raster_height_ =
      static_cast<int>(std::ceil(2.0F * half_slope_.y() * raster_focal_length_px_)) + 1;

  for (const Vector3f& position : map.surfels().positions) append(occluders_, position);
}

GainField::GainField(const SurfelMap& map, std::span<const PredictedPatch> patches,
                     const geometry::Camera& camera, const CoverageModel& coverage_model,
                     const GainSettings& settings, std::span<const Vector3f> prior_occluders,
                     const LineOfSightModel* line_of_sight_probability)
    : GainField(map, camera, coverage_model, settings) {
  line_of_sight_model_ = line_of_sight_probability;
  const Surfels& surfels = map.surfels();
  const float min_weight = min_weight_fraction * spacing_ * spacing_;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const float weight = surfels.deficit(i) * surfels.trusts[i];
    if (weight < min_weight) continue;
    targets_.push_back({surfels.positions[i], surfels.normals[i], weight});
    sources_.push_back(static_cast<std::uint32_t>(i));
  }
  surfel_targets_ = targets_.size();
  // Patches of the same kind are consecutive.
  const auto is_prior_patch = [](const PredictedPatch& patch) { return patch.kind == prior_kind; };
  const auto priors = std::ranges::find_if(patches, is_prior_patch);
  first_prior_ = surfel_targets_ + static_cast<std::size_t>(priors - patches.begin());
  end_prior_ =
      first_prior_ + static_cast<std::size_t>(std::ranges::count_if(patches, is_prior_patch));
  for (const Vector3f& position : prior_occluders) append(prior_occluders_, position);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    targets_.push_back({patches[i].position, patches[i].normal, patches[i].weight});
    sources_.push_back(static_cast<std::uint32_t>(i));
  }
  index_targets();
}

GainField GainField::from_known_surface(const SurfelMap& map, const geometry::Camera& camera,
                                        const CoverageModel& coverage_model,
                                        const GainSettings& settings, std::size_t max_targets) {
  GainField field(map, camera, coverage_model, settings);
  const Surfels& surfels = map.surfels();
  const std::size_t stride = (surfels.size() + max_targets - 1) / max_targets;
  for (std::size_t first = 0; first < surfels.size(); first += stride) {
    const std::size_t end = std::min(first + stride, surfels.size()), middle = (first + end) / 2;
    float weight = 0.0F;
    for (std::size_t i = first; i < end; ++i) {
      // Surfels without area, because they refined known surface, get a typical area.
      constexpr float usual_area = 1.5F;  // in units of the squared spacing
      const float area =
          surfels.areas[i] > 0.0F ? surfels.areas[i] : usual_area * map.spacing() * map.spacing();
      weight += area * surfels.trusts[i];
    }
    field.targets_.push_back({surfels.positions[middle], surfels.normals[middle], weight});
    field.sources_.push_back(static_cast<std::uint32_t>(middle));
  }
  field.surfel_targets_ = field.first_prior_ = field.end_prior_ = field.targets_.size();
  field.index_targets();
  return field;
}

GainField GainField::with_targets(std::vector<Target> targets) const {
  GainField field = *this;
  field.targets_ = std::move(targets);
  field.sources_.clear();
  field.positions_ = field.normals_ = {};
  field.surfel_targets_ = field.first_prior_ = field.end_prior_ = field.targets_.size();
  field.index_targets();
  return field;
}

void GainField::index_targets() {
  for (const Target& target : targets_) {
    append(positions_, target.position);
    append(normals_, target.normal);
  }
}

RasterView GainField::raster_view(const geometry::View& view) const {
  const Eigen::Isometry3d world_from_camera = geometry::camera_pose(view);
  const Eigen::Matrix3f axes = world_from_camera.linear().cast<float>();
  RasterView raster{.focal_length = raster_focal_length_px_,
                    .width = static_cast<float>(raster_width_),
                    .height = static_cast<float>(raster_height_),
                    .stride = raster_width_ + 2 + row_margin,
                    .outside = static_cast<std::uint32_t>((raster_width_ + 2 + row_margin) *
                                                          (raster_height_ + 2)),
                    .half_slope = {half_slope_.x(), half_slope_.y()},
                    .min_range = min_range_,
                    .max_range = max_range_,
                    .min_cosine = min_cosine_};
  const Vector3f position = view.position.cast<float>();
  for (int axis = 0; axis < 3; ++axis) {
    raster.position[axis] = position[axis];
    raster.right[axis] = axes(axis, 0);
    raster.down[axis] = axes(axis, 1);
    raster.forward[axis] = axes(axis, 2);
  }
  return raster;
}

template <typename Visit>
void GainField::for_each_visible_target(const geometry::View& view, Visit visit) const {
  static thread_local Workspace work;
  const RasterView raster = raster_view(view);
  const Vector3f sensor = view.position.cast<float>();
  work.raster.draw(raster, occluders_[0].size(), to_arrays(occluders_, 0), spacing_);
  if (first_prior_ < end_prior_) {
    work.prior_raster.draw(raster, prior_occluders_[0].size(), to_arrays(prior_occluders_, 0),
                           spacing_);
  }

  const TargetArrays projected{work.in_view.data(), work.pixels.data(),    work.depths.data(),
                               work.cosines.data(), work.densities.data(), work.slopes.data()};
  for (std::size_t first = 0; first < targets_.size(); first += chunk) {
    const std::size_t count = std::min(chunk, targets_.size() - first);
    project_targets(raster, focal_length_px_.prod(), count, to_arrays(positions_, first),
                    to_arrays(normals_, first), projected);
    // Index lists instead of unpredictable branches.
    std::size_t in_view = 0, visible_count = 0;
    for (std::size_t i = 0; i < count; ++i) {
      work.numbers[in_view] = static_cast<std::uint32_t>(i);
      in_view += work.in_view[i];
    }
    for (std::size_t k = 0; k < in_view; ++k) {
      const std::uint32_t i = work.numbers[k];
      // A slanted surface occludes itself by its depth difference over a square.
      const float own_tolerance = spacing_ * (1.5F + 2.0F * work.slopes[i]);
      const float tolerance = first + i < surfel_targets_ ? own_tolerance : spacing_;
      work.numbers[visible_count] = i;
      visible_count += work.depths[i] > work.raster.depth(work.pixels[i]) + tolerance ? 0 : 1;
    }
    for (std::size_t k = 0; k < visible_count; ++k) {
      const std::size_t i = work.numbers[k];
      if (is_prior(first + i)) {
        const float own_tolerance = spacing_ * (1.5F + 2.0F * work.slopes[i]);
        if (work.depths[i] > work.prior_raster.depth(work.pixels[i]) + own_tolerance) continue;
      }
      const bool is_sure = line_of_sight_model_ == nullptr || !is_patch(first + i);
      visit(first + i, coverage_model_.hazard(work.densities[i], work.cosines[i]),
            is_sure ? 1.0F : line_of_sight_model_->of(source(first + i), sensor));
    }
  }
}

Gain GainField::gain(const geometry::View& view) const {
  Gain gain;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for_each_visible_target(view, [&](std::size_t t, float hazard, float line_of_sight_probability) {
    const double area = targets_[t].weight * line_of_sight_probability * (1.0F - std::exp(-hazard));
    gain.area += area;
    if (is_patch(t)) gain.predicted += area;
    moment += area * targets_[t].position.cast<double>();
  });
  if (gain.area > 0.0) gain.centroid = (moment / gain.area).cast<float>();
  return gain;
}

std::vector<VisibleTarget> GainField::visible_targets(const geometry::View& view) const {
  std::vector<VisibleTarget> visible_targets;
  for_each_visible_target(view, [&](std::size_t t, float hazard, float line_of_sight_probability) {
    visible_targets.push_back({static_cast<std::uint32_t>(t),
                               line_of_sight_probability * (1.0F - std::exp(-hazard)),
                               line_of_sight_probability});
  });
  return visible_targets;
}

std::vector<Observation> GainField::observations(const geometry::View& view) const {
  std::vector<Observation> observations;
  for_each_visible_target(view, [&](std::size_t t, float hazard, float /*clearness*/) {
    observations.push_back({static_cast<std::uint32_t>(t), hazard});
  });
  return observations;
}

GainPrediction compute_prediction(const GainField& field, const SurfelMap& map,
                                  std::vector<VisibleTarget> visible_targets) {
  GainPrediction gain_prediction{std::move(visible_targets), map.surfels().hazards};
  for (const VisibleTarget& visible_target : gain_prediction.visible_targets) {
    const double area =
        field.targets()[visible_target.target].weight * visible_target.covered_share;
    (field.is_patch(visible_target.target) ? gain_prediction.predicted : gain_prediction.seen) +=
        area;
  }
  return gain_prediction;
}

void grade(const GainPrediction& gain_prediction, const GainField& field, SurfelMap& map,
           PredictedSurface& predicted, const FreeSpaceHistory& space) {
  std::vector<PredictedSurface::Expected> patches;
  for (const VisibleTarget& visible_target : gain_prediction.visible_targets) {
    const std::uint32_t source = field.source(visible_target.target);
    if (field.is_patch(visible_target.target)) {
      patches.push_back({source, visible_target.line_of_sight_probability});
      continue;
    }
    const float predicted_sum = -std::log(std::max(1.0F - visible_target.covered_share, 1e-3F));
    const float gained = map.surfels().hazards[source] - gain_prediction.hazards[source];
    if (predicted_sum > min_promise && gained < kept_prediction * predicted_sum) {
      map.lower_trust(source, broken_trust);
    }
  }
  predicted.grade(patches, map, space, gain_prediction.surfels());
}

std::vector<EstimatedPatch> estimated_patches(const SurfelMap& map, const GainField& field,
                                              std::span<const PredictedPatch> patches,
                                              std::span<const float> chances,
                                              float prediction_yield) {
  constexpr float well_covered = 0.5F;  // more likely covered than not, and therefore not missing
  const Surfels& surfels = map.surfels();
  std::vector<EstimatedPatch> estimated;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    estimated.push_back({surfels.positions[i], surfels.normals[i], surfels.areas[i],
                         surfels.covered_share(i), MissingReason::none});
  }
  for (std::size_t t = 0; t < field.targets().size(); ++t) {
    const std::uint32_t source = field.source(t);
    if (!field.is_patch(t)) {
      EstimatedPatch& patch = estimated[source];
      if (patch.covered_share >= well_covered) continue;
      patch.reason =
          chances[t] > 0.0F ? MissingReason::seen_too_thinly : MissingReason::unreachable;
    } else if (chances[t] > 0.0F) {
      const PredictedPatch& patch = patches[source];
      estimated.push_back({patch.position, patch.normal,
                           prediction_yield * chances[t] * patch.weight, 0.0F,
                           MissingReason::never_seen});
    }
  }
  return estimated;
}

}  // namespace skycap::survey::surfel
