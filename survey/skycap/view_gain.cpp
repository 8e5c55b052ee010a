#include "survey/skycap/view_gain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "survey/skycap/raster/depth_raster.h"

namespace skycap::survey::skycap {
namespace {

using Eigen::Vector3f;

// An observation that yields less than a quarter of a substantial predicted gain halves the trust
// in its surfel.
constexpr float least_promise = 0.2F, kept_promise = 0.25F, broken_trust = 0.5F;

/// Surfels with a smaller missing area, relative to the maximum, are not targets. Their sum is far
/// below all stop rules.
constexpr float least_weight_share = 2e-3F;
constexpr float raster_spacing = 1.0F;  // pixel size at the view distance, in units of h

constexpr std::size_t chunk =
    2048;  // targets projected at a time, so that their arrays fit into the cache

/// Depth images and projected targets of a chunk, reused between calls on the same thread.
struct Workspace {
  DepthRaster raster, prior_raster;
  std::array<std::uint32_t, chunk> in_view, pixels, numbers;
  std::array<float, chunk> depths, cosines, densities, slopes;
};

PointArrays arrays_of(const std::array<std::vector<float>, 3>& points, std::size_t first) {
  return {points[0].data() + first, points[1].data() + first, points[2].data() + first};
}

void append(std::array<std::vector<float>, 3>& points, const Vector3f& point) {
  for (int axis = 0; axis < 3; ++axis) points[axis].push_back(point[axis]);
}

}  // namespace

GainField::GainField(const DoseMap& map, const geometry::Camera& camera, const DoseModel& dose,
                     const GainSettings& settings)
    : dose_(dose),
      spacing_(map.spacing()),
      least_cosine_(std::cos(settings.max_incidence)),
      focal_length_px_(camera.focal_length_px().cast<float>()),
      least_range_(std::max(1e-6F, static_cast<float>(camera.config().min_range))),
      most_range_(static_cast<float>(camera.config().max_range)) {
  half_slope_ = {0.5F * static_cast<float>(camera.width()) / focal_length_px_.x(),
                 0.5F * static_cast<float>(camera.height()) / focal_length_px_.y()};
  raster_focal_length_px_ =
      static_cast<float>(settings.view_distance) / (raster_spacing * spacing_);
  raster_width_ = static_cast<int>(std::ceil(2.0F * half_slope_.x() * raster_focal_length_px_)) + 1;
  raster_height_ =
      static_cast<int>(std::ceil(2.0F * half_slope_.y() * raster_focal_length_px_)) + 1;

  for (const Vector3f& position : map.surfels().positions) append(occluders_, position);
}

GainField::GainField(const DoseMap& map, std::span<const UnseenPatch> patches,
                     const geometry::Camera& camera, const DoseModel& dose,
                     const GainSettings& settings, std::span<const Vector3f> prior_occluders,
                     const Clearness* clearness)
    : GainField(map, camera, dose, settings) {
  clearness_ = clearness;
  const Surfels& surfels = map.surfels();
  const float least_weight = least_weight_share * spacing_ * spacing_;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const float weight = surfels.deficit(i) * surfels.trusts[i];
    if (weight < least_weight) continue;
    targets_.push_back({surfels.positions[i], surfels.normals[i], weight});
    sources_.push_back(static_cast<std::uint32_t>(i));
  }
  surfel_targets_ = targets_.size();
  // Patches of the same kind are consecutive.
  const auto is_prior_patch = [](const UnseenPatch& patch) { return patch.kind == prior_kind; };
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

GainField GainField::of_known_surface(const DoseMap& map, const geometry::Camera& camera,
                                      const DoseModel& dose, const GainSettings& settings,
                                      std::size_t most_targets) {
  GainField field(map, camera, dose, settings);
  const Surfels& surfels = map.surfels();
  const std::size_t stride = (surfels.size() + most_targets - 1) / most_targets;
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
                    .least_range = least_range_,
                    .most_range = most_range_,
                    .least_cosine = least_cosine_};
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
void GainField::for_each_sight(const geometry::View& view, Visit visit) const {
  static thread_local Workspace work;
  const RasterView raster = raster_view(view);
  const Vector3f sensor = view.position.cast<float>();
  work.raster.draw(raster, occluders_[0].size(), arrays_of(occluders_, 0), spacing_);
  if (first_prior_ < end_prior_) {
    work.prior_raster.draw(raster, prior_occluders_[0].size(), arrays_of(prior_occluders_, 0),
                           spacing_);
  }

  const TargetArrays projected{work.in_view.data(), work.pixels.data(),    work.depths.data(),
                               work.cosines.data(), work.densities.data(), work.slopes.data()};
  for (std::size_t first = 0; first < targets_.size(); first += chunk) {
    const std::size_t count = std::min(chunk, targets_.size() - first);
    project_targets(raster, focal_length_px_.prod(), count, arrays_of(positions_, first),
                    arrays_of(normals_, first), projected);
    // Index lists instead of unpredictable branches.
    std::size_t in_view = 0, in_sight = 0;
    for (std::size_t i = 0; i < count; ++i) {
      work.numbers[in_view] = static_cast<std::uint32_t>(i);
      in_view += work.in_view[i];
    }
    for (std::size_t k = 0; k < in_view; ++k) {
      const std::uint32_t i = work.numbers[k];
      // A slanted surface occludes itself by its depth difference over a square.
      const float own_tolerance = spacing_ * (1.5F + 2.0F * work.slopes[i]);
      const float tolerance = first + i < surfel_targets_ ? own_tolerance : spacing_;
      work.numbers[in_sight] = i;
      in_sight += work.depths[i] > work.raster.depth(work.pixels[i]) + tolerance ? 0 : 1;
    }
    for (std::size_t k = 0; k < in_sight; ++k) {
      const std::size_t i = work.numbers[k];
      if (is_prior(first + i)) {
        const float own_tolerance = spacing_ * (1.5F + 2.0F * work.slopes[i]);
        if (work.depths[i] > work.prior_raster.depth(work.pixels[i]) + own_tolerance) continue;
      }
      const bool is_sure = clearness_ == nullptr || !is_patch(first + i);
      visit(first + i, dose_.hazard(work.densities[i], work.cosines[i]),
            is_sure ? 1.0F : clearness_->of(source(first + i), sensor));
    }
  }
}

Gain GainField::gain(const geometry::View& view) const {
  Gain gain;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for_each_sight(view, [&](std::size_t t, float hazard, float clearness) {
    const double area = targets_[t].weight * clearness * (1.0F - std::exp(-hazard));
    gain.area += area;
    if (is_patch(t)) gain.unseen += area;
    moment += area * targets_[t].position.cast<double>();
  });
  if (gain.area > 0.0) gain.centroid = (moment / gain.area).cast<float>();
  return gain;
}

std::vector<Sight> GainField::sights(const geometry::View& view) const {
  std::vector<Sight> sights;
  for_each_sight(view, [&](std::size_t t, float hazard, float clearness) {
    sights.push_back(
        {static_cast<std::uint32_t>(t), clearness * (1.0F - std::exp(-hazard)), clearness});
  });
  return sights;
}

std::vector<Look> GainField::looks(const geometry::View& view) const {
  std::vector<Look> looks;
  for_each_sight(view, [&](std::size_t t, float hazard, float /*clearness*/) {
    looks.push_back({static_cast<std::uint32_t>(t), hazard});
  });
  return looks;
}

Promise promise_of(const GainField& field, const DoseMap& map, std::vector<Sight> sights) {
  Promise promise{std::move(sights), map.surfels().hazards};
  for (const Sight& sight : promise.sights) {
    const double area = field.targets()[sight.target].weight * sight.covered_share;
    (field.is_patch(sight.target) ? promise.guessed : promise.seen) += area;
  }
  return promise;
}

void grade(const Promise& promise, const GainField& field, DoseMap& map, UnseenSurface& unseen,
           const SpaceMemory& space) {
  std::vector<UnseenSurface::Expected> patches;
  for (const Sight& sight : promise.sights) {
    const std::uint32_t source = field.source(sight.target);
    if (field.is_patch(sight.target)) {
      patches.push_back({source, sight.clearness});
      continue;
    }
    const float promised = -std::log(std::max(1.0F - sight.covered_share, 1e-3F));
    const float given = map.surfels().hazards[source] - promise.hazards[source];
    if (promised > least_promise && given < kept_promise * promised) {
      map.lower_trust(source, broken_trust);
    }
  }
  unseen.grade(patches, map, space, promise.surfels());
}

std::vector<BelievedPatch> believed_patches(const DoseMap& map, const GainField& field,
                                            std::span<const UnseenPatch> patches,
                                            std::span<const float> chances, float guess_yield) {
  constexpr float well_covered = 0.5F;  // more likely covered than not, and therefore not missing
  const Surfels& surfels = map.surfels();
  std::vector<BelievedPatch> believed;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    believed.push_back({surfels.positions[i], surfels.normals[i], surfels.areas[i],
                        surfels.covered_share(i), MissingReason::none});
  }
  for (std::size_t t = 0; t < field.targets().size(); ++t) {
    const std::uint32_t source = field.source(t);
    if (!field.is_patch(t)) {
      BelievedPatch& patch = believed[source];
      if (patch.covered_share >= well_covered) continue;
      patch.reason =
          chances[t] > 0.0F ? MissingReason::seen_too_thinly : MissingReason::unreachable;
    } else if (chances[t] > 0.0F) {
      const UnseenPatch& patch = patches[source];
      believed.push_back({patch.position, patch.normal, guess_yield * chances[t] * patch.weight,
                          0.0F, MissingReason::never_seen});
    }
  }
  return believed;
}

}  // namespace skycap::survey::skycap
