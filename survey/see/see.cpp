#include "survey/see/see.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/points/density.h"
#include "geometry/points/spaced_points.h"
#include "geometry/points/spatial_index.h"
#include "survey/see/deferred_frontiers.h"
#include "survey/see/free_space_test.h"
#include "survey/see/frontier.h"
#include "survey/see/nearest_views.h"
#include "survey/see/occlusion.h"
#include "survey/see/view_adjustment.h"
#include "survey/see/visibility_graph.h"
#include "survey/stopwatch.h"

namespace skycap::survey::see {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::ScanSpan;
using geometry::View;

struct SeePlanner::Impl {
  Impl(const SeeConfig& see_config, const geometry::Camera& sensor)
      : config(see_config),
        camera(sensor),
        placement{config.view_distance.value_or(geometry::view_distance(camera, config.density)),
                  config.min_height},
        map({.radius = config.resolution_radius,
             .core_threshold = config.effective_core_threshold(),
             .spacing = config.effective_spacing(),
             .rule = config.outlier_rule}),
        occluders(config.occluder_spacing, config.occluder_spacing),
        occlusion(map.index().grid(),
                  {.radius = config.occlusion_radius.value_or(config.resolution_radius),
                   .search_distance = config.occlusion_search_distance,
                   .end = config.march_end}),
        deferred(config.frontier_spacing) {}

  std::optional<View> update(const ScanSpan& scan);
  void insert(std::span<const Vector3f> points, const geometry::ImagePixels& image);
  void classify();
  void propose_for_new_frontiers();
  geometry::SurfaceFrame frame_at(std::uint32_t point) const;
  void adjust_target(std::span<const Vector3f> points);
  void avoid_occlusions();
  bool avoid_occlusion(std::uint32_t point, Frontier& frontier);
  void update_graph();
  bool sees(const Frontier& from, Frontier& to);
  double clear_offset(Frontier& frontier);
  std::optional<View> select();
  std::size_t nearest_proposal() const;
  void discard(std::uint32_t point);
  void discard_cluster(std::uint32_t point);
  void set_aside(std::uint32_t point);
  void list_proposals();

  const SeeConfig config;
  const geometry::Camera camera;
  const ViewPlacement placement;

  geometry::DensityMap map;
  geometry::SpacedPoints occluders;  // S: sparse subset of the cloud for the cap optimiser
  OcclusionTest occlusion;
  std::vector<View> scans;                  // view of each scan
  std::uint32_t first_new = 0;              // first point of the last scan
  std::optional<FreeSpaceTest> free_space;  // lines of sight of the last scan, if configured

  std::set<std::uint32_t>
      waiting;                 // frontiers without a proposal, because another one is too close
  FrontierMap frontiers;       // frontiers with a proposal
  DeferredFrontiers deferred;  // deferred frontiers that no proposal sees
  std::map<std::uint32_t, AttemptRecord> attempts;
  VisibilityGraph graph;
  std::optional<std::uint32_t> target;  // frontier of the last proposed view

  // Proposals as lists in the order of `frontiers`.
  std::vector<std::uint32_t> proposal_points;
  std::vector<Vector3d> proposal_positions;

  PlanningStep step;
  std::stop_token stop;
};

/// Performs one update in the order of the released code.
std::optional<View> SeePlanner::Impl::update(const ScanSpan& scan) {
  step.times.clear();
  Stopwatch stopwatch(step.times);
  std::vector<Vector3f> cropped;
  std::span<const Vector3f> points = scan.points;
  geometry::ImagePixels image{scan.pixels, static_cast<std::uint32_t>(camera.width())};
  if (config.scene_box) {
    cropped = points_inside(scan.points, *config.scene_box);
    points = cropped;
    image = {};
  }
  scans.push_back(geometry::to_view(scan.world_from_sensor));
  insert(points, image);
  stopwatch.lap("insert");
  classify();
  stopwatch.lap("classify");
  if (config.free_space_normals) free_space.emplace(points, scans.back().position);
  propose_for_new_frontiers();
  stopwatch.lap("frames");
  adjust_target(points);
  stopwatch.lap("controller");
  if (config.optimise_views) avoid_occlusions();
  stopwatch.lap("occlusion");
  if (config.visibility_graph) update_graph();
  stopwatch.lap("graph");
  std::optional<View> view = select();
  stopwatch.lap("select");
  step.frontiers = frontiers.size() + waiting.size() + deferred.size();
  return view;
}

void SeePlanner::Impl::insert(std::span<const Vector3f> points,
                              const geometry::ImagePixels& image) {
  first_new = static_cast<std::uint32_t>(map.cloud().size());
  map.insert(points, static_cast<std::uint32_t>(scans.size() - 1), config.threads, image);
  const auto& positions = map.cloud().positions;
  if (positions.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "the first scan contains no point of the scene; start from a view that sees it");
  }
  step.points_new = positions.size() - first_new;
  if (!config.optimise_views) return;
  for (std::size_t i = first_new; i < positions.size(); ++i) occluders.keep(positions[i]);
}

void SeePlanner::Impl::classify() {
  const geometry::DensityUpdate update = map.relabel(config.threads);
  for (const std::uint32_t point : update.lost_frontiers) {
    frontiers.erase(point);
    deferred.forget(point);
    waiting.erase(point);
  }
  waiting.insert(update.new_frontiers.begin(), update.new_frontiers.end());
  step.frontiers_resolved = update.lost_frontiers.size();
  step.target_resolved.reset();
  if (target) step.target_resolved = map.label(*target) != geometry::PointLabel::frontier;
}

// Creates proposals for waiting frontiers without a proposal within the frontier spacing.
void SeePlanner::Impl::propose_for_new_frontiers() {
  const auto& positions = map.cloud().positions;
  const bool spaced = config.frontier_spacing > 0.0;
  geometry::PointGrid occupied(spaced ? config.frontier_spacing : 1.0);
  if (spaced) {
    for (const auto& [point, frontier] : frontiers) occupied.insert(positions[point]);
  }
  for (auto next = waiting.begin(); next != waiting.end();) {
    const std::uint32_t point = *next;
    if (spaced && occupied.any_within(positions[point], config.frontier_spacing)) {
      ++next;
      continue;
    }
    if (spaced) occupied.insert(positions[point]);
    next = waiting.erase(next);
    const View& observer = scans[map.cloud().views[point]];
    Frontier frontier{.position = positions[point].cast<double>(),
                      .observed_from = observer.position,
                      .observed_along = observer.direction,
                      .frame = frame_at(point),
                      .view = {}};
    frontier.view = place_view(frontier.position, frontier.frame.normal, placement);
    frontiers.emplace(point, frontier);
  }
}

geometry::SurfaceFrame SeePlanner::Impl::frame_at(std::uint32_t point) const {
  const auto& positions = map.cloud().positions;
  const auto count =
      static_cast<std::size_t>(config.frame_neighbours.value_or(map.config().core_threshold));
  std::vector<Vector3f> neighbours;
  for (const geometry::Neighbour& near : map.index().nearest(positions[point], count)) {
    neighbours.push_back(positions[near.index]);
  }
  const Vector3d position = positions[point].cast<double>();
  geometry::SurfaceFrame frame =
      geometry::surface_frame(position, neighbours, scans[map.cloud().views[point]].position);
  // Flips a normal that points to the side that is not free (released code).
  if (free_space && free_space->is_free_behind(position, frame.normal, config.occluder_spacing,
                                               config.occlusion_search_distance)) {
    frame.normal = -frame.normal;
    frame.boundary = -frame.boundary;
  }
  return frame;
}

// Reactive part: adjusts the last view if its frontier is not resolved.
void SeePlanner::Impl::adjust_target(std::span<const Vector3f> points) {
  if (!target) return;
  const auto found = frontiers.find(*target);
  if (found == frontiers.end()) return;
  AttemptRecord& record = attempts[*target];
  const auto accepted = std::span(map.cloud().positions).subspan(first_new);
  const auto seen = config.adjustment_centroid == ScanCentroid::whole_scan ? points : accepted;
  const bool adjusted =
      !seen.empty() && !found->second.was_deferred && record.views < config.max_attempts &&
      adjust_view(found->second, record, centroid(seen), placement, config.adjustment);
  if (adjusted) return;
  discard_cluster(*target);
  if (frontiers.empty()) propose_for_new_frontiers();
}

// Proactive part (§III-B): handles the proposals nearest to the sensor, each independently.
void SeePlanner::Impl::avoid_occlusions() {
  std::set<std::uint32_t> checked;
  bool dropped = true;
  while (std::exchange(dropped, false)) {
    list_proposals();
    std::vector<std::uint32_t> unchecked;
    for (const std::size_t i :
         nearest_views(proposal_positions, scans.back().position, config.visibility_update_limit)) {
      if (checked.insert(proposal_points[i]).second) unchecked.push_back(proposal_points[i]);
    }
    std::vector<std::uint8_t> is_useful(unchecked.size());
    geometry::parallel_for(unchecked.size(), config.threads, [&](std::size_t i) {
      if (stop.stop_requested()) throw Interrupted();
      is_useful[i] = avoid_occlusion(unchecked[i], frontiers.at(unchecked[i])) ? 1 : 0;
    });
    for (std::size_t i = 0; i < unchecked.size(); ++i) {
      if (is_useful[i] != 0) continue;
      set_aside(unchecked[i]);
      dropped = true;
    }
    // Discarded frontiers allow proposals for the frontiers around them.
    if (dropped && !waiting.empty()) propose_for_new_frontiers();
  }
}

/// Moves an occluded view to the clearest direction. Returns false if it is still occluded there.
bool SeePlanner::Impl::avoid_occlusion(std::uint32_t point, Frontier& frontier) {
  if (frontier.was_deferred) return true;
  const double offset = clear_offset(frontier);
  if (!occlusion.is_occluded(frontier.position, offset, frontier.view.position)) return true;

  const Vector3d observing = (frontier.observed_from - frontier.position).normalized();
  const Vector3d centre = frontier.position + offset * observing;
  const std::vector<Vector3d> occluded = directions_to_near(
      occluders.grid(), map.cloud().positions[point], config.occlusion_search_distance, centre);
  const Vector3d known_clear =
      config.observing_direction == ObservingDirection::ray ? observing : -frontier.observed_along;
  const auto cap = geometry::clearest_direction(occluded, known_clear, config.cap);
  if (cap) frontier.view = place_view(frontier.position, cap->direction, placement);
  return config.still_occluded == StillOccluded::keep ||
         !occlusion.is_occluded(frontier.position, offset, frontier.view.position);
}

/// Returns zeta of a frontier, which depends only on the frontier and the cloud.
double SeePlanner::Impl::clear_offset(Frontier& frontier) {
  if (frontier.offset_scan_count != scans.size()) {
    frontier.offset_scan_count = scans.size();
    const Vector3d line = frontier.observed_from - frontier.position;
    const Vector3d direction = config.offset_line == OffsetLine::line_of_sight
                                   ? Vector3d(line.normalized())
                                   : frontier.frame.normal;
    frontier.clear_offset = occlusion.clear_offset(frontier.position, direction, line.norm());
  }
  return frontier.clear_offset;
}

void SeePlanner::Impl::update_graph() {
  list_proposals();
  graph.keep_only(proposal_points);
  const std::size_t limit = config.visibility_update_limit;
  const auto updated = nearest_views(proposal_positions, scans.back().position, limit);
  geometry::parallel_for(proposal_points.size(), config.threads,
                         [&](std::size_t i) { clear_offset(frontiers.at(proposal_points[i])); });
  std::vector<std::vector<std::uint32_t>> seen(updated.size());
  geometry::parallel_for(updated.size(), config.threads, [&](std::size_t i) {
    if (stop.stop_requested()) throw Interrupted();
    const std::size_t j = updated[i];
    const Frontier& from = frontiers.at(proposal_points[j]);
    for (const std::size_t k : nearest_views(proposal_positions, proposal_positions[j], limit)) {
      if (k != j && sees(from, frontiers.at(proposal_points[k]))) {
        seen[i].push_back(proposal_points[k]);
      }
    }
  });
  for (std::size_t i = 0; i < updated.size(); ++i) {
    graph.set_edges(proposal_points[updated[i]], std::move(seen[i]));
  }
}

/// Returns whether the view of a frontier sees another frontier.
bool SeePlanner::Impl::sees(const Frontier& from, Frontier& to) {
  const Vector3d& sensor = from.view.position;
  if (config.facing_test && to.frame.normal.dot(sensor - to.position) <= 0.0) return false;
  if (config.field_of_view_test &&
      !camera.project(geometry::camera_pose(from.view).inverse() * to.position)) {
    return false;
  }
  return !occlusion.is_occluded(to.position, clear_offset(to), sensor);
}

std::optional<View> SeePlanner::Impl::select() {
  list_proposals();
  if (proposal_points.empty()) {
    target.reset();
    return std::nullopt;
  }
  const bool keep_target = config.stay_on_target && target && frontiers.contains(*target);
  if (!keep_target) {
    std::size_t chosen = nearest_proposal();
    if (config.visibility_graph) {
      chosen = select_by_coverage(graph, proposal_points, proposal_positions, chosen,
                                  scans.back().position);
    }
    target = proposal_points[chosen];
  }
  ++attempts[*target].views;
  return frontiers.at(*target).view;
}

/// Returns the list index of the nearest proposal, which SEE selects.
std::size_t SeePlanner::Impl::nearest_proposal() const {
  const Vector3d& sensor = scans.back().position;
  if (config.nearest == NearestSearch::octree) {
    return approximately_nearest_view(proposal_positions, sensor, config.occlusion_search_distance);
  }
  return nearest_view(proposal_positions, sensor, scans.front().position, config.first_view_weight);
}

void SeePlanner::Impl::discard(std::uint32_t point) {
  map.discard(point);
  frontiers.erase(point);
}

/// Discards a frontier. If views are deferred, also discards the frontiers that it represents,
/// because they had the same views.
void SeePlanner::Impl::discard_cluster(std::uint32_t point) {
  discard(point);
  if (config.still_occluded != StillOccluded::deferred) return;
  const auto& positions = map.cloud().positions;
  std::vector<std::uint32_t> around = deferred.forget_around(positions[point].cast<double>());
  for (const std::uint32_t other : waiting) {
    const bool is_near = (positions[other] - positions[point]).norm() < config.frontier_spacing;
    if (is_near) around.push_back(other);
  }
  for (const std::uint32_t other : around) {
    waiting.erase(other);
    map.discard(other);
  }
}

/// Defers or discards a frontier whose view is not useful.
void SeePlanner::Impl::set_aside(std::uint32_t point) {
  const auto found = frontiers.find(point);
  const bool may_come_back =
      config.still_occluded == StillOccluded::deferred && !found->second.was_deferred;
  if (!may_come_back) return discard_cluster(point);
  deferred.add(frontiers.extract(found));
}

// Lists the proposals. If there are none, resumes the deferred frontiers.
void SeePlanner::Impl::list_proposals() {
  if (frontiers.empty()) deferred.requeue(placement, frontiers);
  proposal_points.clear();
  proposal_positions.clear();
  for (const auto& [point, frontier] : frontiers) {
    proposal_points.push_back(point);
    proposal_positions.push_back(frontier.view.position);
  }
}

SeePlanner::SeePlanner(const SeeConfig& config, const geometry::Camera& camera) {
  config.validate();
  impl_ = std::make_unique<Impl>(config, camera);
}
SeePlanner::~SeePlanner() = default;

std::optional<View> SeePlanner::next_view(const ScanSpan& scan) { return impl_->update(scan); }

void SeePlanner::stop_on(const std::stop_token& stop) { impl_->stop = stop; }

std::optional<View> SeePlanner::next_alternative_view() {
  if (impl_->target && impl_->frontiers.contains(*impl_->target)) {
    impl_->set_aside(*impl_->target);
    impl_->propose_for_new_frontiers();
    impl_->list_proposals();
    impl_->graph.keep_only(impl_->proposal_points);
  }
  return impl_->select();
}

const geometry::PointCloud& SeePlanner::cloud() const { return impl_->map.cloud(); }
geometry::PointCloud SeePlanner::take_cloud() { return impl_->map.take_cloud(); }
const PlanningStep& SeePlanner::last_step() const { return impl_->step; }
double SeePlanner::view_distance() const { return impl_->placement.distance; }

}  // namespace skycap::survey::see
