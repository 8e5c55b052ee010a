#include "geometry/surfaces/facet_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/parallel.h"

namespace skycap::geometry {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Vector3d;
using Node = FacetNode;

constexpr int lanes = FacetNode::lanes;

/// Corner and edge vectors of a facet.
struct Corners {
  explicit Corners(const Facet& facet)
      : corner(facet.corner), to_second(facet.to_second), to_third(facet.to_third) {}

  Vector3d corner, to_second, to_third;
};

/// Returns the foot of a point on the segment from `corner` along `edge`.
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

/// Returns the point of a facet nearest to `point`. Distinguishes the regions of the plane nearest
/// to a corner, an edge or the interior (Ericson, Real-Time Collision Detection, 2005, section
/// 5.1.5).
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

/// Rounds to the nearest float that is not above, or not below, the number.
float below(double x) {
  const auto rounded = static_cast<float>(x);
  return rounded > x ? std::nextafter(rounded, -std::numeric_limits<float>::infinity()) : rounded;
}
float above(double x) { return -below(-x); }

/// Height of a triangle, as a fraction of its longest edge, below which its plane is inaccurate.
constexpr double sliver = 1e-6;

Facet make_facet(const Mesh& mesh, std::uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vector3d &corner = mesh.vertices[a], ab = mesh.vertices[b] - corner,
                 ac = mesh.vertices[c] - corner;
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
  return {{corner.x(), corner.y(), corner.z()},
          {ab.x(), ab.y(), ab.z()},
          {ac.x(), ac.y(), ac.z()},
          triangle,
          ab.cross(ac).norm() < sliver * longest};
}

bool has_area(const Facet& facet) {
  const Corners of(facet);
  return of.to_second.cross(of.to_third).norm() != 0.0;
}

/// Limit of box coordinates while the tree is built, so that box centres are finite.
constexpr float far_off = 1e37F;
constexpr float endless = std::numeric_limits<float>::infinity();

float within(float x) { return std::clamp(x, -far_off, far_off); }
float high_end(float x) {
  if (x < far_off) return x;
  return endless;
}
float low_end(float x) { return -high_end(-x); }

/// Input of the tree: conservative single-precision bounding box of a triangle.
struct Item {
  AlignedBox3f box;
  std::uint32_t triangle = 0;

  Item() = default;
  explicit Item(const Facet& facet) : triangle(facet.index) {
    const Corners of(facet);
    Eigen::AlignedBox3d exact(of.corner);
    exact.extend(of.corner + of.to_second).extend(of.corner + of.to_third);
    for (int axis = 0; axis < 3; ++axis) {
      box.min()[axis] = within(below(exact.min()[axis]));
      box.max()[axis] = within(above(exact.max()[axis]));
    }
  }
  /// Returns twice the centre of the box.
  float middle(Eigen::Index axis) const { return box.min()[axis] + box.max()[axis]; }
};

/// Returns the items of all triangles with an area, in mesh order.
std::vector<Item> make_items(const Mesh& mesh, unsigned threads) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<Item> items(mesh.triangles.size());
  parallel_for_each(items.size(), threads, [&](std::size_t t) {
    const Facet facet = make_facet(mesh, static_cast<std::uint32_t>(t));
    items[t] = Item(facet);
    if (!has_area(facet)) items[t].triangle = none;
  });
  std::erase_if(items, [](const Item& item) { return item.triangle == none; });
  return items;
}

/// Builds a tree of four-way nodes, each made by two binary splits. The four subtrees of the root
/// are built by separate threads. Nodes have the order in which a single thread would create them,
/// and items are sorted into tree order.
class TreeBuilder {
 public:
  TreeBuilder(std::vector<Item>& items, unsigned threads) : items_(items) {
    if (!items.empty()) build_root(static_cast<std::uint32_t>(items.size()), threads);
  }

  std::vector<Node> nodes;

 private:
  using Cuts = std::array<std::uint32_t, lanes + 1>;

  void build_root(std::uint32_t count, unsigned threads) {
    const Cuts cuts = find_cuts(0, count, 0);
    Node root;
    std::array<std::vector<Node>, lanes> parts;
    parallel_for(lanes, threads, [&](std::size_t lane) {
      set_lane(root, static_cast<int>(lane), cuts, 0, parts[lane]);
    });
    std::size_t all = 1;
    for (const std::vector<Node>& part : parts) all += part.size();
    nodes.reserve(all);
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
      parts[lane] = {};
    }
  }

  std::uint32_t build(std::uint32_t begin, std::uint32_t end, int depth, std::vector<Node>& made) {
    const auto index = static_cast<std::uint32_t>(made.size());
    made.emplace_back();
    const Cuts cuts = find_cuts(begin, end, depth);
    Node node;
    for (int lane = 0; lane < lanes; ++lane) set_lane(node, lane, cuts, depth, made);
    made[index] = node;
    return index;
  }

  Cuts find_cuts(std::uint32_t begin, std::uint32_t end, int depth) {
    const std::uint32_t middle = part(begin, end, depth);
    return {begin, part(begin, middle, depth), middle, part(middle, end, depth), end};
  }

  void set_lane(Node& node, int lane, const Cuts& cuts, int depth, std::vector<Node>& made) {
    const std::uint32_t begin = cuts[lane], end = cuts[lane + 1];
    AlignedBox3f box;
    for (std::uint32_t slot = begin; slot < end; ++slot) box.extend(items_[slot].box);
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][lane] = begin < end ? low_end(box.min()[axis]) : endless;
      node.high[axis][lane] = begin < end ? high_end(box.max()[axis]) : endless;
    }
    node.child[lane] =
        end - begin > 1 ? build(begin, end, depth + 1, made) : begin | FacetNode::is_facet;
  }

  /// Sorts the slots into two non-empty parts and returns the start of the second part.
  std::uint32_t part(std::uint32_t begin, std::uint32_t end, int depth) {
    if (end - begin < 2) return end;
    AlignedBox3f middles;
    for (std::uint32_t slot = begin; slot < end; ++slot) {
      const AlignedBox3f& box = items_[slot].box;
      middles.extend(box.min() + box.max());
    }
    Eigen::Index axis = 0;
    const float length = middles.sizes().maxCoeff(&axis);
    const float scale = slabs / length;
    if (std::isfinite(scale) && depth < max_cuts) {
      return cut({begin, end, axis, middles.min()[axis], scale});
    }
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                     [&](const Item& a, const Item& b) {
                       const float at_a = a.middle(axis), at_b = b.middle(axis);
                       return at_a != at_b ? at_a < at_b : a.triangle < b.triangle;
                     });
    return middle;
  }

  /// Slots to be split along an axis that is divided into `slabs` equal parts.
  struct Range {
    std::uint32_t begin, end;
    Eigen::Index axis;
    float low, scale;
  };

  struct Group {
    AlignedBox3f box;
    std::uint32_t count = 0;

    void add(const AlignedBox3f& other, std::uint32_t how_many = 1) {
      box.extend(other);
      count += how_many;
    }
    /// Returns the traversal cost: surface area of the box times number of items.
    double cost() const {
      if (count == 0) return 0.0;
      const Vector3d side = box.sizes().cast<double>();
      return count * (side.x() * side.y() + side.y() * side.z() + side.z() * side.x());
    }
  };

  static std::size_t find_slab(const Item& item, const Range& range) {
    return std::min<std::size_t>(
        slabs - 1, static_cast<std::size_t>((item.middle(range.axis) - range.low) * range.scale));
  }

  /// Splits between the two slabs with the minimum total cost.
  std::uint32_t cut(const Range& range) {
    std::array<Group, slabs> groups;
    for (std::uint32_t slot = range.begin; slot < range.end; ++slot) {
      groups[find_slab(items_[slot], range)].add(items_[slot].box);
    }
    std::array<double, slabs> cost_from{};
    Group sum;
    for (std::size_t i = slabs - 1; i > 0; --i) {
      sum.add(groups[i].box, groups[i].count);
      cost_from[i] = sum.cost();
    }
    sum = {};
    double min = std::numeric_limits<double>::infinity();
    std::size_t last = 0;  // last slab of the first part
    for (std::size_t i = 0; i + 1 < slabs; ++i) {
      sum.add(groups[i].box, groups[i].count);  // the first and the last slab are never empty
      if (const double cost = sum.cost() + cost_from[i + 1]; cost < min) {
        min = cost;
        last = i;
      }
    }
    const auto second =
        std::partition(items_.begin() + range.begin, items_.begin() + range.end,
                       [&](const Item& item) { return find_slab(item, range) <= last; });
    return static_cast<std::uint32_t>(second - items_.begin());
  }

  static constexpr std::size_t slabs = 16;
  static constexpr int max_cuts =
      12;  ///< levels with cost-based splits; below them, parts are halved by count

  std::vector<Item>& items_;
};

}  // namespace

FacetTree facet_tree(const Mesh& mesh, unsigned threads) {
  std::vector<Item> items = make_items(mesh, threads);
  FacetTree tree;
  tree.nodes = std::move(TreeBuilder(items, threads).nodes);
  tree.facets.resize(items.size());
  parallel_for_each(items.size(), threads,
                    [&](std::size_t i) { tree.facets[i] = make_facet(mesh, items[i].triangle); });
  return tree;
}

Vector3d nearest_on(const Facet& facet, const Vector3d& point) {
  return facet.is_sliver ? on_border(point, Corners(facet)) : on_plane(point, Corners(facet));
}

}  // namespace skycap::geometry
