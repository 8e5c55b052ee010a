/// Ray-triangle test with the decisions specified in ray_kernels.h. For sources that are compiled
/// for one instruction set each.
///
/// Names follow the paper: x, y and depth are coordinates of the corners a, b, c relative to the
/// ray's origin. They are sheared such that the ray runs along the depth. u, v, w are twice the
/// signed areas of bc, ca, ab with the ray. The rounding of two float products and their difference
/// is monotone, so these areas have the correct sign or are zero. Double precision, in which such
/// products are exact, decides two cases: an area is zero, or the triangle is so thin that rounding
/// could move the hit out of the padded boxes.
#pragma once

#include <cstdint>

#include "sim/scene/lanes_body.h"
#include "sim/scene/ray_kernels.h"
#include "sim/scene/tree_layout.h"

namespace skycap::sim {
namespace {

// Rays: one or sixteen.
template <typename Lanes>
struct Rays {
  Lanes origin[3], direction[3];
};

constexpr float infinity = __builtin_inff();

// Current hits of rays. Before the first hit, the distance is the reach. If any hit suffices, the
// distance of a hit is -infinity, so that no nearer one is searched.
template <typename Lanes>
struct Nearest {
  Lanes distance;
  LaneMask<Lanes> is_hit;
  Lanes triangle;  // Bits of the triangle number.
  Lanes normal[3];
};

enum class HitQuery { distance, surface, any };

template <typename Number>
struct Areas {
  Number u, v, w;
};
template <typename Number>
inline Areas<Number> areas(const Number (&x)[3], const Number (&y)[3]) {
  return {x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2], x[1] * y[0] - y[1] * x[0]};
}

// Returns the depth of the hit: the corner depths weighted by their areas.
template <typename Number>
inline Number mean_depth(const Number& v, const Number& w, const Number& area,
                         const Number (&depth)[3]) {
  return depth[0] + (v * (depth[1] - depth[0]) + w * (depth[2] - depth[0])) / area;
}

template <typename Lanes>
struct ShearedTriangle {
  Lanes x[3], y[3], depth[3];
};

// Computes the distance in double precision, negative without a hit. `inverse` is the inverse of
// the direction along the depth.
inline float exact_distance(const ShearedTriangle<float>& triangle, float inverse) {
  double x[3], y[3], depth[3];
  for (int i = 0; i < 3; ++i) {
    x[i] = triangle.x[i];
    y[i] = triangle.y[i];
    depth[i] = triangle.depth[i];
  }
  const auto [u, v, w] = areas(x, y);
  const bool is_negative = (u < 0.0) | (v < 0.0) | (w < 0.0);
  const bool is_positive = (u > 0.0) | (v > 0.0) | (w > 0.0);
  const auto distance =
      static_cast<float>(mean_depth(v, w, (u + v) + w, depth) * static_cast<double>(inverse));
  // Both signs: the ray misses. Neither: the triangle is seen edge-on.
  return is_negative != is_positive ? distance : -1.0F;
}
[[gnu::noinline]] Floats exact_distance(const ShearedTriangle<Floats>& triangle,
                                        const Floats& inverse) {
  struct alignas(64) Lane {
    float of[lane_count];
  } x[3], y[3], depth[3], inverses, distances;
  for (int i = 0; i < 3; ++i) {
    store(triangle.x[i], x[i].of);
    store(triangle.y[i], y[i].of);
    store(triangle.depth[i], depth[i].of);
  }
  store(inverse, inverses.of);
  for (int i = 0; i < lane_count; ++i) {
    distances.of[i] = exact_distance({{x[0].of[i], x[1].of[i], x[2].of[i]},
                                      {y[0].of[i], y[1].of[i], y[2].of[i]},
                                      {depth[0].of[i], depth[1].of[i], depth[2].of[i]}},
                                     inverses.of[i]);
  }
  return load(distances.of);
}

// Compares triangle numbers: among equal distances, the smaller number wins.
inline Truth is_smaller(std::uint32_t number, float other) {
  return {number < __builtin_bit_cast(std::uint32_t, other)};
}
[[gnu::noinline]] Mask is_smaller(std::uint32_t number, const Floats& others) {
  alignas(64) float other[lane_count];
  store(others, other);
  std::uint32_t smaller = 0;
  for (int i = 0; i < lane_count; ++i)
    smaller |= (any(is_smaller(number, other[i])) ? 1U : 0U) << i;
  return make_mask(smaller);
}

// Test of triangle leaves. Rays with different main axes traverse the tree together, but each is
// tested along its own main axis.
template <typename Lanes, HitQuery query>
class TriangleTest {
 public:
  // `extent` is that of the triangles' tree.
  TriangleTest(const Rays<Lanes>& rays, const LaneMask<Lanes>& active, float extent,
               const SceneCopy* copy)
      : origin_{rays.origin[0], rays.origin[1], rays.origin[2]},
        min_area_factor_(0.0625F / extent),
        copy_(copy) {
    const auto& direction = rays.direction;
    const Lanes x = magnitude(direction[0]), y = magnitude(direction[1]),
                z = magnitude(direction[2]);
    is_along_[0] = is_at_most(y, x) & is_at_most(z, x) & active;
    is_along_[1] = is_less(x, y) & is_at_most(z, y) & active;
    is_along_[2] = is_less(x, z) & is_less(y, z) & active;
    const Lanes main =
        chosen(is_along_[0], direction[0], chosen(is_along_[1], direction[1], direction[2]));
    inverse_ = every<Lanes>(1.0F) / main;
    for (int axis = 0; axis < 3; ++axis) {
      shear_[axis] = direction[axis] * inverse_;
      is_some_along_[axis] = any(is_along_[axis]);
    }
  }

  // Returns true if a ray hits one of the leaf's triangles.
  bool operator()(TreeRef leaf, const LaneMask<Lanes>&, Nearest<Lanes>& nearest) const {
    bool is_met = false;
    if (is_some_along_[0]) is_met |= test_all<0>(leaf, nearest);
    if (is_some_along_[1]) is_met |= test_all<1>(leaf, nearest);
    if (is_some_along_[2]) is_met |= test_all<2>(leaf, nearest);
    return is_met;
  }

 private:
  template <int main>
  bool test_all(TreeRef leaf, Nearest<Lanes>& nearest) const {
    const auto* const triangles = reinterpret_cast<const LeafTriangle*>(leaf & ~tree_ref_entries);
    bool is_met = false;
    for (TreeRef i = 0; i < (leaf & tree_ref_entries); ++i) {
      is_met |= test<main>(triangles[i], nearest);
    }
    return is_met;
  }

  template <int main>
  [[gnu::always_inline]] bool test(const LeafTriangle& triangle, Nearest<Lanes>& nearest) const {
    const ShearedTriangle<Lanes> sheared = sheared_along<main>(triangle);
    const auto [u, v, w] = areas(sheared.x, sheared.y);
    // Positive: all areas have equal signs. Zero: equal signs except for zeros.
    const Lanes agreement = max(min(u, min(v, w)), -max(u, max(v, w)));
    const Lanes zero = every<Lanes>(0.0F);
    const auto inside = is_at_most(zero, agreement) & is_along_[main];
    if (!any(inside)) return false;

    const Lanes area = (u + v) + w;
    const auto is_settled =
        is_less(zero, agreement) & is_less(every<Lanes>(min_area<main>(triangle)), magnitude(area));
    Lanes distance = mean_depth(v, w, area, sheared.depth) * inverse_;
    if (__builtin_expect(any(inside & !is_settled), 0)) {
      distance = chosen(is_settled, distance, exact_distance(sheared, inverse_));
    }
    const auto met = inside & is_at_most(zero, distance) & is_at_most(distance, nearest.distance);
    return any(met) && update_nearest(triangle, met, distance, nearest);
  }

  template <int main>
  [[gnu::always_inline]] ShearedTriangle<Lanes> sheared_along(const LeafTriangle& triangle) const {
    constexpr int x = (main + 1) % 3, y = (main + 2) % 3;
    ShearedTriangle<Lanes> sheared;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const auto relative = [&](int axis) {
        return every<Lanes>(triangle.corners[i][axis]) - origin_[axis];
      };
      sheared.depth[i] = relative(main);
      sheared.x[i] = relative(x) - shear_[x] * sheared.depth[i];
      sheared.y[i] = relative(y) - shear_[y] * sheared.depth[i];
    }
    return sheared;
  }

  // Returns the area above which single precision suffices.
  //
  // Let e be 2^-24 and R the largest coordinate relative to the ray's origin, which is at least the
  // extent of the tree. Let L be the extent of x and y, at least as large as both if the ray is
  // inside, and D the extent of the depth. Then the error of u, v and w is at most 4 e L^2, and
  // that of the hit depth 12 e L^2 D / area, which is less than 192 e R above this area. Rounding
  // adds 7 e R for the corners, 8 e R for mean depth and distance, and 6 e R for the box
  // arithmetic. The boxes are padded by 256 e R.
  template <int main>
  float min_area(const LeafTriangle& triangle) const {
    float size[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto& [a, b, c] = triangle.corners;
      size[axis] = max(a[axis], max(b[axis], c[axis])) - min(a[axis], min(b[axis], c[axis]));
    }
    const float across = max(size[(main + 1) % 3], size[(main + 2) % 3]) + size[main];
    return across * across * size[main] * min_area_factor_;
  }

  [[gnu::always_inline]] bool update_nearest(const LeafTriangle& triangle, LaneMask<Lanes> met,
                                             const Lanes& distance, Nearest<Lanes>& nearest) const {
    if constexpr (query == HitQuery::surface) {
      const std::uint32_t number =
          copy_ == nullptr ? triangle.number : triangle.number + copy_->first_triangle;
      const auto is_tie = met & nearest.is_hit & is_equal(distance, nearest.distance);
      if (__builtin_expect(any(is_tie), 0)) {
        met = met & ((!is_tie) | is_smaller(number, nearest.triangle));
        if (!any(met)) return false;
      }
      nearest.triangle =
          chosen(met, every<Lanes>(__builtin_bit_cast(float, number)), nearest.triangle);
      float normal[3];
      find_normal(triangle, normal);
      for (int axis = 0; axis < 3; ++axis) {
        nearest.normal[axis] = chosen(met, every<Lanes>(normal[axis]), nearest.normal[axis]);
      }
    }
    nearest.distance =
        chosen(met, query == HitQuery::any ? every<Lanes>(-infinity) : distance, nearest.distance);
    nearest.is_hit = nearest.is_hit | met;
    return true;
  }

  void find_normal(const LeafTriangle& triangle, float (&normal)[3]) const {
    const auto& [a, b, c] = triangle.corners;
    const float ab[] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const float ac[] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const float local[] = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                           ab[0] * ac[1] - ab[1] * ac[0]};
    for (int axis = 0; axis < 3; ++axis) {
      if (copy_ == nullptr) {
        normal[axis] = local[axis];
        continue;
      }
      const float(&row)[3] = copy_->scene_from_local[axis];
      normal[axis] = (row[0] * local[0] + row[1] * local[1]) + row[2] * local[2];
    }
  }

  Lanes origin_[3];
  LaneMask<Lanes> is_along_[3];  // Active rays by main axis.
  bool is_some_along_[3];
  Lanes inverse_;   // Inverse of the direction along the main axis.
  Lanes shear_[3];  // Direction relative to its component along the main axis.
  float min_area_factor_;
  const SceneCopy* copy_;  // Copy that contains the triangles, or null.
};

}  // namespace
}  // namespace skycap::sim
