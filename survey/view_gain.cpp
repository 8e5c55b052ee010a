#include "survey/view_gain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skycap::survey {
namespace {

using Eigen::Vector3f;

/// Surfels whose missing area is a smaller share of the largest one's are not worth a look each;
/// together they stay far below any stop rule.
constexpr float least_weight_share = 2e-3F;
constexpr float raster_spacing = 1.0F;  // pixel at the view distance, in units of h

/// Depths of the nearest surfels; reused between calls on one thread.
struct Raster {
  std::vector<float> depths, columns, rows, forward;
};

}  // namespace

GainField::GainField(const DoseMap& map, std::span<const UnseenPatch> patches,
                     const geometry::Camera& camera, const DoseModel& dose,
                     const GainSettings& settings)
    : dose_(dose),
      spacing_(map.spacing()),
      least_cosine_(std::cos(settings.most_incidence)),
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

  const Surfels& surfels = map.surfels();
  for (const Vector3f& p : surfels.positions) {
    x_.push_back(p.x());
    y_.push_back(p.y());
    z_.push_back(p.z());
  }
  const float least_weight = least_weight_share * spacing_ * spacing_;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const float weight = surfels.deficit(i) * surfels.trusts[i];
    if (weight < least_weight) continue;
    targets_.push_back({surfels.positions[i], surfels.normals[i], weight});
    sources_.push_back(static_cast<std::uint32_t>(i));
  }
  surfel_targets_ = targets_.size();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    targets_.push_back({patches[i].position, patches[i].normal, patches[i].weight});
    sources_.push_back(static_cast<std::uint32_t>(i));
  }
}

template <typename Visit>
void GainField::for_each_sight(const geometry::View& view, Visit visit) const {
  static thread_local Raster raster;
  const Eigen::Isometry3d world_from_camera = geometry::camera_pose(view);
  const Eigen::Matrix3f camera_from_world = world_from_camera.linear().transpose().cast<float>();
  const Vector3f position = view.position.cast<float>();
  const float focal = raster_focal_length_px_;
  const float centre_column = 0.5F * static_cast<float>(raster_width_);
  const float centre_row = 0.5F * static_cast<float>(raster_height_);

  // Project all surfels: plain arrays, so that the compiler vectorises.
  const std::size_t count = x_.size();
  raster.columns.resize(count);
  raster.rows.resize(count);
  raster.forward.resize(count);
  const Eigen::Matrix3f& m = camera_from_world;
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x_[i] - position.x(), dy = y_[i] - position.y(), dz = z_[i] - position.z();
    const float right = m(0, 0) * dx + m(0, 1) * dy + m(0, 2) * dz;
    const float down = m(1, 0) * dx + m(1, 1) * dy + m(1, 2) * dz;
    const float forward = m(2, 0) * dx + m(2, 1) * dy + m(2, 2) * dz;
    const float scale = focal / forward;
    raster.columns[i] = right * scale + centre_column;
    raster.rows[i] = down * scale + centre_row;
    raster.forward[i] = forward;
  }
  // A border of one pixel spares the splat its bounds checks.
  const int stride = raster_width_ + 2;
  raster.depths.assign(static_cast<std::size_t>(stride) * (raster_height_ + 2),
                       std::numeric_limits<float>::infinity());
  const float last_column = static_cast<float>(raster_width_),
              last_row = static_cast<float>(raster_height_);
  const auto pixel_of = [&](float column, float row) {
    return static_cast<std::size_t>(static_cast<int>(row) * stride + static_cast<int>(column));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const float column = raster.columns[i], row = raster.rows[i], forward = raster.forward[i];
    if (!(forward > 0.0F && column >= 0.0F && row >= 0.0F && column < last_column &&
          row < last_row)) {
      continue;
    }
    // The 2 x 2 pixels nearest to the point; index (0, 0) is the border.
    float* depth = &raster.depths[pixel_of(column + 0.5F, row + 0.5F)];
    depth[0] = std::min(depth[0], forward);
    depth[1] = std::min(depth[1], forward);
    depth[stride] = std::min(depth[stride], forward);
    depth[stride + 1] = std::min(depth[stride + 1], forward);
  }

  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const Target& target = targets_[t];
    const Vector3f offset = target.position - position;
    const float facing = -offset.dot(target.normal);
    if (facing <= 0.0F) continue;
    const Vector3f in_camera = camera_from_world * offset;
    const float forward = in_camera.z();
    if (!(forward >= least_range_ && forward <= most_range_) ||
        std::abs(in_camera.x()) > half_slope_.x() * forward ||
        std::abs(in_camera.y()) > half_slope_.y() * forward) {
      continue;
    }
    const float distance = offset.norm();
    const float cosine = facing / distance;
    if (cosine < least_cosine_) continue;
    const float scale = focal / forward;
    const float depth = raster.depths[pixel_of(in_camera.x() * scale + centre_column + 1.0F,
                                               in_camera.y() * scale + centre_row + 1.0F)];
    // A slanted surface hides itself by as much as it falls off over a splat.
    const float slope = std::sqrt(std::max(0.0F, 1.0F - cosine * cosine)) / cosine;
    const float tolerance =
        t < surfel_targets_ ? spacing_ * (1.5F + 2.0F * std::min(slope, 4.0F)) : spacing_;
    if (forward > depth + tolerance) continue;
    const float density =
        focal_length_px_.prod() * cosine * distance / (forward * forward * forward);
    visit(t, 1.0F - std::exp(-dose_.hazard(density, cosine)));
  }
}

Gain GainField::gain(const geometry::View& view) const {
  Gain gain;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for_each_sight(view, [&](std::size_t t, float share) {
    const double area = targets_[t].weight * share;
    gain.area += area;
    if (is_patch(t)) gain.unseen += area;
    moment += area * targets_[t].position.cast<double>();
  });
  if (gain.area > 0.0) gain.centroid = (moment / gain.area).cast<float>();
  return gain;
}

std::vector<Sight> GainField::sights(const geometry::View& view) const {
  std::vector<Sight> sights;
  for_each_sight(view, [&](std::size_t t, float share) {
    sights.push_back({static_cast<std::uint32_t>(t), share});
  });
  return sights;
}

}  // namespace skycap::survey
