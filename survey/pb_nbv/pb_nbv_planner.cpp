#include "survey/pb_nbv/pb_nbv_planner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/random_numbers.h"
#include "geometry/requirement.h"
#include "survey/kept_points.h"
#include "survey/pb_nbv/candidate_views.h"
#include "survey/pb_nbv/mixture.h"
#include "survey/pb_nbv/voxel_labels.h"
#include "survey/stopwatch.h"

namespace skycap::survey::pb_nbv {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3i;
using geometry::ScanSpan;
using geometry::View;

constexpr double ray_spacing = 0.005;       // at unit depth
constexpr double released_ray_depth = 1.0;  // reach of a ray into the box in the released code [m]
constexpr double image_scale = 1.0 / 8.0;   // of the image at which scores are counted

/// Returns the corners of voxels that can be corners of their convex hull: the outermost ones along
/// every grid line.
std::vector<Vector3d> outer_corners(std::span<const Vector3i> voxels, double voxel) {
  std::vector<Vector3i> corners;
  for (const Vector3i& index : voxels) {
    for (int corner = 0; corner < 8; ++corner) {
      corners.push_back(index + Vector3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1));
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    std::map<std::array<int, 2>, std::array<int, 2>> ends;  // of each grid line along the axis
    const auto line = [axis](const Vector3i& at) {
      return std::array<int, 2>{at[(axis + 1) % 3], at[(axis + 2) % 3]};
    };
    for (const Vector3i& at : corners) {
      const auto [found, is_new] =
          ends.try_emplace(line(at), std::array<int, 2>{at[axis], at[axis]});
      if (is_new) continue;
      found->second[0] = std::min(found->second[0], at[axis]);
      found->second[1] = std::max(found->second[1], at[axis]);
    }
    std::erase_if(corners, [&](const Vector3i& at) {
      const auto& [low, high] = ends.at(line(at));
      return at[axis] != low && at[axis] != high;
    });
  }
  std::ranges::sort(corners, [](const Vector3i& a, const Vector3i& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  std::vector<Vector3d> points;
  for (const Vector3i& at : corners) points.push_back(voxel * at.cast<double>());
  return points;
}

ScoreImage make_image(const geometry::Camera& camera) {
  ScoreImage image;
  image.width = std::max(1, static_cast<int>(std::lround(image_scale * camera.width())));
  image.height = std::max(1, static_cast<int>(std::lround(image_scale * camera.height())));
  const Eigen::Vector2d scale(static_cast<double>(image.width) / camera.width(),
                              static_cast<double>(image.height) / camera.height());
  const Eigen::Vector2d focal = camera.focal_length_px().cwiseProduct(scale);
  // Pixel centres are integers, so that the corner of the image is at -0.5.
  const Eigen::Vector2d centre =
      (camera.principal_point_px().array() + 0.5).matrix().cwiseProduct(scale).array() - 0.5;
  image.calibration << focal.x(), 0.0, centre.x(), 0.0, focal.y(), centre.y(), 0.0, 0.0, 1.0;
  return image;
}

double azimuth(const Vector3d& direction) { return std::atan2(direction.y(), direction.x()); }

}  // namespace

void PbNbvConfig::validate() const {
  constexpr const char* length = "a positive number of metres";
  const auto is_length = [](double value) { return std::isfinite(value) && value > 0.0; };
  require(settings.candidates >= 1, "pb_nbv.candidates", static_cast<double>(settings.candidates),
          "at least 1");
  require(settings.parallels >= 2, "pb_nbv.parallels", static_cast<double>(settings.parallels),
          "at least 2");
  require(settings.sectors >= 1, "pb_nbv.sectors", static_cast<double>(settings.sectors),
          "at least 1");
  require(std::isfinite(settings.growth) && settings.growth >= 0.0, "pb_nbv.growth",
          settings.growth, "zero or a positive number of voxels");
  require(is_length(settings.voxel.value_or(1.0)), "pb_nbv.voxel", settings.voxel.value_or(1.0),
          length);
  require(is_length(working_distance()), "pb_nbv.working_distance", working_distance(), length);
  require(std::isfinite(spacing) && spacing >= 0.0, "spacing", spacing,
          "zero or a positive number of metres");
}

double compute_score(std::span<const ScoredEllipsoid> ellipsoids, const View& view,
                     const ScoreImage& image, Reading reading) {
  const Eigen::Isometry3d camera_from_world = geometry::camera_pose(view).inverse();
  std::vector<double> depths;
  for (const ScoredEllipsoid& scored : ellipsoids) {
    depths.push_back((camera_from_world * scored.ellipsoid.centre).z());
  }
  std::vector<std::size_t> order(ellipsoids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return depths[i]; });
  std::vector<std::size_t> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
  // The released code uses the order as if it were the rank.
  const std::vector<std::size_t>& exponent = reading == Reading::released ? order : rank;
  double score = 0.0;
  for (std::size_t i = 0; i < ellipsoids.size(); ++i) {
    const std::size_t pixels =
        count_pixels(ellipsoids[i].ellipsoid, camera_from_world, image, reading);
    const double weighted = std::ldexp(static_cast<double>(pixels), -static_cast<int>(exponent[i]));
    score += ellipsoids[i].is_frontier ? weighted : -weighted;
  }
  return score;
}

struct PbNbvPlanner::Impl {
  Impl(const PbNbvConfig& given, const geometry::Camera& sensor)
      : config(given),
        camera(sensor),
        image(make_image(sensor)),
        kept(config.spacing, config.scene_box),
        labels(config.settings.voxel.value_or(1.0)),
        directions(make_candidate_directions(config.settings)),
        is_taken(directions.size(), false),
        random(config.seed) {}

  void begin(const ScanSpan& scan);
  void insert(const ScanSpan& scan);
  void insert_rays(const ScanSpan& scan);
  void grow_box(const std::vector<Vector3i>& frontiers);
  void add_ellipsoids(const std::vector<Vector3i>& voxels, bool is_frontier);
  void score();
  std::optional<View> choose();
  View candidate(std::size_t number) const;

  PbNbvConfig config;
  geometry::Camera camera;
  ScoreImage image;
  KeptPoints kept;
  VoxelLabels labels;
  AlignedBox3d box;
  std::vector<Vector3d> directions;  // of the candidates, from the centre of the box
  std::vector<char> is_taken;        // by candidate; a visited or rejected view is not repeated
  std::optional<SectorRule> sectors, sectors_before;
  std::vector<ScoredEllipsoid> ellipsoids;
  std::vector<double> scores;
  std::vector<char> is_rejected;  // by candidate, since the last scan
  geometry::RandomNumbers random;
  PlanningStep step;
  std::stop_token stop;
};

PbNbvPlanner::PbNbvPlanner(const PbNbvConfig& config, const geometry::Camera& camera)
    : impl_((config.validate(), std::make_unique<Impl>(config, camera))) {}

PbNbvPlanner::~PbNbvPlanner() = default;

void PbNbvPlanner::stop_on(const std::stop_token& stop) { impl_->stop = stop; }
const geometry::PointCloud& PbNbvPlanner::cloud() const { return impl_->kept.cloud(); }
geometry::PointCloud PbNbvPlanner::take_cloud() { return impl_->kept.take(); }
const PlanningStep& PbNbvPlanner::last_step() const { return impl_->step; }

std::optional<View> PbNbvPlanner::next_view(const ScanSpan& scan) {
  Impl& impl = *impl_;
  impl.step = {};
  Stopwatch stopwatch(impl.step.times);
  const bool is_first = impl.kept.scans() == 0;
  impl.step.points_new = impl.kept.add(scan);
  if (impl.kept.cloud().positions.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "the first scan contains no point of the scene; start from a view that sees it, or "
                "enlarge planner.scene_box");
  }
  if (is_first) impl.begin(scan);
  impl.insert(scan);
  stopwatch.lap("insert");
  const std::vector<Vector3i> frontiers = impl.labels.frontiers();
  impl.step.frontiers = frontiers.size();
  impl.grow_box(frontiers);
  if (impl.config.settings.max_ellipsoids > 0) {
    impl.ellipsoids.clear();
    impl.add_ellipsoids(impl.labels.with_label(Label::occupied), false);
    impl.add_ellipsoids(frontiers, true);
  }
  stopwatch.lap("ellipsoids");
  impl.score();
  stopwatch.lap("score");
  impl.is_rejected.assign(impl.directions.size(), 0);
  impl.sectors_before = impl.sectors;
  return impl.choose();
}

std::optional<View> PbNbvPlanner::next_alternative_view() {
  impl_->sectors = impl_->sectors_before;
  return impl_->choose();
}

/// Derives the voxel size and the box from the first scan.
void PbNbvPlanner::Impl::begin(const ScanSpan& scan) {
  AlignedBox3d measured;
  for (const Eigen::Vector3f& point : scan.points) {
    if (kept.contains(point)) measured.extend(point.cast<double>());
  }
  // PB-NBV's 0.03 m for objects of about 0.5 m.
  constexpr double voxel_per_edge = 0.06, min_voxel = 1e-4;
  const double longest = measured.sizes().maxCoeff();
  labels =
      VoxelLabels(config.settings.voxel.value_or(std::max(voxel_per_edge * longest, min_voxel)));
  for (const Eigen::Vector3f& point : scan.points) {
    if (!kept.contains(point)) continue;
    const Vector3d corner = labels.voxel() * labels.index(point.cast<double>()).cast<double>();
    box.extend(corner);
    box.extend(Vector3d(corner.array() + labels.voxel()));
  }
  if (config.reading == Reading::published) {
    // The far side is unobserved: the box is doubled in the direction of the view.
    const Vector3d axis = scan.world_from_sensor.linear().col(2), sizes = box.sizes();
    for (int i = 0; i < 3; ++i) {
      (axis[i] >= 0.0 ? box.max()[i] : box.min()[i]) += axis[i] >= 0.0 ? sizes[i] : -sizes[i];
    }
  }
  sectors.emplace(config.settings.sectors, azimuth(scan.sensor_position() - box.center()));
}

void PbNbvPlanner::Impl::insert(const ScanSpan& scan) {
  for (const Eigen::Vector3f& point : scan.points) {
    if (kept.contains(point)) labels.set(labels.index(point.cast<double>()), Label::occupied);
  }
  insert_rays(scan);
}

void PbNbvPlanner::Impl::insert_rays(const ScanSpan& scan) {
  const Vector3d origin = scan.sensor_position();
  const Vector3d low = camera.ray({-0.5, -0.5});
  const Vector3d high = camera.ray({camera.width() - 0.5, camera.height() - 0.5});
  for (double y = low.y(); y <= high.y(); y += ray_spacing) {
    if (stop.stop_requested()) throw Interrupted();
    for (double x = low.x(); x <= high.x(); x += ray_spacing) {
      const Vector3d direction = scan.world_from_sensor.linear() * Vector3d(x, y, 1.0);
      RayInterval interval = clip_ray(origin, direction, box);
      if (interval.begin > interval.end) continue;
      if (config.reading == Reading::released) {
        interval.end = interval.begin + released_ray_depth / direction.norm();
      }
      interval.end = std::min(interval.end, camera.config().max_range);
      labels.insert_ray(origin, direction, interval);
    }
  }
}

void PbNbvPlanner::Impl::grow_box(const std::vector<Vector3i>& frontiers) {
  box.setEmpty();
  for (const Label label : {Label::occupied, Label::unknown}) {
    for (const Vector3i& index : labels.with_label(label)) {
      const Vector3d corner = labels.voxel() * index.cast<double>();
      box.extend(corner);
      box.extend(Vector3d(corner.array() + labels.voxel()));
    }
  }
  const double radius = config.settings.growth * labels.voxel();
  for (const Vector3i& index : frontiers) {
    box.extend(Vector3d(labels.centre(index).array() - radius));
    box.extend(Vector3d(labels.centre(index).array() + radius));
  }
}

void PbNbvPlanner::Impl::add_ellipsoids(const std::vector<Vector3i>& voxels, bool is_frontier) {
  std::vector<Vector3d> centres;
  for (const Vector3i& index : voxels) centres.push_back(labels.centre(index));
  constexpr std::uint64_t frontier_stream = 0x66726f6e74696572;
  const std::uint64_t seed = config.seed ^ (is_frontier ? frontier_stream : 0);
  const Clusters clusters =
      find_clusters(centres, labels.voxel(), config.settings.max_ellipsoids, config.reading, seed);
  for (std::size_t cluster = 0; cluster < clusters.count; ++cluster) {
    if (stop.stop_requested()) throw Interrupted();
    std::vector<Vector3i> members;
    std::vector<Vector3d> points;
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      if (clusters.component[i] != cluster) continue;
      members.push_back(voxels[i]);
      points.push_back(centres[i]);
    }
    if (config.reading == Reading::published) points = outer_corners(members, labels.voxel());
    if (const auto ellipsoid = enclose(points)) ellipsoids.push_back({*ellipsoid, is_frontier});
  }
}

View PbNbvPlanner::Impl::candidate(std::size_t number) const {
  const double radius = config.working_distance() + 0.5 * box.diagonal().norm();
  return {box.center() + radius * directions[number], -directions[number]};
}

void PbNbvPlanner::Impl::score() {
  scores.assign(directions.size(), 0.0);
  if (config.settings.max_ellipsoids == 0) {
    for (double& value : scores) value = random.uniform();
    return;
  }
  geometry::parallel_for(scores.size(), config.threads, [&](std::size_t i) {
    if (stop.stop_requested()) throw Interrupted();
    scores[i] = compute_score(ellipsoids, candidate(i), image, config.reading);
  });
}

std::optional<View> PbNbvPlanner::Impl::choose() {
  const bool may_repeat = config.reading == Reading::released;
  for (;;) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < scores.size(); ++i) {
      if (is_rejected[i] != 0 || (is_taken[i] != 0 && !may_repeat)) continue;
      if (!sectors->admits(sectors->sector(azimuth(directions[i])))) continue;
      if (best && scores[i] <= scores[*best]) continue;
      if (config.limits.allow(candidate(i))) best = i;
    }
    if (best) {
      is_taken[*best] = is_rejected[*best] = 1;
      sectors->visit(sectors->sector(azimuth(directions[*best])));
      return candidate(*best);
    }
    if (sectors->is_complete()) return std::nullopt;
    sectors->skip();
  }
}

}  // namespace skycap::survey::pb_nbv
