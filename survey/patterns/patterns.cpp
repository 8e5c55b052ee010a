#include "survey/patterns/patterns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "geometry/pose/prism.h"

namespace skycap::survey::patterns {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<const char*, 6> names{"nadir",  "oblique", "dome",
                                           "facade", "rings",   "corridor"};
constexpr double degree = std::numbers::pi / 180.0;

/// Returns centred positions from `low` to `high` with at most `spacing` between them.
std::vector<double> row(double low, double high, double spacing) {
  const double length = std::max(0.0, high - low);
  const auto steps = static_cast<int>(std::ceil(length / spacing - 1e-9));
  std::vector<double> positions;
  const double first = 0.5 * (low + high) - 0.5 * steps * spacing;
  for (int i = 0; i <= steps; ++i) positions.push_back(first + i * spacing);
  return positions;
}

/// Returns the corners of the convex hull, counter-clockwise (monotone chain; Andrew, 1979).
std::vector<Vector2d> convex_hull(std::vector<Vector2d> points) {
  if (points.empty()) return {};
  std::ranges::sort(points, [](const Vector2d& a, const Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Vector2d> hull;
  const auto extend = [&](const Vector2d& point, std::size_t kept) {
    while (hull.size() > kept && geometry::turn(hull[hull.size() - 2], hull.back(), point) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const Vector2d& point : points) extend(point, 1);
  const std::size_t lower = hull.size();
  for (auto point = points.rbegin() + 1; point < points.rend(); ++point) extend(*point, lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

/// Removes consecutive equal points.
std::vector<Vector2d> without_repeats(const std::vector<Vector2d>& points) {
  std::vector<Vector2d> distinct;
  for (const Vector2d& point : points) {
    if (distinct.empty() || (point - distinct.back()).norm() > 1e-9) distinct.push_back(point);
  }
  return distinct;
}

double distance_to_segment(const Vector2d& point, const Vector2d& from, const Vector2d& to) {
  const Vector2d along = to - from;
  const double squared = along.squaredNorm();
  const double share =
      squared > 0.0 ? std::clamp((point - from).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (point - from - share * along).norm();
}

double distance_to_line(const Vector2d& point, std::span<const Vector2d> line) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    least = std::min(least, distance_to_segment(point, line[i], line[i + 1]));
  }
  return least;
}

/// Returns the distance from a polygon; zero inside.
double distance_to_area(const Vector2d& point, const std::vector<Vector2d>& area) {
  if (geometry::contains(area, point)) return 0.0;
  return std::min(distance_to_line(point, area),
                  distance_to_segment(point, area.back(), area.front()));
}

/// Straight axis of a structure and its width across this axis [m].
struct Axis {
  std::vector<Vector2d> line;
  double width = 0.0;
};

/// Returns the long axis of the rectangle with the least area around a convex hull. One of its
/// sides contains an edge of the hull (Freeman and Shapira, 1975).
Axis find_long_axis(const std::vector<Vector2d>& hull) {
  Axis axis;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
    if (edge.norm() < 1e-9) continue;
    const Vector2d along = edge.normalized(), across(-along.y(), along.x());
    Eigen::AlignedBox2d box;
    for (const Vector2d& corner : hull) {
      box.extend(Vector2d(corner.dot(along), corner.dot(across)));
    }
    if (box.volume() >= least) continue;
    least = box.volume();
    const bool is_along = box.sizes().x() >= box.sizes().y();
    const Vector2d centre = box.center().x() * along + box.center().y() * across;
    const Vector2d half = 0.5 * box.sizes().maxCoeff() * (is_along ? along : across);
    axis = {{centre - half, centre + half}, box.sizes().minCoeff()};
  }
  return axis;
}

/// Position on a path beside a line, and the level direction to the line.
struct BesideLine {
  Vector2d position, towards;
};

/// Returns evenly spaced positions at the distance |offset| from a line, to its left if `offset` is
/// positive. Arcs lead around outer corners; positions that another part of the line is closer to
/// are skipped.
std::vector<BesideLine> beside_line(const std::vector<Vector2d>& line, double offset,
                                    double spacing) {
  const double side = offset < 0.0 ? -1.0 : 1.0, radius = std::abs(offset);
  const std::size_t segments = line.size() - 1;
  std::vector<double> arcs(segments, 0.0);  // angle of the arc before each segment
  double length = 0.0;
  const auto along = [&](std::size_t i) { return Vector2d((line[i + 1] - line[i]).normalized()); };
  for (std::size_t i = 0; i < segments; ++i) {
    if (i > 0) {
      const Vector2d before = along(i - 1), after = along(i);
      const double turn =
          std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
      arcs[i] = std::max(0.0, -side * turn);
    }
    length += radius * arcs[i] + (line[i + 1] - line[i]).norm();
  }
  const double step = length / std::max(1.0, std::ceil(length / spacing - 1e-9));
  std::vector<BesideLine> path;
  const auto add = [&](const Vector2d& corner, const Vector2d& left) {
    const Vector2d position = corner + offset * left;
    if (distance_to_line(position, line) > radius - 1e-6) path.push_back({position, -side * left});
  };
  double next = 0.0, passed = 0.0;
  for (std::size_t i = 0; i < segments; ++i) {
    const double arc = radius * arcs[i];
    for (; next < passed + arc - 1e-9; next += step) {
      const Vector2d before = along(i - 1);
      add(line[i],
          Eigen::Rotation2Dd(-side * (next - passed) / radius) * Vector2d(-before.y(), before.x()));
    }
    passed += arc;
    const Vector2d direction = along(i), left(-direction.y(), direction.x());
    const double edge = (line[i + 1] - line[i]).norm();
    const double end = passed + edge + (i + 1 == segments ? 1e-6 * step : -1e-9);
    for (; next < end; next += step) {
      add(line[i] + std::min(next - passed, edge) * direction, left);
    }
    passed += edge;
  }
  return path;
}

class PatternMaker {
 public:
  PatternMaker(const Vector2d& footprint, const PatternTarget& target,
               const PatternOptions& options, const ViewCheck& allows)
      : target_(target),
        box_(target.box),
        options_(options),
        allows_(allows),
        footprint_(footprint) {}

  PatternViews take() {
    if (views_.is_too_large) views_.views.clear();
    return std::move(views_);
  }

  void nadir() {
    const double z = box_.max().z() + options_.view_distance;
    // The small level part is the azimuth of a scanner whose axis is along the rows.
    constexpr double level = 1e-3;
    const Vector3d down = options_.is_swept ? Vector3d(-level, 0.0, -std::sqrt(1.0 - level * level))
                                            : Vector3d(-Vector3d::UnitZ());
    grid({0.0, 1.0}, {0.0, 1.0}, z, down, 1.0, 0.0);
  }

  void oblique() {
    nadir();
    const double slope = options_.pitch ? std::sin(-*options_.pitch) : std::sqrt(0.5);
    const double level = options_.pitch ? std::cos(*options_.pitch) : std::sqrt(0.5);
    const double z = box_.max().z() + slope * options_.view_distance;
    const double back = (z - 0.5 * (options_.ground + box_.max().z())) * (level / slope);
    for (const Vector2d& heading :
         {Vector2d(0, 1), Vector2d(1, 0), Vector2d(0, -1), Vector2d(-1, 0)}) {
      const Vector3d direction(level * heading.x(), level * heading.y(), -slope);
      const Vector2d rows = options_.is_swept ? Vector2d(heading.y(), -heading.x()) : heading;
      grid(rows, heading, z, direction, 1.0 / slope, back);
    }
  }

  void dome() {
    constexpr double step = 15.0, orbits[] = {0.4, 0.9};
    const double height = box_.max().z() - options_.ground;
    const Vector3d middle(box_.center().x(), box_.center().y(), options_.ground + 0.5 * height);
    const double radius = 0.75 * 0.5 * box_.sizes().head<2>().norm() + options_.view_distance;
    for (const double share : orbits) {
      const double z = std::max(options_.ground + share * height, options_.min_height);
      orbit({middle.x(), middle.y(), z}, radius, 0.0, step);
    }
    for (double elevation = 30.0; elevation <= 75.0; elevation += step) {
      orbit(middle, radius, elevation * degree, step / std::cos(elevation * degree));
    }
  }

  void facade() {
    const double tilt = options_.pitch.value_or(0.0);
    for (const double z : heights(tilt)) {
      around(target_.outline, z, tilt, (1.0 - options_.forward_overlap) * footprint_.x());
    }
    nadir();
  }

  void rings() {
    const double tilt = options_.pitch.value_or(0.0);
    const Vector2d middle = box_.center().head<2>();
    double radius = options_.view_distance * std::cos(tilt);
    double most = 0.0;
    for (const Vector2d& point : target_.outline) most = std::max(most, (point - middle).norm());
    radius += most;
    const double spacing = (1.0 - options_.forward_overlap) * footprint_.x();
    const double length = 2.0 * std::numbers::pi * radius;
    for (const double z : heights(tilt)) {
      if (!fits(length / spacing)) return;
      const auto count = static_cast<int>(std::ceil(length / spacing - 1e-9));
      for (int i = 0; i < count; ++i) {
        const double azimuth = 2.0 * std::numbers::pi * i / count;
        const Vector2d outward(std::cos(azimuth), std::sin(azimuth));
        add({Vector3d(middle.x() + radius * outward.x(), middle.y() + radius * outward.y(), z),
             towards(-outward, tilt)});
      }
    }
  }

  void corridor() {
    Axis axis{without_repeats(target_.line), target_.width};
    if (target_.line.empty()) axis = find_long_axis(target_.outline);
    if (axis.line.size() < 2) return;  // The target has no horizontal extent.
    const double tilt = options_.pitch.value_or(-45.0 * degree);
    if (tilt < -89.9 * degree) return above(axis);
    const double offset = 0.5 * axis.width + options_.view_distance * std::cos(tilt);
    const std::vector<double> levels =
        tilt > -44.9 * degree ? heights(tilt) : std::vector{box_.max().z() + lift(tilt)};
    bool is_forth = true;
    for (const double side : {1.0, -1.0}) {
      for (const double z : levels) {
        lane(axis.line, side * offset, (1.0 - options_.forward_overlap) * footprint_.x(), is_forth,
             [&](const BesideLine& at) {
               add({{at.position.x(), at.position.y(), z}, towards(at.towards, tilt)});
             });
        is_forth = !is_forth;
      }
    }
  }

 private:
  /// Returns rows from `low` upwards. The last row is at `high` or less than one spacing above it.
  static std::vector<double> row_from(double low, double high, double spacing) {
    const auto steps = static_cast<int>(std::ceil((high - low) / spacing - 1e-9));
    std::vector<double> positions;
    for (int i = 0; i <= steps; ++i)
      positions.push_back(low + (steps > 0 ? (high - low) / steps : 0) * i);
    return positions;
  }

  /// Returns how far views with this pitch are above what they face [m].
  double lift(double tilt) const { return options_.view_distance * std::sin(-tilt); }

  /// Returns the heights of level rows of views with this pitch; none if they are too many.
  std::vector<double> heights(double tilt) {
    const double up = lift(tilt);
    const double low =
        up > 0.0 ? std::max(options_.min_height, options_.ground + up) : options_.min_height;
    const double high = std::max(low, box_.max().z() - 0.2 * options_.view_distance + up);
    const double spacing = (1.0 - options_.side_overlap) * footprint_.y();
    if (!fits((high - low) / spacing)) return {};
    return row_from(low, high, spacing);
  }

  static Vector3d towards(const Vector2d& level, double tilt) {
    return {std::cos(tilt) * level.x(), std::cos(tilt) * level.y(), std::sin(tilt)};
  }

  /// Returns true if the pattern may have `count` more views. Otherwise marks it as too large.
  bool fits(double count) {
    const auto now = static_cast<double>(views_.views.size() + views_.dropped);
    if (!(now + count <= static_cast<double>(options_.max_views))) views_.is_too_large = true;
    return !views_.is_too_large;
  }

  void add(const geometry::View& view) {
    if (!allows_ || allows_(view)) {
      views_.views.push_back(view);
    } else {
      ++views_.dropped;
    }
  }

  /// Adds a grid over the box at height `z`. Its rows run along `rows` in alternating directions.
  /// The top of the image is along `heading`, in which its spacing is multiplied by `stretch`.
  void grid(const Vector2d& rows, const Vector2d& heading, double z, const Vector3d& direction,
            double stretch, double back) {
    const double beside = 0.15 * options_.view_distance;
    const Vector2d across(rows.y(), -rows.x());
    const Vector2d middle = box_.center().head<2>();
    const Vector2d half = (0.5 * box_.sizes().head<2>()).array() + beside;
    const double along_half = std::abs(rows.x()) * half.x() + std::abs(rows.y()) * half.y();
    const double across_half = std::abs(across.x()) * half.x() + std::abs(across.y()) * half.y();
    const double width = footprint_.x(), height = footprint_.y();
    const double row_spacing =
        (1.0 - options_.side_overlap) * (options_.is_swept ? height * stretch : width);
    const double spacing = options_.is_swept ? (1.0 - options_.forward_overlap) * width
                                             : (1.0 - options_.forward_overlap) * height * stretch;
    if (!fits((2.0 * across_half / row_spacing + 1.0) * (2.0 * along_half / spacing + 1.0))) return;
    const double reach = 0.5 * Vector2d(width, height * stretch).norm();
    bool is_forth = true;
    for (const double b : row(-across_half, across_half, row_spacing)) {
      std::vector<double> along = row(-along_half, along_half, spacing);
      if (!is_forth) std::ranges::reverse(along);
      is_forth = !is_forth;
      for (const double a : along) {
        const Vector2d seen = middle + a * rows + b * across;
        if (!target_.area.empty() && distance_to_area(seen, target_.area) > reach) continue;
        const Vector2d at = middle + (a - back * rows.dot(heading)) * rows +
                            (b - back * across.dot(heading)) * across;
        add({{at.x(), at.y(), z}, direction});
      }
    }
  }

  void orbit(const Vector3d& centre, double radius, double elevation, double step_deg) {
    const auto count = static_cast<int>(std::ceil(360.0 / step_deg - 1e-9));
    for (int i = 0; i < count; ++i) {
      const double azimuth = 2.0 * std::numbers::pi * i / count;
      const Vector3d towards(std::cos(elevation) * std::cos(azimuth),
                             std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      add({centre + radius * towards, -towards});
    }
  }

  /// Adds rows above the structure along an axis.
  void above(const Axis& axis) {
    const double z = box_.max().z() + options_.view_distance;
    const double side = footprint_.minCoeff();
    bool is_forth = true;
    for (const double offset :
         row(-0.5 * axis.width, 0.5 * axis.width, (1.0 - options_.side_overlap) * side)) {
      lane(axis.line, offset, (1.0 - options_.forward_overlap) * side, is_forth,
           [&](const BesideLine& at) {
             add({{at.position.x(), at.position.y(), z}, -Vector3d::UnitZ()});
           });
      is_forth = !is_forth;
    }
  }

  /// Calls `visit` for the positions beside a line, in one direction or the other.
  template <typename Visit>
  void lane(const std::vector<Vector2d>& line, double offset, double spacing, bool is_forth,
            Visit visit) {
    const double turns = std::numbers::pi * static_cast<double>(line.size());  // at most
    if (!fits((length_of(line) + turns * std::abs(offset)) / spacing)) return;
    std::vector<BesideLine> path = beside_line(line, offset, spacing);
    if (!is_forth) std::ranges::reverse(path);
    for (const BesideLine& at : path) visit(at);
  }

  /// Adds evenly spaced views along the hull's edges and around its corners at the view distance.
  void around(const std::vector<Vector2d>& hull, double z, double tilt, double spacing) {
    const double d = options_.view_distance * std::cos(tilt);
    const std::size_t count = hull.size();
    if (count < 2) return;  // The target is a vertical line.
    std::vector<double> turns(count);
    double length = 0.0;
    const auto normal = [&](std::size_t i) {
      const Vector2d edge = hull[(i + 1) % count] - hull[i];
      return Vector2d(edge.y(), -edge.x()).normalized();
    };
    for (std::size_t i = 0; i < count; ++i) {
      const Vector2d before = normal((i + count - 1) % count), after = normal(i);
      turns[i] = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
      length += d * turns[i] + (hull[(i + 1) % count] - hull[i]).norm();
    }
    if (!fits(length / spacing)) return;
    const auto views = static_cast<int>(std::ceil(length / spacing - 1e-9));
    const double step = length / views;
    double next = 0.0, passed = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vector2d before = normal((i + count - 1) % count);
      const double arc = d * turns[i];
      for (; next < passed + arc - 1e-9; next += step) {
        const double angle = (next - passed) / d;
        facing(hull[i], Eigen::Rotation2Dd(angle) * before, z, tilt);
      }
      passed += arc;
      const Vector2d edge = hull[(i + 1) % count] - hull[i];
      for (; next < passed + edge.norm() - 1e-9; next += step) {
        facing(hull[i] + (next - passed) * edge.normalized(), normal(i), z, tilt);
      }
      passed += edge.norm();
    }
  }

  void facing(const Vector2d& wall, const Vector2d& outward, double z, double tilt) {
    const Vector2d at = wall + options_.view_distance * std::cos(tilt) * outward;
    add({{at.x(), at.y(), z}, towards(-outward, tilt)});
  }

  const PatternTarget& target_;
  Eigen::AlignedBox3d box_;
  const PatternOptions& options_;
  const ViewCheck& allows_;
  Vector2d footprint_;
  PatternViews views_;
};

/// Returns the horizontal box of points between two heights.
Eigen::AlignedBox3d box_around(const std::vector<Vector2d>& points, double base, double top) {
  Eigen::AlignedBox3d box;
  for (const Vector2d& point : points) {
    box.extend(Vector3d(point.x(), point.y(), base));
    box.extend(Vector3d(point.x(), point.y(), top));
  }
  return box;
}

}  // namespace

const char* to_string(Pattern pattern) { return names[static_cast<std::size_t>(pattern)]; }

std::optional<Pattern> pattern_named(std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Pattern>(found - names.begin());
}

std::string pattern_names() {
  std::string list;
  for (const char* name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

PatternTarget target_of(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  std::vector<Vector2d> plan;
  for (const Vector3d& point : points) {
    box.extend(point);
    plan.emplace_back(point.head<2>());
  }
  return {box, convex_hull(std::move(plan)), {}, {}};
}

PatternTarget target_of(const Eigen::AlignedBox3d& box) {
  const Vector3d& low = box.min();
  const Vector3d& high = box.max();
  return {box,
          convex_hull({low.head<2>(), {high.x(), low.y()}, high.head<2>(), {low.x(), high.y()}}),
          {},
          {}};
}

PatternTarget target_of_polygon(std::vector<Vector2d> polygon, double base, double top) {
  const Eigen::AlignedBox3d box = box_around(polygon, base, top);
  std::vector<Vector2d> hull = convex_hull(polygon);
  return {box, std::move(hull), std::move(polygon), {}};
}

PatternTarget target_of_line(std::vector<Vector2d> line, double width, double base, double top) {
  line = without_repeats(line);
  std::vector<Vector2d> edges;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector2d along = (line[i + 1] - line[i]).normalized();
    const Vector2d beside = 0.5 * width * Vector2d(-along.y(), along.x());
    for (const Vector2d& end : {line[i], line[i + 1]}) {
      edges.push_back(end + beside);
      if (width > 0.0) edges.push_back(end - beside);
    }
  }
  const Eigen::AlignedBox3d box = box_around(edges, base, top);
  return {box, convex_hull(std::move(edges)), {}, std::move(line), width};
}

double length_of(const std::vector<Vector2d>& line) {
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
  return length;
}

double area_of(const std::vector<Vector2d>& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i + 1 < polygon.size(); ++i) {
    twice += geometry::turn(polygon.front(), polygon[i], polygon[i + 1]);
  }
  return 0.5 * std::abs(twice);
}

PatternViews pattern_views(Pattern pattern, const Eigen::Vector2d& footprint,
                           const PatternTarget& target, const PatternOptions& options,
                           const ViewCheck& allows) {
  PatternMaker maker(footprint, target, options, allows);
  switch (pattern) {
    case Pattern::nadir:
      maker.nadir();
      break;
    case Pattern::oblique:
      maker.oblique();
      break;
    case Pattern::dome:
      maker.dome();
      break;
    case Pattern::facade:
      maker.facade();
      break;
    case Pattern::rings:
      maker.rings();
      break;
    case Pattern::corridor:
      maker.corridor();
      break;
  }
  return maker.take();
}

std::vector<geometry::View> without_passed_views(const std::vector<geometry::View>& views,
                                                 double position_tolerance,
                                                 double angle_tolerance) {
  const auto is_passed = [&](std::size_t from, std::size_t at, std::size_t to) {
    const Vector3d along = views[to].position - views[from].position;
    const double squared = along.squaredNorm();
    const double share =
        squared > 0.0 ? (views[at].position - views[from].position).dot(along) / squared : -1.0;
    if (share < 0.0 || share > 1.0) return false;
    const Vector3d on_line = views[from].position + share * along;
    if ((views[at].position - on_line).norm() > position_tolerance) return false;
    const Vector3d direction =
        ((1.0 - share) * views[from].direction + share * views[to].direction).normalized();
    return direction.dot(views[at].direction) >= std::cos(angle_tolerance);
  };
  std::vector<geometry::View> kept;
  for (std::size_t from = 0; from < views.size();) {
    kept.push_back(views[from]);
    std::size_t to = from + 1;
    const auto passes_all = [&](std::size_t end) {
      for (std::size_t at = from + 1; at < end; ++at) {
        if (!is_passed(from, at, end)) return false;
      }
      return true;
    };
    while (to + 1 < views.size() && passes_all(to + 1)) ++to;
    from = to;
  }
  return kept;
}

}  // namespace skycap::survey::patterns
