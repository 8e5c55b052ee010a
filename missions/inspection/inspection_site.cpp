#include "missions/inspection/inspection_site.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <unordered_set>
#include <utility>

#include "flight/clearance/prior_obstacle.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/surfaces/sight_lines.h"
#include "missions/config/mission_document.h"
#include "missions/site_data/site_priors.h"
#include "survey/photo/target_samples.h"

namespace skycap::missions::inspection {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Structures with more points than this use a larger spacing, because the search keeps the points
/// in range of each position in memory.
constexpr std::size_t max_points = 150'000;
constexpr std::size_t max_obstacle_points = 500'000;

using Voxel = std::array<std::int64_t, 3>;

struct VoxelHash {
  std::size_t operator()(const Voxel& voxel) const {
    std::uint64_t hash = 0;
    for (const std::int64_t index : voxel) {
      // The finalizer of MurmurHash3 spreads neighbouring indices.
      hash ^= static_cast<std::uint64_t>(index);
      hash ^= hash >> 33U;
      hash *= 0xff51afd7ed558ccdULL;
      hash ^= hash >> 33U;
    }
    return static_cast<std::size_t>(hash);
  }
};

/// Returns the first point of each voxel, in the order of the points.
std::vector<Vector3f> downsampled(const std::vector<Vector3f>& points, double voxel) {
  std::unordered_set<Voxel, VoxelHash> used;
  std::vector<Vector3f> result;
  for (const Vector3f& point : points) {
    const auto cell = [&](int axis) {
      return static_cast<std::int64_t>(std::floor(static_cast<double>(point[axis]) / voxel));
    };
    if (used.insert({cell(0), cell(1), cell(2)}).second) result.push_back(point);
  }
  return result;
}

/// Downsamples with the smallest voxel, at least `voxel`, that leaves at most `max_count` points.
std::vector<Vector3f> downsampled_to(const std::vector<Vector3f>& points, double voxel,
                                     std::size_t max_count) {
  constexpr double coarser = 1.25;
  std::vector<Vector3f> result = downsampled(points, voxel);
  while (result.size() > max_count) result = downsampled(points, voxel *= coarser);
  return result;
}

}  // namespace

InspectionSpace::InspectionSpace(const config::MissionSetup& setup)
    : flight_(setup.flight()), limits_(setup.survey().planner.limits) {
  const config::MissionDocument& document = *setup.document;
  if (document.inspection.cloud) {
    std::filesystem::path file = *document.inspection.cloud;
    if (file.is_relative()) file = std::filesystem::path(document.file).parent_path() / file;
    add_cloud(setup, file);
  } else {
    add_targets(setup);
  }
  space_ = std::make_unique<const flight::KnownSpace>(flight_.rules());
}

void InspectionSpace::add_cloud(const config::MissionSetup& setup,
                                const std::filesystem::path& file) {
  const std::vector<Vector3f> points = geometry::read_cloud(file).positions;
  const double spacing = setup.document->inspection.spacing.value();
  points_ = downsampled_to(points, spacing, max_points);
  // The clearance is kept from as many points as possible, so that the gaps between them are small.
  constexpr double finer = 0.1;
  const survey::inspection::StructureCloud cloud = survey::inspection::make_structure_cloud(
      downsampled_to(points, finer * spacing, max_obstacle_points));
  flight::PriorObstacleConfig obstacle;
  obstacle.name = "the structure " + file.filename().string();
  obstacle.points = cloud.points;
  // A spot of the surface is farther from all points than the median disc radius with a
  // probability of exp(-6), if the points are random.
  obstacle.point_radius = static_cast<double>(cloud.median_radius);
  flight_.airspace.priors.push_back(std::make_shared<const flight::PriorObstacle>(obstacle));
}

void InspectionSpace::add_targets(const config::MissionSetup& setup) {
  const geometry::Mesh targets = make_surfaces(*setup.scene().priors, site_data::Role::target);
  if (targets.triangles.empty()) {
    throw Error(
        ErrorKind::bad_config,
        "prior data with role: target has no surface; an inspection requires a mesh, a city "
        "model, an outline with its height, or inspection.cloud");
  }
  const double area = geometry::surface_area(targets);
  const double spacing = setup.document->inspection.spacing.value();
  survey::photo::SampleOptions options;
  options.count = static_cast<std::size_t>(
      std::clamp(area / (spacing * spacing), 500.0, static_cast<double>(max_points)));
  options.min_standoff = flight_.budget().total();
  options.ground = [this](const Eigen::Vector2d& position) { return flight_.ground_at(position); };
  options.threads = setup.run.threads;
  const survey::photo::TargetSamples samples =
      sample_target(targets, geometry::SightLines(targets, setup.run.threads), options);
  points_ = samples.points;
  normals_ = samples.normals;
}

survey::inspection::InspectionSite InspectionSpace::site() const {
  survey::inspection::InspectionSite site;
  site.points = points_;
  site.normals = normals_;
  const double clearance = flight_.budget().total();
  site.distance = [this](const Vector3d& position, double up_to) {
    return space_->surface_distance(position, up_to);
  };
  site.is_free = [this, clearance](const Vector3d& position) {
    return space_->is_free({position, position}, clearance);
  };
  site.segment_distance = [this, clearance](const Vector3d& from, const Vector3d& to,
                                            double up_to) {
    return verify(*space_, {from, to}, clearance, up_to).clearance;
  };
  site.min_height = limits_.min_height;
  site.max_height = limits_.max_height;
  return site;
}

}  // namespace skycap::missions::inspection
