#include "geometry/surfaces/facet_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/parallel.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Node = FacetNode;

constexpr int lanes = FacetNode::lanes;

/// Of a facet, as vectors.
struct Corners {
  explicit Corners(const Facet& facet)
      : corner(facet.corner), to_second(facet.to_second), to_third(facet.to_third) {}

  Vector3d corner, to_second, to_third;
};

/// Foot of a point on the line from `corner` along `edge`, cut at its ends.
Vector3d on_edge(const Vector3d& point, const Vector3d& corner, const Vector3d& edge) {
  const double along = (point - corner).dot(edge) / edge.squaredNorm();
  return corner + std::clamp(along, 0.0, 1.0) * edge;
}

Vector3d on_border(const Vector3d& point, const Corners& facet) {
  const Vector3d second = facet.corner + facet.to_second;
  Vector3d nearest = on_edge(point, facet.corner, facet.to_second);
  for (const Vector3d& other : {on_edge(point, facet.corner, facet.to_third),
                                on_edge(point, second, facet.to_third - facet.to_second)}) {
    if ((other - point).squaredNorm() < (nearest - point).squaredNorm()) nearest = other;
  }
  return nearest;
}

/// The point of a facet nearest to `point`: by the regions of the plane that are nearest to a
/// corner, to an edge or to the inside (Ericson, Real-Time Collision Detection, 2005,
/// section 5.1.5).
Vector3d on_plane(const Vector3d& point, const Corners& facet) {
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

/// A tree of four-fold nodes, each made by parting twice. What is below the root's four parts is
/// made by threads of its own; nodes stand in the order in which one thread would make them.
class TreeBuilder {
 public:
  TreeBuilder(std::vector<Facet>& facets, unsigned threads)
      : facets_(facets), order_(facets.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    for (const Facet& facet : facets) {
      const Corners of(facet);
      Eigen::AlignedBox3d box(of.corner);
      box.extend(of.corner + of.to_second).extend(of.corner + of.to_third);
      boxes_.push_back(box);
    }
    if (!facets.empty()) build_root(static_cast<std::uint32_t>(facets.size()), threads);
    std::vector<Facet> sorted;
    sorted.reserve(facets.size());
    for (const std::uint32_t i : order_) sorted.push_back(facets[i]);
    facets_ = std::move(sorted);
  }

  std::vector<Node> nodes;

 private:
  using Cuts = std::array<std::uint32_t, lanes + 1>;

  void build_root(std::uint32_t count, unsigned threads) {
    const Cuts cuts = cuts_of(0, count, 0);
    Node root;
    std::array<std::vector<Node>, lanes> parts;
    parallel_for(lanes, threads, [&](std::size_t lane) {
      set_lane(root, static_cast<int>(lane), cuts, 0, parts[lane]);
    });
    nodes.push_back(root);
    for (int lane = 0; lane < lanes; ++lane) {
      const auto first = static_cast<std::uint32_t>(nodes.size());
      const auto move_behind = [first](std::uint32_t& child) {
        if ((child & FacetNode::is_facet) == 0) child += first;
      };
      move_behind(nodes.front().child[lane]);
      for (Node& node : parts[lane]) {
        for (int i = 0; i < lanes; ++i) move_behind(node.child[i]);
        nodes.push_back(node);
      }
    }
  }

  std::uint32_t build(std::uint32_t begin, std::uint32_t end, int depth, std::vector<Node>& made) {
    const auto index = static_cast<std::uint32_t>(made.size());
    made.emplace_back();
    const Cuts cuts = cuts_of(begin, end, depth);
    Node node;
    for (int lane = 0; lane < lanes; ++lane) set_lane(node, lane, cuts, depth, made);
    made[index] = node;
    return index;
  }

  Cuts cuts_of(std::uint32_t begin, std::uint32_t end, int depth) {
    const std::uint32_t middle = part(begin, end, depth);
    return {begin, part(begin, middle, depth), middle, part(middle, end, depth), end};
  }

  void set_lane(Node& node, int lane, const Cuts& cuts, int depth, std::vector<Node>& made) {
    const std::uint32_t begin = cuts[lane], end = cuts[lane + 1];
    Eigen::AlignedBox3d box;
    for (std::uint32_t slot = begin; slot < end; ++slot) box.extend(boxes_[order_[slot]]);
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][lane] = begin < end ? below(box.min()[axis]) : far_away;
      node.high[axis][lane] = begin < end ? above(box.max()[axis]) : far_away;
    }
    node.child[lane] =
        end - begin > 1 ? build(begin, end, depth + 1, made) : begin | FacetNode::is_facet;
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
    facets.push_back({{corner.x(), corner.y(), corner.z()},
                      {ab.x(), ab.y(), ab.z()},
                      {ac.x(), ac.y(), ac.z()},
                      t,
                      twice_area < sliver * longest});
  }
  return facets;
}

}  // namespace

FacetTree facet_tree(const Mesh& mesh, unsigned threads) {
  FacetTree tree;
  tree.facets = facets_of(mesh);
  tree.nodes = std::move(TreeBuilder(tree.facets, threads).nodes);
  return tree;
}

Vector3d nearest_on(const Facet& facet, const Vector3d& point) {
  return facet.is_sliver ? on_border(point, Corners(facet)) : on_plane(point, Corners(facet));
}

}  // namespace skycap::geometry
