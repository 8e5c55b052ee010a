#include "geometry/points/surface_map.h"

#include <algorithm>
#include <cmath>

#include "geometry/points/principal_axes.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t min_points = 8;
constexpr double same_direction = 0.5;  // cosine

/// Returns the points within two standard deviations of the plane, which excludes points of an
/// adjoining plane.
std::vector<Vector3f> near_plane(std::span<const Vector3f> points, const PrincipalAxes& fit) {
  const double max = 4.0 * fit.spreads[0];
  const Vector3d normal = fit.axes.col(0);
  std::vector<Vector3f> near;
  near.reserve(points.size());
  for (const Vector3f& point : points) {
    const double height = normal.dot(point.cast<double>() - fit.mean);
    if (height * height <= max) near.push_back(point);
  }
  return near;
}

}  // namespace

std::optional<SurfacePatch> fit_patch(std::span<const Vector3f> points, const Vector3d& sensor) {
  if (points.size() < min_points) return std::nullopt;
  const std::vector<Vector3f> near = near_plane(points, principal_axes(points));
  if (near.size() < min_points) return std::nullopt;
  const PrincipalAxes fit = principal_axes(near);
  constexpr double flat = 0.25, thin = 0.05;  // ratios of variances
  const bool is_plane =
      fit.spreads[0] <= flat * fit.spreads[1] && fit.spreads[1] >= thin * fit.spreads[2];
  if (!is_plane) return std::nullopt;
  const Vector3d normal = fit.axes.col(0);
  const double side = normal.dot(sensor - fit.mean) < 0.0 ? -1.0 : 1.0;
  constexpr double cut_deviation =
      0.8796;  // standard deviation of a normal variable truncated at two standard deviations
  return SurfacePatch{fit.mean, side * normal,
                      std::sqrt(std::max(0.0, fit.spreads[0])) / cut_deviation};
}

ScanPatches scan_patches(const ScanSpan& scan, double radius, std::size_t max_points,
                         std::size_t max_patches) {
  const std::size_t stride = std::max<std::size_t>(1, scan.points.size() / max_points);
  std::vector<Vector3f> points;
  points.reserve(scan.points.size() / stride + 1);
  for (std::size_t i = 0; i < scan.points.size(); i += stride) points.push_back(scan.points[i]);
  SurfaceMap map(radius);
  map.add(points, scan.sensor_position());

  const std::size_t seeds = map.spread_points().size();
  ScanPatches found{.patches = {}, .tried = std::min(seeds, max_patches)};
  for (std::size_t i = 0; i < found.tried; ++i) {
    const auto& patch = map.patch_at(static_cast<std::uint32_t>(i * seeds / found.tried));
    if (patch) found.patches.push_back(*patch);
  }
  return found;
}

SurfaceMap::SurfaceMap(double radius)
    : radius_(radius), points_(0.25 * radius, radius), seeds_(0.5 * radius) {}

void SurfaceMap::add(std::span<const Vector3f> points, const Vector3d& sensor) {
  const auto number = static_cast<std::uint32_t>(sensors_.size());
  sensors_.push_back(sensor);
  for (const Vector3f& point : points) {
    if (!points_.keep(point)) continue;
    sensor_indices_.push_back(number);
    if (seeds_.keep(point)) patches_.push_back({.sensor = number, .patch = {}});
  }
  for (const std::uint32_t seed : made_) patches_[seed].is_made = false;
  made_.clear();
}

std::optional<SurfacePatch> SurfaceMap::fit(const std::vector<Neighbour>& points,
                                            const Vector3d& sensor) const {
  std::vector<Vector3f> positions;
  positions.reserve(points.size());
  for (const Neighbour& point : points) positions.push_back(points_.grid().point(point.index));
  return fit_patch(positions, sensor);
}

const std::optional<SurfacePatch>& SurfaceMap::patch_at(std::uint32_t number) {
  Seed& seed = patches_[number];
  if (seed.is_made) return seed.patch;
  seed.is_made = true;
  made_.push_back(number);
  const Vector3d& sensor = sensors_[seed.sensor];
  std::vector<Neighbour> near;
  points_.grid().find_within(seeds_.grid().point(number), radius_, near);
  seed.patch = fit(near, sensor);
  if (!seed.patch) return seed.patch;
  // The other side of a thin wall is a different surface.
  const auto is_behind = [&](const Neighbour& point) {
    const Vector3d& from = sensors_[sensor_indices_[point.index]];
    return (from - seed.patch->mean).dot(seed.patch->normal) < 0.0;
  };
  if (std::erase_if(near, is_behind) > 0) seed.patch = fit(near, sensor);
  return seed.patch;
}

const SurfacePatch* SurfaceMap::nearest(const SurfacePatch& patch, double reach) {
  const Vector3f query = patch.mean.cast<float>();
  for (double radius = std::min(radius_, reach);; radius = std::min(2.0 * radius, reach)) {
    found_.clear();
    seeds_.grid().find_within(query, radius, found_);
    std::ranges::sort(found_);
    for (const Neighbour& near : found_) {
      const std::optional<SurfacePatch>& there = patch_at(near.index);
      if (there && there->normal.dot(patch.normal) > same_direction) return &*there;
    }
    if (radius >= reach) return nullptr;
  }
}

}  // namespace skycap::geometry
