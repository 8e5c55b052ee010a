#include "flight/clearance/bounding_tree.h"

#include <algorithm>
#include <numeric>

namespace skycap::flight {
namespace {

constexpr std::uint32_t leaf_size = 4;

}  // namespace

BoundingTree::BoundingTree(std::span<const Eigen::AlignedBox3d> boxes) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0U);
  if (boxes.empty()) return;
  nodes_.reserve(boxes.size());
  build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
}

std::uint32_t BoundingTree::build(std::span<const Eigen::AlignedBox3d> boxes, std::uint32_t begin,
                                  std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node;
  Eigen::AlignedBox3d centres;
  for (std::uint32_t slot = begin; slot < end; ++slot) {
    node.box.extend(boxes[items_[slot]]);
    centres.extend(boxes[items_[slot]].center());
  }
  if (end - begin <= leaf_size) {
    node.first = begin;
    node.count = end - begin;
    nodes_.push_back(node);
    return index;
  }
  nodes_.push_back(node);
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double centre_a = boxes[a].center()[axis];
                     const double centre_b = boxes[b].center()[axis];
                     return centre_a != centre_b ? centre_a < centre_b : a < b;
                   });
  build(boxes, begin, middle);
  const std::uint32_t right = build(boxes, middle, end);
  nodes_[index].first = right;
  return index;
}

BoxTest::BoxTest(const Segment& segment) : segment_(segment), from_(segment.from.array()) {
  const Eigen::Array3d along = segment.to - segment.from;
  // A large finite value instead of 1/0 keeps 0 * inverse at 0; infinity would give NaN.
  inverse_ = along.unaryExpr([](double d) { return d == 0.0 ? 1e300 : 1.0 / d; });
  const double squared_length = along.matrix().squaredNorm();
  inverse_squared_length_ = squared_length > 0.0 ? 1.0 / squared_length : 0.0;
}

double BoxTest::squared_bound(const Eigen::AlignedBox3d& box) const {
  const Eigen::Vector3d centre = box.center();
  const Eigen::Vector3d along = segment_.to - segment_.from;
  const double t = (centre - segment_.from).dot(along) * inverse_squared_length_;
  const double to_centre = (segment_.at(std::clamp(t, 0.0, 1.0)) - centre).norm();
  const double to_ball = std::max(0.0, to_centre - 0.5 * box.diagonal().norm());
  const double between_shadows =
      Eigen::AlignedBox3d(segment_.from.cwiseMin(segment_.to), segment_.from.cwiseMax(segment_.to))
          .squaredExteriorDistance(box);
  return std::max(to_ball * to_ball, between_shadows);
}

}  // namespace skycap::flight
