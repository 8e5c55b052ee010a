#include "survey/inspection/reachable_space.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace skycap::survey::inspection {
namespace {

using Eigen::Array3i;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double max_field_spacing = 0.5, max_node_spacing = 1.0;
/// Fields with more nodes than this use a larger spacing.
constexpr double max_field_nodes = 4e6;
/// Nodes along the edge of a block whose centre is evaluated first.
constexpr int block_nodes = 4;

Array3i counts_along(const Eigen::AlignedBox3d& box, double spacing) {
  return (box.sizes().array() / spacing).ceil().cast<int>() + 1;
}

}  // namespace

ReachableSpace::ReachableSpace(const StructureCloud& cloud, const SpaceOptions& options)
    : options_(options) {
  const double volume = options_.box.sizes().array().max(1.0).prod();
  spacing_ = std::max(max_field_spacing, std::cbrt(volume / max_field_nodes));
  node_spacing_ = std::max(max_node_spacing, 2.0 * spacing_);
  if (node_spacing_ > 2.0 * options_.clearance) {
    throw Error(ErrorKind::bad_geometry,
                "the clearance is less than half the spacing of the search grid; raise it");
  }
  // Around a point, the interpolated distance exceeds the true one by up to h^2 / (4 d).
  constexpr double min_error = 0.05, rounding = 0.01;
  required_ = options_.clearance +
              std::max(min_error, 0.25 * spacing_ * spacing_ / options_.clearance + rounding);
  counts_ = counts_along(options_.box, spacing_);
  node_counts_ = counts_along(options_.box, node_spacing_);
  field_.assign(static_cast<std::size_t>(counts_.cast<std::int64_t>().prod()),
                static_cast<float>(options_.max_distance));
  if (options_.distance) {
    compute_from_obstacles();
  } else {
    compute_from_points(cloud);
  }
  flood();
}

std::size_t ReachableSpace::field_index(int x, int y, int z) const {
  return (static_cast<std::size_t>(z) * static_cast<std::size_t>(counts_.y()) +
          static_cast<std::size_t>(y)) *
             static_cast<std::size_t>(counts_.x()) +
         static_cast<std::size_t>(x);
}

void ReachableSpace::compute_from_points(const StructureCloud& cloud) {
  const Vector3d origin = options_.box.min();
  const int reach = static_cast<int>(std::ceil(options_.max_distance / spacing_));
  geometry::parallel_for(
      static_cast<std::size_t>(counts_.z()), options_.threads, [&](std::size_t layer) {
        const int z = static_cast<int>(layer);
        const double height = origin.z() + spacing_ * z;
        for (const Vector3f& point : cloud.points) {
          const Vector3d at = point.cast<double>();
          const double dz = at.z() - height;
          if (std::abs(dz) >= options_.max_distance) continue;
          const Array3i centre = ((at - origin).array() / spacing_).floor().cast<int>();
          const int from_y = std::max(0, centre.y() - reach);
          const int to_y = std::min(counts_.y() - 1, centre.y() + reach + 1);
          for (int y = from_y; y <= to_y; ++y) {
            const double dy = at.y() - (origin.y() + spacing_ * y);
            const double flat = dy * dy + dz * dz;
            if (flat >= options_.max_distance * options_.max_distance) continue;
            const int from_x = std::max(0, centre.x() - reach);
            const int to_x = std::min(counts_.x() - 1, centre.x() + reach + 1);
            float* const row = field_.data() + field_index(0, y, z);
            for (int x = from_x; x <= to_x; ++x) {
              const double dx = at.x() - (origin.x() + spacing_ * x);
              row[x] = std::min(row[x], static_cast<float>(std::sqrt(dx * dx + flat)));
            }
          }
        }
      });
}

void ReachableSpace::compute_from_obstacles() {
  const Array3i blocks = (counts_ + (block_nodes - 1)) / block_nodes;
  const auto total = static_cast<std::size_t>(blocks.cast<std::int64_t>().prod());
  const double half = 0.5 * spacing_ * (block_nodes - 1);
  const double block_radius = std::sqrt(3.0) * half;
  geometry::parallel_for(total, options_.threads, [&](std::size_t number) {
    const auto block = static_cast<int>(number);
    const Array3i first(block % blocks.x() * block_nodes,
                        block / blocks.x() % blocks.y() * block_nodes,
                        block / (blocks.x() * blocks.y()) * block_nodes);
    const Vector3d corner = options_.box.min() + spacing_ * first.matrix().cast<double>();
    const double up_to = options_.max_distance + block_radius;
    // A distance changes by at most the distance of two positions.
    if (options_.distance(corner + Vector3d::Constant(half), up_to) >= up_to) return;
    const Array3i end = (first + block_nodes).min(counts_);
    for (int z = first.z(); z < end.z(); ++z) {
      for (int y = first.y(); y < end.y(); ++y) {
        for (int x = first.x(); x < end.x(); ++x) {
          const Vector3d at = options_.box.min() + spacing_ * Vector3d(x, y, z);
          field_[field_index(x, y, z)] =
              static_cast<float>(options_.distance(at, options_.max_distance));
        }
      }
    }
  });
}

double ReachableSpace::distance(const Vector3d& position) const {
  const Vector3d at = (position - options_.box.min()) / spacing_;
  if ((at.array() < 0.0).any()) return 0.0;
  const Array3i cell = at.array().floor().cast<int>();
  if ((cell >= counts_ - 1).any()) return 0.0;
  const Vector3d part = at - cell.matrix().cast<double>();
  const auto row = [&](int y, int z) {
    const float* const values = field_.data() + field_index(cell.x(), y, z);
    return static_cast<double>(values[0]) +
           part.x() * (static_cast<double>(values[1]) - static_cast<double>(values[0]));
  };
  const auto layer = [&](int z) {
    const double near = row(cell.y(), z);
    return near + part.y() * (row(cell.y() + 1, z) - near);
  };
  const double below = layer(cell.z());
  return below + part.z() * (layer(cell.z() + 1) - below);
}

std::size_t ReachableSpace::node_index(const Array3i& node) const {
  return (static_cast<std::size_t>(node.z()) * static_cast<std::size_t>(node_counts_.y()) +
          static_cast<std::size_t>(node.y())) *
             static_cast<std::size_t>(node_counts_.x()) +
         static_cast<std::size_t>(node.x());
}

Vector3d ReachableSpace::node_position(std::size_t node) const {
  const auto width = static_cast<std::size_t>(node_counts_.x());
  const auto depth = static_cast<std::size_t>(node_counts_.y());
  return options_.box.min() + node_spacing_ * Vector3d(static_cast<double>(node % width),
                                                       static_cast<double>(node / width % depth),
                                                       static_cast<double>(node / (width * depth)));
}

void ReachableSpace::flood() {
  reachable_.assign(static_cast<std::size_t>(node_counts_.cast<std::int64_t>().prod()), 0);
  std::vector<std::uint8_t> is_open(reachable_.size());
  geometry::parallel_for_each(reachable_.size(), options_.threads, [&](std::size_t node) {
    const Vector3d at = node_position(node);
    is_open[node] =
        at.z() >= options_.min_height && at.z() <= options_.max_height && distance(at) >= required_;
  });
  // The highest layer with a free node is outside of the structure.
  std::vector<std::size_t> open;
  const std::size_t layer =
      static_cast<std::size_t>(node_counts_.x()) * static_cast<std::size_t>(node_counts_.y());
  for (std::size_t end = reachable_.size(); end > 0 && open.empty(); end -= layer) {
    for (std::size_t node = end - layer; node < end; ++node) {
      if (is_open[node] == 0) continue;
      if (options_.is_free && !options_.is_free(node_position(node))) continue;
      reachable_[node] = 1;
      open.push_back(node);
    }
  }
  if (open.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "no position around the structure keeps the clearance within the height and "
                "airspace limits; lower the clearance or check the limits");
  }
  const std::array<Array3i, 6> steps{Array3i(1, 0, 0),  Array3i(-1, 0, 0), Array3i(0, 1, 0),
                                     Array3i(0, -1, 0), Array3i(0, 0, 1),  Array3i(0, 0, -1)};
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    const auto flat = static_cast<int>(node);
    const Array3i at(flat % node_counts_.x(), flat / node_counts_.x() % node_counts_.y(),
                     flat / (node_counts_.x() * node_counts_.y()));
    for (const Array3i& step : steps) {
      const Array3i next = at + step;
      if ((next < 0).any() || (next >= node_counts_).any()) continue;
      const std::size_t index = node_index(next);
      if (is_open[index] == 0 || reachable_[index] != 0) continue;
      reachable_[index] = 1;
      open.push_back(index);
    }
  }
}

Array3i ReachableSpace::nearest_node(const Vector3d& position) const {
  const Array3i node =
      ((position - options_.box.min()).array() / node_spacing_ + 0.5).floor().cast<int>();
  return node.max(0).min(node_counts_ - 1);
}

bool ReachableSpace::is_reachable(const Vector3d& position) const {
  return reachable_[node_index(nearest_node(position))] != 0 &&
         position.z() >= options_.min_height && position.z() <= options_.max_height &&
         distance(position) >= required_;
}

bool ReachableSpace::is_clear(const Vector3d& from, const Vector3d& to) const {
  const double step = 0.5 * spacing_;
  const int steps = static_cast<int>(std::ceil((to - from).norm() / step));
  for (int i = 0; i <= steps; ++i) {
    const double share = steps == 0 ? 0.0 : static_cast<double>(i) / steps;
    const Vector3d at = from + share * (to - from);
    if (at.z() < options_.min_height || at.z() > options_.max_height || distance(at) < required_) {
      return false;
    }
  }
  return true;
}

std::optional<std::size_t> ReachableSpace::reachable_node_near(const Vector3d& position) const {
  const Array3i centre = nearest_node(position);
  std::optional<std::size_t> nearest;
  double distance = std::numeric_limits<double>::infinity();
  for (int z = -2; z <= 2; ++z) {
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) {
        const Array3i at = centre + Array3i(x, y, z);
        if ((at < 0).any() || (at >= node_counts_).any()) continue;
        const std::size_t node = node_index(at);
        if (reachable_[node] == 0) continue;
        const double other = (node_position(node) - position).norm();
        if (other < distance) {
          distance = other;
          nearest = node;
        }
      }
    }
  }
  return nearest;
}

}  // namespace skycap::survey::inspection
