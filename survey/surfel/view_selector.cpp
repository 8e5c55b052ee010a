#include "survey/surfel/view_selector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "geometry/parallel.h"
#include "survey/planner.h"
#include "survey/surfel/view_batch.h"

namespace skycap::survey::surfel {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::View;

const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));

/// Tilt angles of the view directions of a cluster, relative to its normal [rad].
constexpr std::array<double, 5> tilts = {0.0, 0.54, 0.54, 0.94, 0.94};
/// Rotation angles of a view about its target in each refinement round [rad].
constexpr std::array<double, 4> turns = {0.35, 0.2, 0.1, 0.05};
constexpr int refined = 3;  // number of candidates refined per round
constexpr int turned_directions = 6;
constexpr std::size_t pool_size = 40;  // number of candidates for the batch
constexpr std::size_t max_frames = 3;  // maximum number of frames that represent a path
constexpr std::size_t max_line_frames =
    16;  // maximum for sensors that measure lines, whose frames are narrow

struct Candidate {
  View view;
  Gain gain;
};

struct Cluster {
  double weight = 0.0;
  Vector3d position = Vector3d::Zero();  // weighted sums
  Vector3d normal = Vector3d::Zero();
};

Vector3d tilted(const Vector3d& axis, double tilt, double azimuth) {
  const Vector3d u = geometry::any_orthogonal(axis), v = axis.cross(u);
  return std::cos(tilt) * axis + std::sin(tilt) * (std::cos(azimuth) * u + std::sin(azimuth) * v);
}

/// Groups targets by coarse cell and main axis of their normal. Returns the groups with the largest
/// weight first.
std::vector<Cluster> heaviest_clusters(const GainField& field, std::size_t count,
                                       int cells_across) {
  Eigen::AlignedBox3f box;
  for (const auto& target : field.targets()) box.extend(target.position);
  const float cell = std::max(box.sizes().maxCoeff() / static_cast<float>(cells_across), 1e-6F);
  // std::map, so that the order of equal weights does not depend on the platform.
  std::map<std::array<int, 4>, Cluster> clusters;
  for (const auto& target : field.targets()) {
    const Eigen::Vector3i at = ((target.position - box.min()) / cell).array().floor().cast<int>();
    Eigen::Index axis = 0;
    target.normal.cwiseAbs().maxCoeff(&axis);
    const int facing = 2 * static_cast<int>(axis) + (target.normal[axis] < 0.0F ? 1 : 0);
    Cluster& cluster = clusters[{at.x(), at.y(), at.z(), facing}];
    cluster.weight += target.weight;
    cluster.position += target.weight * target.position.cast<double>();
    cluster.normal += target.weight * target.normal.cast<double>();
  }
  std::vector<Cluster> sorted;
  for (const auto& entry : clusters) {
    if (entry.second.weight > 0.0) sorted.push_back(entry.second);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Cluster& a, const Cluster& b) { return a.weight > b.weight; });
  if (sorted.size() > count) sorted.resize(count);
  return sorted;
}

ViewGainCache::Key make_key(const View& view) {
  return {view.position.x(),  view.position.y(),  view.position.z(),
          view.direction.x(), view.direction.y(), view.direction.z()};
}

class ViewSelector {
 public:
  ViewSelector(const GainField& field, const ViewLimits& limits, const Admission& admits,
               const View& present, double max_path_length, const ViewSelectorSettings& settings,
               ViewGainCache& cache)
      : field_(field),
        limits_(limits),
        admits_(admits),
        present_(present),
        position_(present.position),
        max_path_length_(max_path_length),
        settings_(settings),
        cache_(cache) {}

  std::optional<Choice> choose() {
    propose_candidates();
    evaluate(0);
    for (int round = 0; round < settings_.refinements; ++round) refine(round);
    candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(),
                                     [](const Candidate& c) { return !(c.gain.area > 0.0); }),
                      candidates_.end());
    if (candidates_.empty()) return std::nullopt;

    double best_gain = 0.0;
    for (const Candidate& c : candidates_) {
      best_gain =
          std::max(best_gain, c.gain.area - (1.0 - settings_.prediction_yield) * c.gain.predicted);
    }
    const std::vector<std::size_t> pool = diverse_pool();
    std::vector<BatchView> views = seen_from(pool);
    if (settings_.counts_en_route) best_gain = best_en_route(views);
    const std::size_t first = find_first_batch_stop(views);
    Choice choice{candidates_[pool[first]].view, candidates_[pool[first]].gain.area,
                  views[first].visible_targets, best_gain,
                  std::vector<float>(field_.targets().size(), 0.0F)};
    for (const BatchView& view : views) {
      for (const VisibleTarget& visible_target : view.visible_targets) {
        float& chance = choice.chances[visible_target.target];
        chance = std::max(chance, visible_target.line_of_sight_probability);
      }
    }
    for (std::size_t i = 0; i < pool.size(); ++i) {
      cache_.pool.emplace(make_key(candidates_[pool[i]].view), std::move(views[i].visible_targets));
    }
    return choice;
  }

 private:
  void add_candidate(const Vector3d& target, const Vector3d& towards_view, double distance) {
    for (const double fraction : settings_.distances) {
      const auto view = limits_.make_target_view(target, towards_view, fraction * distance);
      if (!view || (view->position - position_).norm() > max_path_length_ || !admits_(*view)) {
        continue;
      }
      candidates_.push_back({*view, {}});
      return;
    }
  }

  void propose_candidates() {
    int turn = 0;
    for (const Cluster& cluster : heaviest_clusters(
             field_, static_cast<std::size_t>(settings_.clusters), settings_.cells_across)) {
      const Vector3d target = cluster.position / cluster.weight;
      const Vector3d normal = cluster.normal.norm() > 1e-6 * cluster.weight
                                  ? Vector3d(cluster.normal.normalized())
                                  : Vector3d::UnitZ();
      for (const double tilt : tilts) {
        add_candidate(target, tilted(normal, tilt, golden_angle * turn++), settings_.view_distance);
      }
    }
    Vector3d centroid = Vector3d::Zero();
    double weight = 0.0;
    for (const auto& target : field_.targets()) {
      centroid += target.weight * target.position.cast<double>();
      weight += target.weight;
    }
    if (weight <= 0.0) return;
    for (int i = 0; i < settings_.global_directions; ++i) {  // Fibonacci lattice on the sphere
      const double z = 1.0 - 2.0 * (i + 0.5) / settings_.global_directions;
      const double level = std::sqrt(1.0 - z * z);
      const double azimuth = golden_angle * i;
      add_candidate(centroid / weight, {level * std::cos(azimuth), level * std::sin(azimuth), z},
                    settings_.view_distance);
    }
  }

  void evaluate(std::size_t first) {
    std::vector<Candidate*> unknown;
    for (std::size_t i = first; i < candidates_.size(); ++i) {
      const auto known = cache_.gains.find(make_key(candidates_[i].view));
      if (known == cache_.gains.end()) {
        unknown.push_back(&candidates_[i]);
      } else {
        candidates_[i].gain = known->second;
      }
    }
    geometry::parallel_for(unknown.size(), settings_.threads, [&](std::size_t i) {
      if (settings_.stop.stop_requested()) return;
      unknown[i]->gain = field_.gain(unknown[i]->view);
    });
    if (settings_.stop.stop_requested()) throw Interrupted();
    for (const Candidate* asked : unknown) {
      cache_.gains.emplace(make_key(asked->view), asked->gain);
    }
  }

  /// Returns the weight of predicted gains relative to known surface. It is at most 1, because
  /// predictions that lead to larger surfaces are no reason to defer known surface.
  double prediction_weight() const { return std::min(1.0, settings_.prediction_yield); }

  double score(const Candidate& c) const {
    const double gain = c.gain.area - (1.0 - prediction_weight()) * c.gain.predicted;
    return gain / (settings_.view_price + (c.view.position - position_).norm());
  }

  /// Returns the indices of the candidates, best first.
  std::vector<std::size_t> ranking() const {
    std::vector<std::size_t> order(candidates_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return score(candidates_[a]) > score(candidates_[b]);
    });
    return order;
  }

  /// Rotates the best candidates about their target. In every other round, the target is the
  /// centroid of their gain.
  void refine(int round) {
    const std::size_t first = candidates_.size();
    const std::vector<std::size_t> order = ranking();
    const double turn =
        turns[std::min<std::size_t>(static_cast<std::size_t>(round), turns.size() - 1)];
    for (std::size_t k = 0; k < std::min<std::size_t>(refined, order.size()); ++k) {
      const Candidate best = candidates_[order[k]];
      const Vector3d gained = best.gain.centroid.cast<double>();
      const bool re_aims = round % 2 == 0 && best.gain.area > 0.0 &&
                           (best.view.position - gained).norm() > 1e-6 * settings_.view_distance;
      const Vector3d target =
          re_aims ? gained
                  : Vector3d(best.view.position + settings_.view_distance * best.view.direction);
      const Vector3d towards = re_aims ? Vector3d((best.view.position - gained).normalized())
                                       : Vector3d(-best.view.direction);
      // The gain of a view of a whole object is closer than the object centre at which the view is
      // aimed.
      const double distance =
          std::min(settings_.view_distance, (best.view.position - target).norm());
      for (int i = 0; i < turned_directions; ++i) {
        const double azimuth = 2.0 * std::numbers::pi * i / turned_directions;
        add_candidate(target, tilted(towards, turn, azimuth), distance);
      }
    }
    evaluate(first);
  }

  /// Returns the best candidates that differ from each other.
  std::vector<std::size_t> diverse_pool() const {
    std::vector<std::size_t> pool;
    for (const std::size_t i : ranking()) {
      const View& view = candidates_[i].view;
      const bool is_new = std::none_of(pool.begin(), pool.end(), [&](std::size_t j) {
        const View& other = candidates_[j].view;
        return (view.position - other.position).norm() < 0.15 * settings_.view_distance &&
               view.direction.dot(other.direction) > 0.97;
      });
      if (is_new) pool.push_back(i);
      if (pool.size() == pool_size) break;
    }
    return pool;
  }

  /// Returns the sights of the views in the pool. Reuses cached sights of the last selection.
  std::vector<BatchView> seen_from(const std::vector<std::size_t>& pool) {
    std::map<ViewGainCache::Key, std::vector<VisibleTarget>> known = std::exchange(cache_.pool, {});
    std::vector<BatchView> views(pool.size());
    geometry::parallel_for(pool.size(), settings_.threads, [&](std::size_t i) {
      const View& view = candidates_[pool[i]].view;
      const auto remembered = known.find(make_key(view));
      views[i] = {view.position, remembered == known.end() ? visible_targets_en_route(view)
                                                           : std::move(remembered->second)};
    });
    return views;
  }

  std::vector<VisibleTarget> visible_targets_en_route(const View& view) const {
    if (!settings_.sees_lines) {
      return visible_with_leg(field_, present_, view, settings_.frame_spacing);
    }
    return visible_along_lines(field_, present_, view, settings_.frame_spacing,
                               settings_.view_distance);
  }

  /// Returns the maximum gain of a view with its path, as defined in Choice.
  double best_en_route(const std::vector<BatchView>& views) const {
    double best = 0.0;
    for (const BatchView& view : views) {
      double gain = 0.0;
      for (const VisibleTarget& visible_target : view.visible_targets) {
        const double chance =
            field_.is_patch(visible_target.target) ? settings_.prediction_yield : 1.0;
        gain +=
            chance * field_.targets()[visible_target.target].weight * visible_target.covered_share;
      }
      best = std::max(best, gain);
    }
    return best;
  }

  /// Returns the index in `views` of the first stop of a batch.
  std::size_t find_first_batch_stop(const std::vector<BatchView>& views) const {
    std::vector<float> weights;
    const auto prediction = static_cast<float>(prediction_weight());
    for (std::size_t t = 0; t < field_.targets().size(); ++t) {
      weights.push_back(field_.targets()[t].weight * (field_.is_patch(t) ? prediction : 1.0F));
    }
    const BatchSettings batch{.size = static_cast<std::size_t>(settings_.batch),
                              .view_price = settings_.view_price};
    const std::vector<Stop> stops = pick_batch(views, std::move(weights), position_, batch);
    // Lines may sweep nothing on any path. In that case, the best single position is used.
    return stops.empty() ? 0 : stops[first_stop(views, stops, position_, batch.impatience)].view;
  }

  const GainField& field_;
  const ViewLimits& limits_;
  const Admission& admits_;
  const View present_;
  const Vector3d position_;
  const double max_path_length_;
  const ViewSelectorSettings& settings_;
  ViewGainCache& cache_;
  std::vector<Candidate> candidates_;
};

}  // namespace

std::vector<View> views_between(const View& from, const View& to, std::size_t count) {
  const auto yaw = [](const View& view) {
    return std::atan2(view.direction.y(), view.direction.x());
  };
  const auto pitch = [](const View& view) {
    return std::asin(std::clamp(view.direction.z(), -1.0, 1.0));
  };
  const double turn = std::remainder(yaw(to) - yaw(from), 2.0 * std::numbers::pi);
  std::vector<View> views;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double azimuth = yaw(from) + share * turn;
    const double elevation = pitch(from) + share * (pitch(to) - pitch(from));
    views.push_back({from.position + share * (to.position - from.position),
                     {std::cos(elevation) * std::cos(azimuth),
                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation)}});
  }
  return views;
}

namespace {

/// Combined sights of several observations.
class JointVisibility {
 public:
  explicit JointVisibility(std::size_t targets)
      : uncovered_(targets, 1.0F), line_of_sight_probability_(targets, 0.0F) {}

  void add(const std::vector<VisibleTarget>& seen, float times) {
    for (const VisibleTarget& visible_target : seen) {
      uncovered_[visible_target.target] *= std::pow(1.0F - visible_target.covered_share, times);
      line_of_sight_probability_[visible_target.target] =
          std::max(line_of_sight_probability_[visible_target.target],
                   visible_target.line_of_sight_probability);
    }
  }

  std::vector<VisibleTarget> all() const {
    std::vector<VisibleTarget> visible_targets;
    for (std::uint32_t t = 0; t < uncovered_.size(); ++t) {
      if (line_of_sight_probability_[t] == 0.0F)
        continue;  // unknown space that hides the target from one view may hide it from all
      visible_targets.push_back({t, std::min(1.0F - uncovered_[t], line_of_sight_probability_[t]),
                                 line_of_sight_probability_[t]});
    }
    return visible_targets;
  }

 private:
  std::vector<float> uncovered_, line_of_sight_probability_;
};

}  // namespace

std::vector<VisibleTarget> visible_with_leg(const GainField& field, const View& from,
                                            const View& to, double frame_spacing) {
  std::vector<VisibleTarget> visible_targets = field.visible_targets(to);
  if (!(frame_spacing > 0.0)) return visible_targets;
  const double frames = (to.position - from.position).norm() / frame_spacing;
  const auto looked_at = static_cast<std::size_t>(std::min<double>(max_frames, frames));
  if (looked_at == 0) return visible_targets;
  const auto standing_for = static_cast<float>(frames / static_cast<double>(looked_at));
  JointVisibility joint(field.targets().size());
  joint.add(visible_targets, 1.0F);
  for (const View& frame : views_between(from, to, looked_at)) {
    joint.add(field.visible_targets(frame), standing_for);
  }
  return joint.all();
}

std::vector<VisibleTarget> visible_along_lines(const GainField& field, const View& from,
                                               const View& to, double frame_spacing,
                                               double view_distance) {
  const Vector3d displacement = to.position - from.position;
  const auto looked_at = static_cast<std::size_t>(
      std::min<double>(max_line_frames, std::ceil(displacement.norm() / frame_spacing)));
  const double turn = std::remainder(std::atan2(to.direction.y(), to.direction.x()) -
                                         std::atan2(from.direction.y(), from.direction.x()),
                                     2.0 * std::numbers::pi);
  JointVisibility joint(field.targets().size());
  for (const View& frame : views_between(from, to, looked_at)) {
    // The nose is to the right of the lines, so that a left rotation moves them backwards.
    const Vector3d nose = Vector3d(frame.direction.y(), -frame.direction.x(), 0.0).normalized();
    const double swept = std::abs(displacement.dot(nose) - view_distance * turn);
    joint.add(field.visible_targets(frame),
              static_cast<float>(swept / frame_spacing / static_cast<double>(looked_at)));
  }
  return joint.all();
}

std::optional<Choice> choose_view(const GainField& field, const ViewLimits& limits,
                                  const Admission& admits, const View& present,
                                  double max_path_length, const ViewSelectorSettings& settings,
                                  ViewGainCache& cache) {
  return ViewSelector(field, limits, admits, present, max_path_length, settings, cache).choose();
}

}  // namespace skycap::survey::surfel
