#include "geometry/surfaces/ear_clipping.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "geometry/pose/prism.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector2d;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Returns 1 for an equilateral triangle, 0 for a degenerate one, and a negative value for a
/// clockwise one.
double roundness(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return 2.0 * std::sqrt(3.0) * turn(a, b, c) / squares;
}

/// Cuts ears off a polygon, the roundest first, until a triangle remains.
class EarClipper {
 public:
  explicit EarClipper(std::span<const Vector2d> polygon)
      : polygon_(polygon), before_(polygon.size()), after_(polygon.size()) {
    const std::size_t size = polygon.size();
    for (std::size_t i = 0; i < size; ++i) {
      before_[i] = (i + size - 1) % size;
      after_[i] = (i + 1) % size;
    }
    for (std::size_t i = 1; i + 1 < size; ++i) {
      area_ += turn(polygon[0], polygon[i], polygon[i + 1]);
    }
    nothing_ = 1e-9 * area_;
    touching_ = -1e-12 * area_;
    for (std::size_t i = 0; i < size; ++i) qualities_.push_back(ear_quality(i));
  }

  Triangles clip() {
    for (std::size_t left = polygon_.size(); left > 3; --left) cut_off(best_ear());
    add(corner_left_, after_[corner_left_], after_[after_[corner_left_]]);
    return std::move(triangles_);
  }

 private:
  /// Returns the roundness of the ear at a corner, or a negative value if it cannot be cut.
  double ear_quality(std::size_t i) const {
    const Vector2d &a = polygon_[before_[i]], &b = polygon_[i], &c = polygon_[after_[i]];
    const double quality = roundness(a, b, c);
    if (!(quality > 1e-12)) return -1.0;
    for (std::size_t j = after_[after_[i]]; j != before_[i]; j = after_[j]) {
      const Vector2d& p = polygon_[j];
      if (p == a || p == b || p == c) continue;  // corner of a bridge to a hole
      if (std::min({turn(a, b, p), turn(b, c, p), turn(c, a, p)}) >= touching_) return -1.0;
    }
    return quality;
  }

  double compute_ear_area(std::size_t i) const {
    return turn(polygon_[before_[i]], polygon_[i], polygon_[after_[i]]);
  }

  /// Returns the best ear. Without any ear, as in a self-intersecting polygon or a flat remainder,
  /// returns an arbitrary remaining corner.
  std::size_t best_ear() {
    const auto best = [&] {
      return static_cast<std::size_t>(std::ranges::max_element(qualities_) - qualities_.begin());
    };
    std::size_t ear = best();
    // An ear that would leave only collinear corners must be cut after its last neighbour.
    if (area_ - compute_ear_area(ear) < nothing_) {
      qualities_[ear] = -1.0;
      ear = best();
    }
    return ear;
  }

  void cut_off(std::size_t ear) {
    area_ -= compute_ear_area(ear);
    const std::size_t a = before_[ear], c = after_[ear];
    add(a, ear, c);
    after_[a] = c;
    before_[c] = a;
    qualities_[ear] = -std::numeric_limits<double>::infinity();
    qualities_[a] = ear_quality(a);
    qualities_[c] = ear_quality(c);
    // Cutting may have removed the only obstacle of another ear.
    for (std::size_t j = after_[c]; j != a; j = after_[j]) {
      if (qualities_[j] < 0.0) qualities_[j] = ear_quality(j);
    }
    corner_left_ = a;
  }

  void add(std::size_t a, std::size_t b, std::size_t c) {
    triangles_.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                          static_cast<std::uint32_t>(c)});
  }

  std::span<const Vector2d> polygon_;
  std::vector<std::size_t> before_, after_;  ///< neighbours among the remaining corners
  std::vector<double> qualities_;
  double area_ = 0.0,
         nothing_ = 0.0;   ///< twice the remaining area, and the threshold below which it is zero
  double touching_ = 0.0;  ///< turns of at least this value count as on the side, due to rounding
  std::size_t corner_left_ = 0;
  Triangles triangles_;
};

}  // namespace

Triangles clip_ears(std::span<const Vector2d> polygon) { return EarClipper(polygon).clip(); }

}  // namespace skycap::geometry
