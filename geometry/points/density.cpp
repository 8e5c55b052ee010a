#include "geometry/points/density.h"

#include <algorithm>
#include <cassert>

#include "geometry/parallel.h"

namespace skycap::geometry {
namespace {

constexpr std::size_t returns_in_part = 1 << 15;
constexpr std::uint32_t columns_without_image =
    32;  // a point is first compared with the one this many points before it

/// Calls `visit(number, column)` for the points of one part of a scan.
template <typename Visit>
void visit_part(std::size_t part, std::size_t points, const ImagePixels& image, Visit visit) {
  const std::size_t first = part * returns_in_part;
  const std::size_t end = std::min(points, first + returns_in_part);
  std::uint32_t row_start = 0;
  for (std::size_t i = first; i < end; ++i) {
    const auto number = static_cast<std::uint32_t>(i);
    if (image.pixels.empty()) {
      visit(number, number % columns_without_image);
      continue;
    }
    while (image.pixels[i] - row_start >= image.width) row_start += image.width;
    visit(number, image.pixels[i] - row_start);
  }
}

}  // namespace

DensityMap::DensityMap(const DensityConfig& config)
    : config_(config),
      index_(config.radius),
      spaced_(config.spacing, config.spacing > 0.0 ? 2.0 * config.spacing : config.radius) {
  assert(config.spacing < config.radius);
}

void DensityMap::insert(std::span<const Eigen::Vector3f> points, std::uint32_t view,
                        unsigned threads, const ImagePixels& image) {
  if (cloud_.size() == labelled_) index_.grid().begin_batch();
  spaced_.keep_all(
      points, image.pixels.empty() ? columns_without_image : image.width,
      (points.size() + returns_in_part - 1) / returns_in_part, threads,
      [&](std::size_t part, auto visit) { visit_part(part, points.size(), image, visit); },
      [&](std::uint32_t number) {
        index_.insert(points[number]);
        cloud_.positions.push_back(points[number]);
      });
  cloud_.views.resize(cloud_.size(), view);
  labels_.resize(cloud_.size(), PointLabel::outlier);
  discarded_.resize(cloud_.size(), 0);
}

std::uint32_t DensityMap::count_neighbours(std::uint32_t point) const {
  return static_cast<std::uint32_t>(index_.grid().count_within(
      cloud_.positions[point], config_.radius, static_cast<std::size_t>(config_.core_threshold)));
}

// Counts the neighbours of new points and of old non-core points with new neighbours, and labels
// those with enough neighbours as core. Returns the old points among them, because their promotion
// can change labels farther than r from any new point.
std::vector<std::uint32_t> DensityMap::promote_dense_points(std::uint32_t first_new,
                                                            unsigned threads) {
  const auto threshold = static_cast<std::uint32_t>(config_.core_threshold);
  parallel_for_each(non_core_.size(), threads, [&](std::size_t i) {
    NonCore& entry = non_core_[i];
    if (!index_.grid().is_near_batch(cloud_.positions[entry.point])) return;
    const std::uint32_t count = count_neighbours(entry.point);
    if (count != entry.neighbours) discarded_[entry.point] = 0;
    entry.neighbours = count;
  });
  std::vector<std::uint32_t> promoted;
  std::erase_if(non_core_, [&](const NonCore& entry) {
    if (entry.neighbours >= threshold) promoted.push_back(entry.point);
    return entry.neighbours >= threshold;
  });

  std::vector<std::uint32_t> counts(cloud_.size() - first_new);
  parallel_for_each(counts.size(), threads, [&](std::size_t i) {
    counts[i] = count_neighbours(first_new + static_cast<std::uint32_t>(i));
  });
  for (auto point = first_new; point < cloud_.size(); ++point) {
    const std::uint32_t count = counts[point - first_new];
    if (count >= threshold) {
      labels_[point] = PointLabel::core;
    } else {
      non_core_.push_back({point, count});
    }
  }
  return promoted;
}

// Returns the non-core points within r of a point that is new or was promoted.
std::vector<std::uint32_t> DensityMap::points_to_relabel(
    const std::vector<std::uint32_t>& promoted) const {
  std::vector<std::uint32_t> points;
  for (const NonCore& entry : non_core_) {
    if (index_.grid().is_near_batch(cloud_.positions[entry.point])) points.push_back(entry.point);
  }
  std::vector<Neighbour> near;
  for (const std::uint32_t point : promoted) {
    near.clear();
    index_.grid().find_within(cloud_.positions[point], config_.radius, near);
    for (const Neighbour& neighbour : near) {
      if (labels_[neighbour.index] != PointLabel::core) points.push_back(neighbour.index);
    }
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

bool DensityMap::is_frontier(std::uint32_t point) const {
  if (discarded_[point] != 0) return false;
  std::vector<Neighbour> near;
  index_.grid().find_within(cloud_.positions[point], config_.radius, near);
  bool has_core = false, has_outlier = false;
  for (const Neighbour& neighbour : near) {
    const PointLabel label = labels_[neighbour.index];
    has_core |= label == PointLabel::core;
    switch (config_.rule) {
      case OutlierRule::non_core:
        has_outlier |= label != PointLabel::core && neighbour.index != point;
        break;
      case OutlierRule::labelled:
        has_outlier |= label == PointLabel::outlier;
        break;
    }
  }
  return has_core && has_outlier;
}

DensityUpdate DensityMap::relabel(unsigned threads) {
  DensityUpdate update;
  update.first_new = labelled_;
  labelled_ = static_cast<std::uint32_t>(cloud_.size());
  const std::vector<std::uint32_t> promoted = promote_dense_points(update.first_new, threads);
  for (const std::uint32_t point : promoted) {
    if (labels_[point] == PointLabel::frontier) update.lost_frontiers.push_back(point);
    labels_[point] = PointLabel::core;
  }

  // The order affects only OutlierRule::labelled, which labels new points first.
  std::vector<std::uint32_t> points = points_to_relabel(promoted);
  const auto first_new = std::lower_bound(points.begin(), points.end(), update.first_new);
  std::rotate(points.begin(), first_new, points.end());
  std::vector<std::uint8_t> is_one(points.size());
  const bool in_order = config_.rule == OutlierRule::labelled;
  if (!in_order) {
    parallel_for_each(points.size(), threads,
                      [&](std::size_t i) { is_one[i] = is_frontier(points[i]) ? 1 : 0; });
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t point = points[i];
    const PointLabel before = labels_[point];
    const bool is_now = in_order ? is_frontier(point) : is_one[i] != 0;
    labels_[point] = is_now ? PointLabel::frontier : PointLabel::outlier;
    if (labels_[point] == before) continue;
    auto& changed = before == PointLabel::frontier ? update.lost_frontiers : update.new_frontiers;
    changed.push_back(point);
  }
  std::sort(update.new_frontiers.begin(), update.new_frontiers.end());
  std::sort(update.lost_frontiers.begin(), update.lost_frontiers.end());
  return update;
}

void DensityMap::discard(std::uint32_t frontier) {
  assert(labels_[frontier] == PointLabel::frontier);
  labels_[frontier] = PointLabel::outlier;
  discarded_[frontier] = 1;
}

}  // namespace skycap::geometry
