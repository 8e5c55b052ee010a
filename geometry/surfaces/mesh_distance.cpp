#include "geometry/surfaces/mesh_distance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/parallel.h"
#include "geometry/pose/space_curve.h"
#include "geometry/surfaces/distance_kernels.h"
#include "geometry/surfaces/facet_tree.h"

namespace skycap::geometry {

using Eigen::Vector3d;

namespace {

double compute_sliver_squared_distance(const Facet& facet, const double* point) {
  const Vector3d at(point);
  return (nearest_on(facet, at) - at).squaredNorm();
}

}  // namespace

struct MeshDistance::Impl {
  FacetTree tree;

  /// Nearest facet; among equal ones the first of the mesh.
  struct Nearest {
    double squared_distance = std::numeric_limits<double>::infinity();
    std::uint32_t facet = 0;
    Vector3d point = Vector3d::Zero();
  };

  void look_at(std::uint32_t facet, const Vector3d& point, Nearest& nearest) const {
    const Vector3d foot = nearest_on(tree.facets[facet], point);
    const double squared = (foot - point).squaredNorm();
    if (squared > nearest.squared_distance) return;
    if (squared == nearest.squared_distance &&
        tree.facets[facet].index >= tree.facets[nearest.facet].index) {
      return;
    }
    nearest = {squared, facet, foot};
  }

  Nearest find(const Vector3d& point) const;

  /// Computes the distances of points of any type, packet by packet in the given order.
  template <typename Points>
  void find_all(const Points& points, std::span<const CurveEntry> order,
                std::span<double> distances, unsigned threads) const;
};

MeshDistance::Impl::Nearest MeshDistance::Impl::find(const Vector3d& point) const {
  Nearest nearest;
  look_at(0, point, nearest);
  // Bounds of the rounding errors of the coordinates, of the distance from a box side, and of the
  // sum of squares.
  constexpr float unit = std::numeric_limits<float>::epsilon();
  constexpr float sum_rounding = 1.0F - 4.0F * unit;
  std::array<float, 3> at, slack;
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = static_cast<float>(point[axis]);
    slack[axis] = 2.0F * unit * std::abs(at[axis]);
  }
  using Lanes = Eigen::Map<const Eigen::Array4f, Eigen::Aligned16>;
  struct Entry {
    float bound;  ///< lower bound of the squared distance
    std::uint32_t child;
  };
  std::array<Entry, max_pending> stack;
  std::size_t size = 0;
  stack[size++] = {0.0F, 0};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.bound > nearest.squared_distance) continue;
    if ((entry.child & FacetNode::is_facet) != 0) {
      look_at(entry.child & ~FacetNode::is_facet, point, nearest);
      continue;
    }
    const FacetNode& node = tree.nodes[entry.child];
    Eigen::Array4f bounds = Eigen::Array4f::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Lanes low(node.low[axis]), high(node.high[axis]);
      const Eigen::Array4f outside = (low - at[axis]).max(at[axis] - high);
      bounds += (outside - slack[axis]).max(0.0F).square();
    }
    bounds *= sum_rounding;
    const std::size_t first = size;
    for (int lane = 0; lane < FacetNode::lanes; ++lane) {
      const float bound = bounds[lane];
      if (!(bound <= nearest.squared_distance)) continue;
      // Pushes the nearest child last, so that it is visited first.
      std::size_t slot = size++;
      for (; slot > first && stack[slot - 1].bound < bound; --slot) {
        stack[slot] = stack[slot - 1];
      }
      stack[slot] = {bound, node.child[lane]};
    }
  }
  return nearest;
}

template <typename Points>
void MeshDistance::Impl::find_all(const Points& points, std::span<const CurveEntry> order,
                                  std::span<double> distances, unsigned threads) const {
  constexpr std::size_t packet = DistanceKernels::packet, batch = 256 * packet;
  parallel_for((order.size() + batch - 1) / batch, threads, [&](std::size_t part) {
    const std::size_t begin = part * batch;
    const std::span own = order.subspan(begin, std::min(batch, order.size() - begin));
    // The last packet is padded with its last point.
    const std::size_t count = (own.size() + packet - 1) / packet * packet;
    std::array<std::array<double, batch>, 3> at;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& point = points[own[std::min(i, own.size() - 1)].index];
      for (int axis = 0; axis < 3; ++axis) at[axis][i] = point[axis];
    }
    const std::array<const double*, 3> axes{at[0].data(), at[1].data(), at[2].data()};
    std::array<double, batch> squared;
    distance_kernels().squared_distances(tree.nodes.data(), tree.facets.data(),
                                         compute_sliver_squared_distance, count, axes.data(),
                                         squared.data());
    for (std::size_t i = 0; i < own.size(); ++i) distances[own[i].index] = std::sqrt(squared[i]);
  });
}

MeshDistance::MeshDistance(const Mesh& mesh, unsigned threads) : impl_(std::make_unique<Impl>()) {
  validate(mesh, threads);
  impl_->tree = facet_tree(mesh, threads);
}

MeshDistance::MeshDistance(MeshDistance&&) noexcept = default;
MeshDistance& MeshDistance::operator=(MeshDistance&&) noexcept = default;
MeshDistance::~MeshDistance() = default;

MeshDistance::Closest MeshDistance::closest(const Vector3d& point) const {
  const Impl::Nearest nearest = impl_->find(point);
  return {nearest.point, impl_->tree.facets[nearest.facet].index,
          std::sqrt(nearest.squared_distance)};
}

// The distance changes at most as fast as the position. Hence the distances at both ends bound
// those in between; if they do not suffice, both halves are tested.
bool MeshDistance::keeps(const Vector3d& from, const Vector3d& to, double distance) const {
  assert(distance > 0.0);
  const double at_from = this->distance(from), at_to = this->distance(to);
  if (at_from < distance || at_to < distance) return false;
  const double length = (to - from).norm();
  if (at_from + at_to - length >= 2.0 * distance) return true;
  if (length < 1e-3 * distance) return false;
  const Vector3d middle = 0.5 * (from + to);
  return keeps(from, middle, distance) && keeps(middle, to, distance);
}

void MeshDistance::distances(std::span<const Eigen::Vector3f> points, std::span<double> distances,
                             unsigned threads) const {
  assert(points.size() == distances.size());
  impl_->find_all(points, along_curve(points, finest_grid(points)), distances, threads);
}

void MeshDistance::distances(std::span<const Vector3d> points, std::span<double> distances,
                             unsigned threads) const {
  assert(points.size() == distances.size());
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(points.size());
  for (const Vector3d& point : points) positions.push_back(point.cast<float>());
  impl_->find_all(points, along_curve(positions, finest_grid(positions)), distances, threads);
}

}  // namespace skycap::geometry
