#include "missions/session/initial_pattern_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace skycap::missions::session {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::View;

/// Returns the distance of the initial views from the box: the clearance, the voxels that the box
/// may grow by, and a reserve.
double distance_from_box(const StartOptions& start) { return 1.5 * start.clearance; }

/// Returns the number of orbits: one per height band. The height of a band is at most the distance
/// of the orbit from the centre of the box or, if larger, the view distance.
unsigned circles_round(const AlignedBox3d& box, const StartOptions& start) {
  constexpr double max = 32.0;
  const double away = 0.5 * box.sizes().head<2>().minCoeff() + distance_from_box(start);
  const double apart = std::max(away, start.view_distance);
  return static_cast<unsigned>(std::clamp(std::ceil(box.sizes().z() / apart - 1e-9), 1.0, max));
}

/// Returns counter-clockwise orbits with the box on the left: a single orbit that alternates
/// between two heights, or several level orbits connected by climbs on their last sides.
std::vector<View> orbit(const StartOptions& start, std::uint64_t seed) {
  const AlignedBox3d box = start.box;
  const double margin = distance_from_box(start);
  const Vector3d low = box.min() - Vector3d::Constant(margin);
  const Vector3d high = box.max() + Vector3d::Constant(margin);
  const double bottom = std::max(low.z(), (start.min_height + 0.5));
  constexpr double lower_share = 0.2, upper_share = 0.9;
  const unsigned circles = circles_round(box, start);
  std::vector<View> views;
  for (unsigned i = 0; i <= 4 * circles; ++i) {
    // Counted from the south-west corner.
    const auto corner = static_cast<unsigned>((seed + i) % 4);
    const double up = circles == 1 ? i % 2 : std::min(i / 4, circles - 1) / (circles - 1.0);
    const double share = lower_share + up * (upper_share - lower_share);
    const Vector3d position(corner == 1 || corner == 2 ? high.x() : low.x(),
                            corner >= 2 ? high.y() : low.y(),
                            bottom + share * (box.max().z() - bottom));
    const Vector3d middle(box.center().x(), box.center().y(), position.z());
    views.push_back(geometry::look_at(position, middle));
  }
  return views;
}

/// Returns strips along the longer side of the box with a spacing of at most the flight height
/// above its lower end. The sensor is directed to the left of the path and down.
std::vector<View> strips(const StartOptions& start, std::uint64_t seed) {
  const AlignedBox3d box = start.box;
  const int along = box.sizes().x() >= box.sizes().y() ? 0 : 1, across = 1 - along;
  const double height = box.max().z() + distance_from_box(start);
  const double width = box.sizes()[across];
  const auto count =
      std::max(1, static_cast<int>(std::ceil(width / (height - box.min().z()) - 1e-9)));
  Vector3d ahead = Vector3d::Zero();
  ahead[along] = 1.0;
  const Vector3d left = Vector3d::UnitZ().cross(ahead);
  const Vector3d direction = (left - std::numbers::sqrt3 * Vector3d::UnitZ()).normalized();
  std::vector<View> views;
  for (int strip = 0; strip < count; ++strip) {
    for (const bool is_end : {false, true}) {
      Vector3d position(0.0, 0.0, height);
      position[across] = box.min()[across] + width * (strip + 0.5) / count;
      position[along] = is_end == (strip % 2 == 0) ? box.max()[along] : box.min()[along];
      views.push_back({position, direction});
    }
  }
  if (seed % 2 == 0) std::ranges::reverse(views);
  return views;
}

/// Inserts a start within the first strip, from which the vehicle flies back to the start of the
/// strip. At the edge of the box, a single-line LiDAR may observe nothing inside it, which would
/// prevent planning.
void begin_inside(std::vector<View>& strips) {
  constexpr double share = 0.25;
  View inside = strips.front();
  inside.position += share * (strips[1].position - strips[0].position);
  strips.insert(strips.begin(), inside);
}

}  // namespace

InitialPattern default_initial_pattern(const AlignedBox3d& box) {
  if (box.isEmpty()) return InitialPattern::none;
  const bool is_flat = box.sizes().head<2>().minCoeff() > 2.0 * box.sizes().z();
  return is_flat ? InitialPattern::strips : InitialPattern::orbit;
}

std::vector<View> initial_pattern_views(const StartOptions& start, std::uint64_t seed) {
  std::vector<View> views;
  if (start.initial_pattern == InitialPattern::orbit) views = orbit(start, seed);
  if (start.initial_pattern == InitialPattern::strips) {
    views = strips(start, seed);
    if (start.sees_lines) begin_inside(views);
  }
  if (const auto& mount = start.mount; mount && mount->view_pitch != 0.0) {
    for (View& view : views) {
      view = geometry::scanner_view(*mount, geometry::nose_view(*mount, view));
    }
  }
  return views;
}

}  // namespace skycap::missions::session
