#include "geometry/points/density.h"

#include <algorithm>
#include <cassert>

#include "geometry/parallel.h"

namespace skycap::geometry {
namespace {

/// Asks a grid whether it has a point within a radius, for points of one scan in their order.
class ScanNeighbours {
 public:
  ScanNeighbours(const PointGrid& grid, double radius, const ImagePixels& image)
      : nearby_(grid, radius), row_(grid, radius, image.width), image_(image) {}

  /// Whether there is one near `point`, which has that number in the scan.
  bool any_near(const Eigen::Vector3f& point, std::size_t number) {
    if (image_.pixels.empty()) return nearby_.any_near(point);
    const std::uint32_t pixel = image_.pixels[number];
    while (pixel - first_of_row_ >= image_.width) first_of_row_ += image_.width;
    column_ = pixel - first_of_row_;
    return row_.any_near(point, column_);
  }
  /// The last point that was asked for is in the grid now.
  void remember(const Eigen::Vector3f& point) {
    if (!image_.pixels.empty()) row_.remember(point, column_);
  }

 private:
  NearbyPoints nearby_;
  RowNeighbours row_;
  ImagePixels image_;
  std::uint32_t first_of_row_ = 0, column_ = 0;  // of the last point
};

}  // namespace

DensityMap::DensityMap(const DensityConfig& config)
    : config_(config),
      index_(config.radius),
      spaced_(config.spacing, config.spacing > 0.0 ? 2.0 * config.spacing : config.radius) {
  assert(config.spacing < config.radius);
}

// Which points have room depends on the order within a scan, but whether one is too near to an
// earlier scan's does not: that is found out on all threads and turns most away, while the others
// before it are compared with each other.
std::vector<Eigen::Vector3f> DensityMap::points_with_room(std::span<const Eigen::Vector3f> points,
                                                          const ImagePixels& image,
                                                          unsigned threads) const {
  constexpr std::size_t part_size = 1 << 15, parts_at_a_time = 8;
  SpacedPoints fresh(config_.spacing, spaced_.grid().cell_size());
  ScanNeighbours near_fresh(fresh.grid(), config_.spacing, image);
  std::vector<Eigen::Vector3f> kept;
  const auto keep_in_order = [&](const std::vector<std::uint32_t>& candidates) {
    for (const std::uint32_t i : candidates) {
      if (near_fresh.any_near(points[i], i)) continue;
      fresh.add(points[i]);
      near_fresh.remember(points[i]);
      kept.push_back(points[i]);
    }
  };
  const std::size_t parts = (points.size() + part_size - 1) / part_size;
  std::vector<std::vector<std::uint32_t>> before, now;
  for (std::size_t first = 0; first < parts || !before.empty(); first += parts_at_a_time) {
    now.resize(first < parts ? std::min(parts_at_a_time, parts - first) : 0);
    parallel_for(now.size() + 1, threads, [&](std::size_t task) {
      if (task == 0) {
        for (const auto& part : before) keep_in_order(part);
        return;
      }
      const std::size_t part = first + task - 1;
      const std::size_t end = std::min(points.size(), (part + 1) * part_size);
      ScanNeighbours near_earlier(spaced_.grid(), config_.spacing, image);
      std::vector<std::uint32_t> candidates;
      for (std::size_t i = part * part_size; i < end; ++i) {
        if (!near_earlier.any_near(points[i], i)) candidates.push_back(static_cast<std::uint32_t>(i));
      }
      now[task - 1] = std::move(candidates);
    });
    before.swap(now);
  }
  return kept;
}

void DensityMap::insert(std::span<const Eigen::Vector3f> points, std::uint32_t view,
                        unsigned threads, const ImagePixels& image) {
  if (cloud_.size() == labelled_) index_.grid().begin_batch();
  if (thread_count(threads) == 1 || cloud_.size() == 0) {
    ScanNeighbours near(spaced_.grid(), config_.spacing, image);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (near.any_near(points[i], i)) continue;
      spaced_.add(points[i]);
      near.remember(points[i]);
      index_.insert(points[i]);
      cloud_.positions.push_back(points[i]);
    }
  } else {
    const std::vector<Eigen::Vector3f> kept = points_with_room(points, image, threads);
    parallel_for(2, threads, [&](std::size_t task) {
      if (task == 0) {
        for (const Eigen::Vector3f& point : kept) index_.insert(point);
      } else {
        for (const Eigen::Vector3f& point : kept) spaced_.add(point);
      }
    });
    cloud_.positions.insert(cloud_.positions.end(), kept.begin(), kept.end());
  }
  cloud_.views.resize(cloud_.size(), view);
  labels_.resize(cloud_.size(), PointLabel::outlier);
  given_up_.resize(cloud_.size(), 0);
}

std::uint32_t DensityMap::neighbours_of(std::uint32_t point) const {
  return static_cast<std::uint32_t>(index_.grid().count_within(
      cloud_.positions[point], config_.radius, static_cast<std::size_t>(config_.core_threshold)));
}

// Counts the neighbours of new points, and of old non-core points that have new neighbours; labels
// those that have enough as core. Returns the old points among them, whose promotion can change
// labels farther than r from anything new.
std::vector<std::uint32_t> DensityMap::promote_dense_points(std::uint32_t first_new,
                                                            unsigned threads) {
  const auto threshold = static_cast<std::uint32_t>(config_.core_threshold);
  parallel_for_each(non_core_.size(), threads, [&](std::size_t i) {
    NonCore& entry = non_core_[i];
    if (!index_.grid().is_near_batch(cloud_.positions[entry.point])) return;
    const std::uint32_t count = neighbours_of(entry.point);
    if (count != entry.neighbours) given_up_[entry.point] = 0;
    entry.neighbours = count;
  });
  std::vector<std::uint32_t> promoted;
  std::erase_if(non_core_, [&](const NonCore& entry) {
    if (entry.neighbours >= threshold) promoted.push_back(entry.point);
    return entry.neighbours >= threshold;
  });

  std::vector<std::uint32_t> counts(cloud_.size() - first_new);
  parallel_for_each(counts.size(), threads, [&](std::size_t i) {
    counts[i] = neighbours_of(first_new + static_cast<std::uint32_t>(i));
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

// The non-core points within r of anything whose being core has changed or begun.
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
  if (given_up_[point] != 0) return false;
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

  // The order matters to OutlierRule::labelled alone, which labels new points first.
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

void DensityMap::give_up(std::uint32_t frontier) {
  assert(labels_[frontier] == PointLabel::frontier);
  labels_[frontier] = PointLabel::outlier;
  given_up_[frontier] = 1;
}

}  // namespace skycap::geometry
