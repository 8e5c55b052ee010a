#include "survey/volumetric/volumetric_gain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace skycap::survey::volumetric {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Entropy of unknown voxels, with occupancy 1/2.
constexpr double prior_entropy = 0.6931471805599453;  // ln 2

/// Returns whether 0.2 <= p <= 0.8, which includes the prior.
bool is_uncertain(const VoxelState& state) {
  return state.kind != VoxelKind::free && state.kind != VoxelKind::occupied;
}

/// Visibility of a voxel from the view: a product over the voxels in front of it.
class Visibility {
 public:
  explicit Visibility(VisibilityFactor factor) : factor_(factor) {}

  double weight() const { return weight_; }
  void pass(double occupancy) {
    weight_ *= factor_ == VisibilityFactor::occupancy ? occupancy : 1.0 - occupancy;
    if (weight_ < vanishing) weight_ = 0.0;  // avoids slow subnormal numbers
  }
  /// Returns the sum of the weights of `count` untouched voxels. Their factor is 1/2 for both
  /// settings.
  double pass_untouched(std::size_t count) {
    const double before = weight_;
    weight_ = std::ldexp(weight_, -static_cast<int>(std::min<std::size_t>(count, 2000)));
    if (weight_ < vanishing) weight_ = 0.0;
    return 2.0 * (before - weight_);
  }

 private:
  static constexpr double vanishing = 1e-290;
  VisibilityFactor factor_;
  double weight_ = 1.0;
};

/// The gains process the events of VolumetricMap::follow() ray by ray. If `only_surfaces` is true,
/// rays that hit nothing occupied are not counted.
class RearSideVoxelGain {
 public:
  static constexpr RayEvents ray_events = RayEvents::last_skipped;
  static constexpr bool only_surfaces = true;
  explicit RearSideVoxelGain(const GainSettings&, double) {}

  void begin_ray() { is_behind_uncertain_ = false; }
  bool may_miss(bool) const { return true; }
  bool pass(const VoxelState& state) {
    is_behind_uncertain_ = is_uncertain(state);  // an occupied voxel would have stopped the ray
    return true;
  }
  void finish(const VoxelState& state) {
    if (state.kind == VoxelKind::occupied && is_behind_uncertain_) total_ += 1.0;
  }
  double total() const { return total_; }

 private:
  bool is_behind_uncertain_ = false;
  double total_ = 0.0;
};

class RearSideEntropyGain {
 public:
  static constexpr RayEvents ray_events = RayEvents::every_voxel;
  static constexpr bool only_surfaces = true;
  explicit RearSideEntropyGain(const GainSettings& settings, double) : settings_(settings) {}

  void begin_ray() {
    visibility_ = Visibility(settings_.visibility);
    run_ = 0.0;
    is_in_run_ = false;
  }
  bool pass_untouched(std::size_t count) {
    run_ += visibility_.pass_untouched(count) * prior_entropy;
    is_in_run_ = true;
    return true;
  }
  bool pass(const VoxelState& state) {
    is_in_run_ = is_uncertain(state);
    run_ = is_in_run_ ? run_ + visibility_.weight() * state.entropy : 0.0;
    visibility_.pass(state.occupancy);
    return true;
  }
  void finish(const VoxelState& state) {
    if (state.kind != VoxelKind::occupied) return;
    if (settings_.rear_side_end == RearSideEnd::behind_uncertain && !is_in_run_) return;
    total_ += run_ + visibility_.weight() * state.entropy;
  }
  double total() const { return total_; }

 private:
  GainSettings settings_;
  Visibility visibility_{VisibilityFactor::occupancy};
  double run_ = 0.0;  // sum over the uncertain voxels directly before the current one
  bool is_in_run_ = false;
  double total_ = 0.0;
};

/// Gain of OA, or of UV if only uncertain voxels count.
template <bool only_uncertain>
class VisibleEntropyGain {
 public:
  static constexpr RayEvents ray_events = RayEvents::every_voxel;
  static constexpr bool only_surfaces = false;
  explicit VisibleEntropyGain(const GainSettings& settings, double) : settings_(settings) {}

  void begin_ray() {
    visibility_ = Visibility(settings_.visibility);
    ray_ = 0.0;
  }
  bool pass_untouched(std::size_t count) {
    ray_ += visibility_.pass_untouched(count) * prior_entropy;
    return go_on();
  }
  bool pass(const VoxelState& state) {
    add(state);
    visibility_.pass(state.occupancy);
    return go_on();
  }
  void finish(const VoxelState& state) {
    add(state);
    total_ += ray_;
  }
  double total() const { return total_; }

 private:
  /// Returns whether to continue the ray. The rest is at most ln 2 times a geometric series with
  /// factors of up to 0.88. The ray ends when it cannot change the sum.
  bool go_on() {
    constexpr double max_remaining = prior_entropy / (1.0 - 0.88);
    if (visibility_.weight() * max_remaining > 1e-17 * ray_) return true;
    total_ += ray_;
    return false;
  }
  void add(const VoxelState& state) {
    if (!only_uncertain || is_uncertain(state)) ray_ += visibility_.weight() * state.entropy;
  }

  GainSettings settings_;
  Visibility visibility_{VisibilityFactor::occupancy};
  double ray_ = 0.0;
  double total_ = 0.0;
};

class ProximityCountGain {
 public:
  static constexpr RayEvents ray_events = RayEvents::only_its_end;
  static constexpr bool only_surfaces = false;
  explicit ProximityCountGain(const GainSettings&, double max_shadow) : max_shadow_(max_shadow) {}

  void begin_ray() {}
  bool may_miss(bool has_shadows) const { return !has_shadows; }
  bool pass(const VoxelState& state) {
    if (state.kind == VoxelKind::shadowed) total_ += max_shadow_ - state.shadow_depth;
    return true;
  }
  void finish(const VoxelState& state) { pass(state); }
  double total() const { return total_; }

 private:
  double max_shadow_;
  double total_ = 0.0;
};

class AreaFactorGain {
 public:
  static constexpr RayEvents ray_events = RayEvents::last_skipped;
  static constexpr bool only_surfaces = false;
  explicit AreaFactorGain(const GainSettings& settings, double) : share_(settings.area_share) {}

  void begin_ray() { is_from_free_ = true; }
  bool may_miss(bool has_shadows) const { return !has_shadows && !nothing_known_yet_; }
  bool pass(const VoxelState& state) {
    switch (state.kind) {
      case VoxelKind::untouched:
        is_from_free_ = nothing_known_yet_;
        return true;
      case VoxelKind::shadowed:
        ++shadowed_;
        return false;
      case VoxelKind::occupied:
        nothing_known_yet_ = false;
        if (is_from_free_) ++occupied_;
        return false;
      case VoxelKind::free:
      case VoxelKind::uncertain:
        break;
    }
    nothing_known_yet_ = false;
    is_from_free_ = state.kind == VoxelKind::free;
    return true;
  }
  void finish(const VoxelState& state) {
    if (pass(state)) ++unobserved_;
  }
  double total() const {
    const double votes =
        occupied_ + shadowed_ + (share_ == AreaShare::all_rays ? unobserved_ : 0.0);
    if (votes == 0.0) return 0.0;
    return area_reward(occupied_ / votes, 0.2) + area_reward(shadowed_ / votes, 0.8);
  }

 private:
  AreaShare share_;
  bool is_from_free_ = true;
  bool nothing_known_yet_ = true;  // for the whole view: rays depend on the preceding rays
  double occupied_ = 0.0, shadowed_ = 0.0, unobserved_ = 0.0;
};

class AverageEntropyGain {
 public:
  static constexpr RayEvents ray_events = RayEvents::every_voxel;
  static constexpr bool only_surfaces = true;
  explicit AverageEntropyGain(const GainSettings&, double) {}

  void begin_ray() { ray_ = ray_voxels_ = 0.0; }
  bool pass_untouched(std::size_t count) {
    ray_ += static_cast<double>(count) * prior_entropy;
    ray_voxels_ += static_cast<double>(count);
    return true;
  }
  bool pass(const VoxelState& state) {
    ray_ += state.entropy;
    ray_voxels_ += 1.0;
    return true;
  }
  void finish(const VoxelState& state) {
    if (state.kind != VoxelKind::occupied) return;
    pass(state);
    entropy_ += ray_;
    voxels_ += ray_voxels_;
  }
  double total() const { return voxels_ > 0.0 ? entropy_ / voxels_ : 0.0; }

 private:
  double ray_ = 0.0, ray_voxels_ = 0.0;
  double entropy_ = 0.0, voxels_ = 0.0;
};

/// Fast test whether a ray ends on an occupied voxel.
class OccupiedEnd {
 public:
  static constexpr RayEvents ray_events = RayEvents::only_its_end;
  bool may_miss(bool) const { return true; }
  bool pass(const VoxelState&) { return true; }
  void finish(const VoxelState& state) { is_met_ = state.kind == VoxelKind::occupied; }
  bool is_met() const { return is_met_; }

 private:
  bool is_met_ = false;
};

/// Returns the distance at which a ray leaves the box, or a negative value if it does not intersect
/// the box.
double far_end(const Eigen::AlignedBox3d& box, const Vector3d& origin, const Vector3d& direction) {
  double nearest = 0.0, farthest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    // A direction of zero gives infinities with the correct signs.
    const double a = (box.min()[axis] - origin[axis]) / direction[axis];
    const double b = (box.max()[axis] - origin[axis]) / direction[axis];
    nearest = std::max(nearest, std::min(a, b));
    farthest = std::min(farthest, std::max(a, b));
  }
  return nearest <= farthest ? farthest : -1.0;
}

template <typename Gain>
double compute_gain(const VolumetricMap& map, const geometry::View& view,
                    const std::vector<Vector3d>& directions, double depth,
                    const GainSettings& settings) {
  const Eigen::Matrix3d world_from_camera = geometry::camera_pose(view).linear();
  const Vector3f origin = view.position.cast<float>();
  Eigen::AlignedBox3d surface = map.surface_box();
  if (!surface.isEmpty()) {  // margin of one voxel for rounding errors
    surface.min().array() -= map.resolution();
    surface.max().array() += map.resolution();
  }
  Gain gain(settings, map.max_shadow());
  for (const Vector3d& in_camera : directions) {
    const Vector3d direction = world_from_camera * in_camera;
    const Vector3f end = (view.position + depth * direction).cast<float>();
    double reach = std::numeric_limits<double>::infinity();
    if (Gain::only_surfaces) {
      reach = surface.isEmpty() ? -1.0 : far_end(surface, view.position, direction);
      if (reach < 0.0) continue;
    }
    if (Gain::only_surfaces &&
        Gain::ray_events == RayEvents::every_voxel) {  // the fast test avoids useless slow rays
      OccupiedEnd surface_end;
      map.follow(origin, end, reach, surface_end);
      if (!surface_end.is_met()) continue;
    }
    gain.begin_ray();
    map.follow(origin, end, reach, gain);
  }
  return gain.total();
}

}  // namespace

std::vector<Vector3d> ray_directions(const geometry::Camera& camera, const RayPattern& pattern) {
  const auto pixels = [&](int size) {
    constexpr double rounding = 1e-9;
    const double extent = (pattern.window_end - pattern.window_begin) * size;
    const auto count = static_cast<int>(extent * pattern.rays_per_pixel + rounding) + 1;
    std::vector<double> chosen;
    for (int i = 0; i < count; ++i) {
      const double pixel_position = pattern.window_begin * size + i / pattern.rays_per_pixel;
      chosen.push_back(std::trunc(pixel_position + rounding));
    }
    return chosen;
  };
  std::vector<Vector3d> directions;
  for (const double column : pixels(camera.width())) {
    for (const double row : pixels(camera.height())) {
      directions.push_back(camera.ray({column, row}).normalized());
    }
  }
  return directions;
}

double area_reward(double x, double target_area) {
  // Position between the nearer end of [0, 1] and the target fraction.
  const double r = x <= target_area ? x / target_area : (1.0 - x) / (1.0 - target_area);
  return r * r * (3.0 - 2.0 * r);
}

double information_gain(VolumetricMetric metric, const VolumetricMap& map,
                        const geometry::View& view, const std::vector<Vector3d>& directions,
                        double depth, const GainSettings& settings) {
  const auto gain = [&]<typename Gain>() {
    return compute_gain<Gain>(map, view, directions, depth, settings);
  };
  switch (metric) {
    case VolumetricMetric::rear_side_voxel:
      return gain.operator()<RearSideVoxelGain>();
    case VolumetricMetric::rear_side_entropy:
      return gain.operator()<RearSideEntropyGain>();
    case VolumetricMetric::occlusion_aware:
      return gain.operator()<VisibleEntropyGain<false>>();
    case VolumetricMetric::unobserved_voxel:
      return gain.operator()<VisibleEntropyGain<true>>();
    case VolumetricMetric::proximity_count:
      return gain.operator()<ProximityCountGain>();
    case VolumetricMetric::area_factor:
      return gain.operator()<AreaFactorGain>();
    case VolumetricMetric::average_entropy:
      break;
  }
  return gain.operator()<AverageEntropyGain>();
}

}  // namespace skycap::survey::volumetric
