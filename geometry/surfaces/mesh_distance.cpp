#include "geometry/surfaces/mesh_distance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

constexpr int lanes = 4;
constexpr std::uint32_t is_triangle = 1U << 31;  ///< of a child: a triangle's slot, not a node

/// Up to four children and their boxes, side by side so that one instruction asks all four. A child
/// that is not there has a box that is infinitely far away.
struct alignas(64) Node {
  std::array<Eigen::Array4f, 3> low, high;
  std::array<std::uint32_t, lanes> child;
};

/// A triangle, ready to be projected onto.
struct Facet {
  Vector3d corner, to_second, to_third;
  std::uint32_t index;  ///< in the mesh
  bool is_sliver;       ///< too thin for its plane to be known
};

/// Foot of a point on the line from `corner` along `edge`, cut at its ends.
Vector3d on_edge(const Vector3d& point, const Vector3d& corner, const Vector3d& edge) {
  const double along = (point - corner).dot(edge) / edge.squaredNorm();
  return corner + std::clamp(along, 0.0, 1.0) * edge;
}

Vector3d on_border(const Vector3d& point, const Facet& facet) {
  const Vector3d second = facet.corner + facet.to_second;
  Vector3d nearest = on_edge(point, facet.corner, facet.to_second);
  for (const Vector3d& other : {on_edge(point, facet.corner, facet.to_third),
                                on_edge(point, second, facet.to_third - facet.to_second)}) {
    if ((other - point).squaredNorm() < (nearest - point).squaredNorm()) nearest = other;
  }
  return nearest;
}

/// The facet's point nearest to `point`: by the regions of the plane that are nearest to a corner,
/// to an edge or to the inside (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
Vector3d on_facet(const Vector3d& point, const Facet& facet) {
  if (facet.is_sliver) return on_border(point, facet);
  const Vector3d &ab = facet.to_second, &ac = facet.to_third;
  const Vector3d from_a = point - facet.corner;
  const double d1 = ab.dot(from_a), d2 = ac.dot(from_a);
  if (d1 <= 0.0 && d2 <= 0.0) return facet.corner;
  const Vector3d from_b = from_a - ab;
  const double d3 = ab.dot(from_b), d4 = ac.dot(from_b);
  if (d3 >= 0.0 && d4 <= d3) return facet.corner + ab;
  const double c = d1 * d4 - d3 * d2;
  if (c <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return facet.corner + d1 / (d1 - d3) * ab;
  const Vector3d from_c = from_a - ac;
  const double d5 = ab.dot(from_c), d6 = ac.dot(from_c);
  if (d6 >= 0.0 && d5 <= d6) return facet.corner + ac;
  const double b = d5 * d2 - d1 * d6;
  if (b <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return facet.corner + d2 / (d2 - d6) * ac;
  const double a = d3 * d6 - d5 * d4;
  if (a <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return facet.corner + ab + along * (ac - ab);
  }
  return facet.corner + (b * ab + c * ac) / (a + b + c);
}

/// The next float that is not above, or not below, the number.
float below(double x) {
  const auto rounded = static_cast<float>(x);
  return rounded > x ? std::nextafter(rounded, -std::numeric_limits<float>::infinity()) : rounded;
}
float above(double x) { return -below(-x); }

/// A tree of four-fold nodes, each made by parting twice.
class TreeBuilder {
 public:
  explicit TreeBuilder(std::vector<Facet>& facets) : facets_(facets), order_(facets.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    for (const Facet& facet : facets) {
      Eigen::AlignedBox3d box(facet.corner);
      box.extend(facet.corner + facet.to_second).extend(facet.corner + facet.to_third);
      boxes_.push_back(box);
    }
    if (!facets.empty()) build(0, static_cast<std::uint32_t>(facets.size()), 0);
    std::vector<Facet> sorted;
    sorted.reserve(facets.size());
    for (const std::uint32_t i : order_) sorted.push_back(facets[i]);
    facets_ = std::move(sorted);
  }

  std::vector<Node> nodes;

 private:
  std::uint32_t build(std::uint32_t begin, std::uint32_t end, int depth) {
    const auto index = static_cast<std::uint32_t>(nodes.size());
    nodes.emplace_back();
    const std::uint32_t middle = part(begin, end, depth);
    const std::array<std::uint32_t, lanes + 1> cuts{begin, part(begin, middle, depth), middle,
                                                    part(middle, end, depth), end};
    Node node;
    for (int lane = 0; lane < lanes; ++lane)
      set_lane(node, lane, cuts[lane], cuts[lane + 1], depth);
    nodes[index] = node;
    return index;
  }

  void set_lane(Node& node, int lane, std::uint32_t begin, std::uint32_t end, int depth) {
    Eigen::AlignedBox3d box;
    for (std::uint32_t slot = begin; slot < end; ++slot) box.extend(boxes_[order_[slot]]);
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][lane] = begin < end ? below(box.min()[axis]) : far_away;
      node.high[axis][lane] = begin < end ? above(box.max()[axis]) : far_away;
    }
    node.child[lane] = end - begin > 1 ? build(begin, end, depth + 1) : begin | is_triangle;
  }

  /// Sorts slots into two parts, neither empty, and returns where the second begins.
  std::uint32_t part(std::uint32_t begin, std::uint32_t end, int depth) {
    if (end - begin < 2) return end;
    Eigen::AlignedBox3d centres;
    for (std::uint32_t slot = begin; slot < end; ++slot) {
      centres.extend(boxes_[order_[slot]].center());
    }
    Eigen::Index axis = 0;
    const double length = centres.sizes().maxCoeff(&axis);
    const double scale = slabs / length;
    if (std::isfinite(scale) && depth < most_cuts) {
      return cut({begin, end, axis, centres.min()[axis], scale});
    }
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double at_a = boxes_[a].center()[axis];
                       const double at_b = boxes_[b].center()[axis];
                       return at_a != at_b ? at_a < at_b : a < b;
                     });
    return middle;
  }

  /// Slots to be parted along an axis, of which `slabs` equal parts are looked at.
  struct Range {
    std::uint32_t begin, end;
    Eigen::Index axis;
    double low, scale;
  };

  struct Group {
    Eigen::AlignedBox3d box;
    double count = 0.0;

    void add(const Group& other) {
      box.extend(other.box);
      count += other.count;
    }
    /// How often it is met, by the surface of its box, times what is in it.
    double cost() const {
      if (count == 0.0) return 0.0;
      const Vector3d side = box.sizes();
      return count * (side.x() * side.y() + side.y() * side.z() + side.z() * side.x());
    }
  };

  std::size_t slab_of(std::uint32_t item, const Range& range) const {
    const double at = boxes_[item].center()[range.axis];
    return std::min<std::size_t>(slabs - 1,
                                 static_cast<std::size_t>((at - range.low) * range.scale));
  }

  /// Between the two slabs where the parts cost least.
  std::uint32_t cut(const Range& range) {
    std::array<Group, slabs> groups;
    for (std::uint32_t slot = range.begin; slot < range.end; ++slot) {
      const std::uint32_t item = order_[slot];
      groups[slab_of(item, range)].add({boxes_[item], 1.0});
    }
    std::array<double, slabs> cost_from{};
    Group sum;
    for (std::size_t i = slabs - 1; i > 0; --i) {
      sum.add(groups[i]);
      cost_from[i] = sum.cost();
    }
    sum = {};
    double least = std::numeric_limits<double>::infinity();
    std::size_t last = 0;  // of the first part
    for (std::size_t i = 0; i + 1 < slabs; ++i) {
      sum.add(groups[i]);  // the first and the last slab are never empty
      if (const double cost = sum.cost() + cost_from[i + 1]; cost < least) {
        least = cost;
        last = i;
      }
    }
    const auto second =
        std::partition(order_.begin() + range.begin, order_.begin() + range.end,
                       [&](std::uint32_t item) { return slab_of(item, range) <= last; });
    return static_cast<std::uint32_t>(second - order_.begin());
  }

  static constexpr std::size_t slabs = 16;
  static constexpr int most_cuts = 12;  ///< levels; below them parts are halved by count
  static constexpr float far_away = std::numeric_limits<float>::infinity();

  std::vector<Facet>& facets_;
  std::vector<std::uint32_t> order_;
  std::vector<Eigen::AlignedBox3d> boxes_;
};

/// Thinner than this in parts of its longest edge, the plane of a triangle is not known well.
constexpr double sliver = 1e-6;

/// Nothing for a triangle without area.
std::vector<Facet> facets_of(const Mesh& mesh) {
  std::vector<Facet> facets;
  facets.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vector3d &corner = mesh.vertices[a], ab = mesh.vertices[b] - corner,
                   ac = mesh.vertices[c] - corner;
    const double twice_area = ab.cross(ac).norm();
    if (twice_area == 0.0) continue;
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    facets.push_back({corner, ab, ac, t, twice_area < sliver * longest});
  }
  return facets;
}

}  // namespace

struct MeshDistance::Impl {
  std::vector<Facet> facets;  ///< in the order of the tree
  std::vector<Node> nodes;

  /// The nearest of all facets, of equally near ones the first of the mesh.
  struct Nearest {
    double squared_distance = std::numeric_limits<double>::infinity();
    std::uint32_t facet = 0;
    Vector3d point = Vector3d::Zero();
  };

  void look_at(std::uint32_t facet, const Vector3d& point, Nearest& nearest) const {
    const Vector3d foot = on_facet(point, facets[facet]);
    const double squared = (foot - point).squaredNorm();
    if (squared > nearest.squared_distance) return;
    if (squared == nearest.squared_distance && facets[facet].index >= facets[nearest.facet].index) {
      return;
    }
    nearest = {squared, facet, foot};
  }

  /// Beginning with a facet that may be near.
  Nearest find(const Vector3d& point, std::uint32_t hint) const;
};

MeshDistance::Impl::Nearest MeshDistance::Impl::find(const Vector3d& point,
                                                     std::uint32_t hint) const {
  Nearest nearest;
  look_at(hint, point, nearest);
  // The rounding of the place, of its distance from a side, and of the sum of their squares.
  constexpr float unit = std::numeric_limits<float>::epsilon();
  constexpr float sum_rounding = 1.0F - 4.0F * unit;
  std::array<float, 3> at, slack;
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = static_cast<float>(point[axis]);
    slack[axis] = 2.0F * unit * std::abs(at[axis]);
  }
  struct Entry {
    float bound;  ///< of the squared distance
    std::uint32_t child;
  };
  // 12 levels of cuts and 16 of quarters hold any mesh; each leaves three children behind.
  std::array<Entry, 96> stack;
  std::size_t size = 0;
  stack[size++] = {0.0F, 0};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.bound > nearest.squared_distance) continue;
    if ((entry.child & is_triangle) != 0) {
      look_at(entry.child & ~is_triangle, point, nearest);
      continue;
    }
    const Node& node = nodes[entry.child];
    Eigen::Array4f bounds = Eigen::Array4f::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Array4f outside = (node.low[axis] - at[axis]).max(at[axis] - node.high[axis]);
      bounds += (outside - slack[axis]).max(0.0F).square();
    }
    bounds *= sum_rounding;
    const std::size_t first = size;
    for (int lane = 0; lane < lanes; ++lane) {
      const float bound = bounds[lane];
      if (!(bound <= nearest.squared_distance)) continue;
      // The nearest last, so that it is taken first.
      std::size_t place = size++;
      for (; place > first && stack[place - 1].bound < bound; --place) {
        stack[place] = stack[place - 1];
      }
      stack[place] = {bound, node.child[lane]};
    }
  }
  return nearest;
}

MeshDistance::MeshDistance(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  validate(mesh);
  impl_->facets = facets_of(mesh);
  impl_->nodes = std::move(TreeBuilder(impl_->facets).nodes);
}

MeshDistance::MeshDistance(MeshDistance&&) noexcept = default;
MeshDistance& MeshDistance::operator=(MeshDistance&&) noexcept = default;
MeshDistance::~MeshDistance() = default;

MeshDistance::Closest MeshDistance::closest(const Vector3d& point) const {
  const Impl::Nearest nearest = impl_->find(point, 0);
  return {nearest.point, impl_->facets[nearest.facet].index, std::sqrt(nearest.squared_distance)};
}

// Distances change no faster than places do: both ends tell of all between, or else both halves.
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

void MeshDistance::distances(std::span<const Eigen::Vector3f> points,
                             std::span<double> distances) const {
  assert(points.size() == distances.size());
  std::uint32_t hint = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Impl::Nearest nearest = impl_->find(points[i].cast<double>(), hint);
    distances[i] = std::sqrt(nearest.squared_distance);
    hint = nearest.facet;
  }
}

}  // namespace skycap::geometry
