#include <algorithm>
#include <array>
#include <cmath>

#include "flight/paths/path.h"
#include "geometry/pose/pose.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Maximum number of rounds. Two or three usually reduce the gain below the tolerance.
constexpr int max_rounds = 8;
/// Relative gain below which a round is the last.
constexpr double round_tolerance = 1e-3;
/// Minimum slide step, relative to the path length.
constexpr double slide_tolerance = 1e-4;

class StringPuller {
 public:
  StringPuller(const FreeSpace& space, double clearance, std::vector<Vector3d> points,
               double worthwhile_saving)
      : space_(space),
        clearance_(clearance),
        worthwhile_saving_(worthwhile_saving),
        points_(std::move(points)) {}

  std::vector<Vector3d> pull() {
    skip_points();
    for (int round = 0; round < max_rounds && points_.size() > 2; ++round) {
      const double before = length(points_);
      for (std::size_t i = 1; i + 1 < points_.size(); ++i) slide(i);
      cut_corners();
      skip_points();
      if (length(points_) > (1.0 - round_tolerance) * before) break;
    }
    // First fewer stops, then optimal positions for the remaining ones.
    drop_corners_not_worthwhile();
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) slide(i);
    skip_points();
    drop_corners_not_worthwhile();
    return std::move(points_);
  }

 private:
  bool is_free(const Vector3d& from, const Vector3d& to) const {
    return space_.continues_free({from, to}, clearance_);
  }

  /// Connects each point to the last visible one.
  void skip_points() {
    std::vector<Vector3d> kept{points_.front()};
    for (std::size_t i = 0; i + 1 < points_.size();) {
      std::size_t next = points_.size() - 1;
      while (next > i + 1 && !is_free(points_[i], points_[next])) --next;
      kept.push_back(points_[next]);
      i = next;
    }
    points_ = std::move(kept);
  }

  /// Moves a point to shorten its two pieces. It tries steps towards the chord between its
  /// neighbours, along the chord and perpendicular to the plane of the three, with halved step
  /// sizes.
  void slide(std::size_t i) {
    const Vector3d &before = points_[i - 1], &after = points_[i + 1];
    const auto length_via = [&](const Vector3d& p) {
      return (p - before).norm() + (p - after).norm();
    };
    const double min_step = slide_tolerance * length(points_);
    const NearestPoints foot = nearest(Segment{before, after}, points_[i]);
    double step = std::sqrt(foot.squared_distance);
    while (step > min_step) {
      bool has_moved = false;
      for (const Vector3d& direction : slide_directions(before, points_[i], after)) {
        const Vector3d moved = points_[i] + step * direction;
        if (length_via(moved) >= length_via(points_[i]) - 0.1 * min_step) continue;
        if (!is_free(before, moved) || !is_free(moved, after)) continue;
        points_[i] = moved;
        has_moved = true;
        break;
      }
      if (!has_moved) step *= 0.5;
    }
  }

  static std::array<Vector3d, 5> slide_directions(const Vector3d& before, const Vector3d& point,
                                                  const Vector3d& after) {
    const Vector3d chord = (after - before).normalized();
    Vector3d down = nearest(Segment{before, after}, point).on_segment - point;
    down = down.squaredNorm() > 0.0 ? Vector3d(down.normalized()) : geometry::any_orthogonal(chord);
    const Vector3d across = chord.cross(down).normalized();
    return {down, across, -across, chord, -chord};
  }

  /// Replaces a corner by the widest free cut if that saves enough.
  void cut_corners() {
    const double worthwhile = worthwhile_saving_ * length(points_);
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
      const Vector3d to_before = points_[i - 1] - points_[i],
                     to_after = points_[i + 1] - points_[i];
      const double longest = 0.5 * std::min(to_before.norm(), to_after.norm());
      const auto first = [&](double cut) -> Vector3d {
        return points_[i] + cut * to_before.normalized();
      };
      const auto second = [&](double cut) -> Vector3d {
        return points_[i] + cut * to_after.normalized();
      };
      double free_cut = 0.0, blocked_cut = longest;
      if (is_free(first(longest), second(longest))) free_cut = longest;
      for (int halving = 0; halving < 8 && free_cut < longest; ++halving) {
        const double middle = 0.5 * (free_cut + blocked_cut);
        (is_free(first(middle), second(middle)) ? free_cut : blocked_cut) = middle;
      }
      if (2.0 * free_cut - (first(free_cut) - second(free_cut)).norm() <= worthwhile) continue;
      const Vector3d inserted = second(free_cut);
      points_[i] = first(free_cut);
      points_.insert(points_.begin() + static_cast<std::ptrdiff_t>(i) + 1, inserted);
      ++i;
    }
  }

  /// Replaces two neighbouring points by the intersection of the extended outer legs if that costs
  /// almost no length, because it saves a stop.
  void drop_corners_not_worthwhile() {
    const double worthwhile = worthwhile_saving_ * length(points_);
    for (std::size_t i = 1; i + 2 < points_.size();) {
      const Vector3d into = points_[i] - points_[i - 1], out = points_[i + 1] - points_[i + 2];
      const Vector3d meeting = find_closest_point_on_lines(points_[i], into, points_[i + 1], out);
      const double now = into.norm() + (points_[i + 1] - points_[i]).norm() + out.norm();
      const double then = (meeting - points_[i - 1]).norm() + (meeting - points_[i + 2]).norm();
      if (then - now < worthwhile && is_free(points_[i - 1], meeting) &&
          is_free(meeting, points_[i + 2])) {
        points_[i] = meeting;
        points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      } else {
        ++i;
      }
    }
  }

  /// Returns the midpoint between the closest points of two lines, or between their origins if
  /// parallel.
  static Vector3d find_closest_point_on_lines(const Vector3d& p, const Vector3d& u,
                                              const Vector3d& q, const Vector3d& v) {
    const double a = u.squaredNorm(), b = u.dot(v), e = v.squaredNorm();
    const double determinant = a * e - b * b;
    if (determinant <= 1e-9 * a * e) return 0.5 * (p + q);
    const Vector3d r = p - q;
    const double s = (b * v.dot(r) - e * u.dot(r)) / determinant;
    const double t = (a * v.dot(r) - b * u.dot(r)) / determinant;
    return 0.5 * (p + s * u + q + t * v);
  }

  const FreeSpace& space_;
  double clearance_;
  double worthwhile_saving_;
  std::vector<Vector3d> points_;
};

}  // namespace

std::vector<Vector3d> pull_tight(const FreeSpace& space, double clearance,
                                 std::vector<Vector3d> points, double worthwhile_saving) {
  if (points.size() < 3) return points;
  return StringPuller(space, clearance, std::move(points), worthwhile_saving).pull();
}

}  // namespace skycap::flight
