#include "survey/photo/patterns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace skycap::survey::photo {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<const char*, 4> names{"nadir", "oblique", "dome", "facade"};
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

class PatternMaker {
 public:
  PatternMaker(const geometry::PhotoCamera& camera, const geometry::Mesh& target,
               const PatternOptions& options, const PhotoSpace& space)
      : target_(target), box_(bounding_box(target)), options_(options), space_(space) {
    footprint_ = options.view_distance / camera.focal_length_px() *
                 Vector2d(camera.width(), camera.height());
  }

  PatternPhotos take() {
    if (photos_.is_too_large) photos_.views.clear();
    return std::move(photos_);
  }

  void nadir() {
    const double z = box_.max().z() + options_.view_distance;
    grid({0.0, 1.0}, z, -Vector3d::UnitZ(), 1.0, 0.0);
  }

  void oblique() {
    nadir();
    const double slope = std::sqrt(0.5);
    const double z = box_.max().z() + slope * options_.view_distance;
    const double back = z - 0.5 * (options_.ground + box_.max().z());
    for (const Vector2d& heading :
         {Vector2d(0, 1), Vector2d(1, 0), Vector2d(0, -1), Vector2d(-1, 0)}) {
      const Vector3d direction = slope * Vector3d(heading.x(), heading.y(), -1.0);
      grid(heading, z, direction, 1.0 / slope, back);
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
    std::vector<Vector2d> points;
    for (const auto& triangle : target_.triangles) {
      for (const std::uint32_t v : triangle) points.emplace_back(target_.vertices[v].head<2>());
    }
    const std::vector<Vector2d> hull = convex_hull(std::move(points));
    const double low = options_.min_height;
    const double high = std::max(low, box_.max().z() - 0.2 * options_.view_distance);
    const double spacing = (1.0 - options_.side_overlap) * footprint_.y();
    if (fits((high - low) / spacing)) {
      for (const double z : row_from(low, high, spacing)) {
        around(hull, z, (1.0 - options_.forward_overlap) * footprint_.x());
      }
    }
    nadir();
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

  /// Returns true if the pattern may have `count` more photos. Otherwise marks it as too large.
  bool fits(double count) {
    const auto now = static_cast<double>(photos_.views.size() + photos_.dropped);
    if (!(now + count <= static_cast<double>(options_.max_photos))) photos_.is_too_large = true;
    return !photos_.is_too_large;
  }

  void add(const geometry::View& view) {
    if (space_.allows(view)) {
      photos_.views.push_back(view);
    } else {
      ++photos_.dropped;
    }
  }

  /// Adds a grid over the box at height `z`. Its rows run along `heading` in alternating
  /// directions.
  void grid(const Vector2d& heading, double z, const Vector3d& direction, double stretch,
            double back) {
    const double beside = 0.15 * options_.view_distance;
    const Vector2d across(heading.y(), -heading.x());
    const Vector2d middle = box_.center().head<2>();
    const Vector2d half = (0.5 * box_.sizes().head<2>()).array() + beside;
    const double along_half = std::abs(heading.x()) * half.x() + std::abs(heading.y()) * half.y();
    const double across_half = std::abs(across.x()) * half.x() + std::abs(across.y()) * half.y();
    const double row_spacing = (1.0 - options_.side_overlap) * footprint_.x();
    const double spacing = (1.0 - options_.forward_overlap) * footprint_.y() * stretch;
    if (!fits((2.0 * across_half / row_spacing + 1.0) * (2.0 * along_half / spacing + 1.0))) return;
    bool is_forth = true;
    for (const double b : row(-across_half, across_half, row_spacing)) {
      std::vector<double> along = row(-along_half, along_half, spacing);
      if (!is_forth) std::ranges::reverse(along);
      is_forth = !is_forth;
      for (const double a : along) {
        const Vector2d at = middle + (a - back) * heading + b * across;
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

  /// Adds evenly spaced photos along the hull's edges and around its corners at distance d.
  void around(const std::vector<Vector2d>& hull, double z, double spacing) {
    const double d = options_.view_distance;
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
    const auto photos = static_cast<int>(std::ceil(length / spacing - 1e-9));
    const double step = length / photos;
    double next = 0.0, passed = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vector2d before = normal((i + count - 1) % count);
      const double arc = d * turns[i];
      for (; next < passed + arc - 1e-9; next += step) {
        const double angle = (next - passed) / d;
        facing(hull[i], Eigen::Rotation2Dd(angle) * before, z);
      }
      passed += arc;
      const Vector2d edge = hull[(i + 1) % count] - hull[i];
      for (; next < passed + edge.norm() - 1e-9; next += step) {
        facing(hull[i] + (next - passed) * edge.normalized(), normal(i), z);
      }
      passed += edge.norm();
    }
  }

  void facing(const Vector2d& wall, const Vector2d& outward, double z) {
    const Vector2d at = wall + options_.view_distance * outward;
    add({{at.x(), at.y(), z}, {-outward.x(), -outward.y(), 0.0}});
  }

  const geometry::Mesh& target_;
  Eigen::AlignedBox3d box_;
  const PatternOptions& options_;
  const PhotoSpace& space_;
  Vector2d footprint_;
  PatternPhotos photos_;
};

}  // namespace

const char* to_string(Pattern pattern) { return names[static_cast<std::size_t>(pattern)]; }

std::optional<Pattern> pattern_named(std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Pattern>(found - names.begin());
}

PatternPhotos pattern_photos(Pattern pattern, const geometry::PhotoCamera& camera,
                             const geometry::Mesh& target, const PatternOptions& options,
                             const PhotoSpace& space) {
  PatternMaker maker(camera, target, options, space);
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
  }
  return maker.take();
}

}  // namespace skycap::survey::photo
