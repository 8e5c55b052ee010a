#include "sim/models/masonry/rustication.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace skycap::sim::models {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

/// Returns the part of a convex or nearly convex polygon below the level z.
Polyline2 clipped_below(const Polyline2& polygon, double z) {
  Polyline2 result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (a.y() <= z) result.push_back(a);
    if ((a.y() < z && b.y() > z) || (a.y() > z && b.y() < z)) {
      result.emplace_back(a.x() + (z - a.y()) / (b.y() - a.y()) * (b.x() - a.x()), z);
    }
  }
  return result;
}

/// Returns the points of a semicircle from the right end of its diameter across the top to the left
/// end. The number of chords between neighbouring voussoir joints is constant.
Polyline2 half_circle(const Vector2d& centre, double radius, int chords) {
  Polyline2 points;
  for (int i = 0; i <= chords; ++i) {
    const double angle = pi * i / chords;
    points.push_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return points;
}

/// Returns half a course beside or above an arch: from s = `outer` to the outline of the voussoirs,
/// or to the axis above them. `curve` is half of the outline, from the springing to the crown.
Polyline2 side_course(const Polyline2& curve, double outer, double bottom, double top) {
  Polyline2 inner;  // From the bottom up.
  const auto add = [&](double s, double z) {
    if (inner.empty() || (inner.back() - Vector2d(s, z)).norm() > 1e-6) inner.emplace_back(s, z);
  };
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const Vector2d &low = curve[i], &high = curve[i + 1];
    const auto at = [&](double z) {
      return low.x() + (z - low.y()) / (high.y() - low.y()) * (high.x() - low.x());
    };
    if (high.y() <= bottom || low.y() >= top) continue;
    add(low.y() < bottom ? at(bottom) : low.x(), std::max(low.y(), bottom));
    add(high.y() > top ? at(top) : high.x(), std::min(high.y(), top));
  }
  if (curve.back().y() < top) {
    add(curve.back().x(), std::max(curve.back().y(), bottom));
    add(curve.back().x(), top);
  }
  Polyline2 polygon{{outer, bottom}};
  polygon.insert(polygon.end(), inner.begin(), inner.end());
  polygon.emplace_back(outer, top);
  if (outer > curve.back().x()) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

/// Adds a rectangular stone with subdivided horizontal sides, so that it can follow a curved plan.
void add_stone(double left, double right, double bottom, double top, int chords, Wall& wall) {
  Polyline2 stone;
  for (int i = 0; i <= chords; ++i) stone.emplace_back(left + (right - left) * i / chords, bottom);
  for (int i = chords; i >= 0; --i) stone.emplace_back(left + (right - left) * i / chords, top);
  wall.tiles.push_back(stone);
}

/// Bay of a rusticated wall: an arched opening, its voussoirs and the courses beside it.
class ArchedBay {
 public:
  ArchedBay(const Courses& courses, const Opening& opening, const Voussoirs& voussoirs,
            double half_width, const Fineness& fineness, Wall& wall)
      : courses_(courses),
        opening_(opening),
        voussoirs_(voussoirs),
        half_width_(half_width),
        springing_(opening.head.front().y()),
        radius_(opening.half_width),
        widest_chord_(chord_length(fineness, wall.plan.length() / (2.0 * pi))),
        wall_(wall) {
    const Vector2d centre(opening.centre, springing_);
    const double outer_radius = radius_ + voussoirs.height;
    assert(outer_radius < half_width);
    // At least twice as many chords as voussoirs, so that an odd number of stones still has a
    // vertex at the crown.
    chords_each_ = 2 * std::max(1, fineness.chords(outer_radius, 0.5 * pi / voussoirs.count));
    const int chords = chords_each_ * voussoirs.count;
    intrados_ = half_circle(centre, radius_, chords);
    extrados_ = half_circle(centre, outer_radius, chords);
  }

  void build() {
    add_opening();
    add_voussoirs();
    for (int course = 0; course <= courses_.count; ++course) add_course(course);
  }

 private:
  void add_opening() {
    Opening fitted = opening_;
    fitted.head = intrados_;
    // The rows of a niche require the course levels on both sides of the opening.
    if (opening_.back == Opening::Back::round) {
      Polyline2 left_side;
      fitted.head.clear();
      for (int course = 0; course <= courses_.count; ++course) {
        const double z = courses_.level(course + 1);
        if (z <= opening_.sill + 1e-6 || z >= springing_ - 1e-6) continue;
        fitted.head.emplace_back(opening_.centre + radius_, z);
        left_side.emplace_back(opening_.centre - radius_, z);
      }
      fitted.head.insert(fitted.head.end(), intrados_.begin(), intrados_.end());
      fitted.head.insert(fitted.head.end(), left_side.rbegin(), left_side.rend());
    }
    wall_.openings.push_back(fitted);
  }

  void add_voussoirs() {
    for (int stone = 0; stone < voussoirs_.count; ++stone) {
      Polyline2 polygon;
      const int first = stone * chords_each_;
      for (int i = 0; i <= chords_each_; ++i) polygon.push_back(extrados_[first + i]);
      for (int i = chords_each_; i >= 0; --i) polygon.push_back(intrados_[first + i]);
      polygon = clipped_below(polygon, wall_.top);
      wall_.tiles.push_back(polygon);
    }
  }

  void add_course(int course) {
    const double bottom = courses_.level(course), top = courses_.level(course + 1);
    const bool is_even = course % 2 == 0;
    if (top <= opening_.sill + 1e-6) {
      add_whole_course(is_even, bottom, top);
    } else if (top <= springing_ + 1e-6) {
      add_piers(is_even, bottom, top);
    } else {
      add_arch_sides(bottom, top);
    }
  }

  /// Three stones, or two halves in between.
  void add_whole_course(bool is_even, double bottom, double top) {
    const std::vector<double> joints =
        is_even ? std::vector<double>{-1.0, -0.36, 0.36, 1.0} : std::vector<double>{-1.0, 0.0, 1.0};
    for (std::size_t i = 0; i + 1 < joints.size(); ++i) {
      add_stones(opening_.centre + joints[i] * half_width_,
                 opening_.centre + joints[i + 1] * half_width_, bottom, top);
    }
  }

  /// One stone, or two.
  void add_piers(bool is_even, double bottom, double top) {
    const double centre = opening_.centre;
    const double left = centre - half_width_, right = centre + half_width_;
    const double inner_left = centre - radius_, inner_right = centre + radius_;
    if (is_even) {
      add_stones(left, inner_left, bottom, top);
      add_stones(inner_right, right, bottom, top);
      return;
    }
    const double joint = 0.5 * (half_width_ + radius_);
    add_stones(left, centre - joint, bottom, top);
    add_stones(centre - joint, inner_left, bottom, top);
    add_stones(inner_right, centre + joint, bottom, top);
    add_stones(centre + joint, right, bottom, top);
  }

  void add_arch_sides(double bottom, double top) {
    const auto crown = static_cast<std::ptrdiff_t>(extrados_.size() / 2);
    const Polyline2 right_curve(extrados_.begin(), extrados_.begin() + crown + 1);
    const Polyline2 left_curve(extrados_.rbegin(), extrados_.rbegin() + crown + 1);
    const double left = opening_.centre - half_width_, right = opening_.centre + half_width_;
    wall_.tiles.push_back(side_course(left_curve, left, bottom, top));
    wall_.tiles.push_back(side_course(right_curve, right, bottom, top));
  }

  void add_stones(double start, double end, double bottom, double top) {
    const int cuts = static_cast<int>(std::ceil((end - start) / widest_chord_));
    add_stone(start, end, bottom, top, cuts, wall_);
  }

  const Courses& courses_;
  const Opening& opening_;
  const Voussoirs& voussoirs_;
  double half_width_, springing_, radius_, widest_chord_;
  Wall& wall_;
  int chords_each_ = 0;
  /// Outlines of the voussoirs, from the right springing to the left one.
  Polyline2 intrados_, extrados_;
};

}  // namespace

void add_arched_bay(const Courses& courses, const Opening& opening, const Voussoirs& voussoirs,
                    double half_width, const Fineness& fineness, Wall& wall) {
  ArchedBay(courses, opening, voussoirs, half_width, fineness, wall).build();
}

void add_plain_courses(const Courses& courses, double start, double end, Wall& wall) {
  for (int course = 0; course <= courses.count; ++course) {
    add_stone(start, end, courses.level(course), courses.level(course + 1), 1, wall);
  }
}

void add_ring_courses(double bottom, double height, int count, int stones, const Fineness& fineness,
                      Wall& wall) {
  const double step = wall.plan.length() / stones;
  const double radius = wall.plan.length() / (2.0 * pi);
  const int chords = fineness.chords(radius, 2.0 * pi / stones);
  for (int course = 0; course < count; ++course) {
    const double low = bottom + course * height, high = low + height;
    for (int i = 0; i < stones; ++i) {
      const double start = (i + 0.5 * (course % 2)) * step;
      add_stone(start, start + step, low, high, chords, wall);
    }
  }
}

}  // namespace skycap::sim::models
