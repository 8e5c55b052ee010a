#include "missions/session/opening_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace skycap::missions::session {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::View;

/// From the box to the opening views: the clearance, the voxels that the box may grow by, and a
/// reserve.
double distance_from_box(const StartOptions& start) { return 1.5 * start.clearance; }

/// How often round the box: once for each band of its height that is no higher than the way is from
/// the box's middle, or than planners look from.
unsigned circles_round(const AlignedBox3d& box, const StartOptions& start) {
  constexpr double most = 32.0;
  const double away = 0.5 * box.sizes().head<2>().minCoeff() + distance_from_box(start);
  const double apart = std::max(away, start.view_distance);
  return static_cast<unsigned>(std::clamp(std::ceil(box.sizes().z() / apart - 1e-9), 1.0, most));
}

/// Round the box, anticlockwise, the box on the left: once, up and down between two heights, or in
/// circles from the one to the other, each of whose last sides climbs to the next.
std::vector<View> orbit(const StartOptions& start, std::uint64_t seed) {
  const AlignedBox3d box = start.box;
  const double spare = distance_from_box(start);
  const Vector3d low = box.min() - Vector3d::Constant(spare);
  const Vector3d high = box.max() + Vector3d::Constant(spare);
  const double bottom = std::max(low.z(), (start.lowest + 0.5));
  constexpr double lower_share = 0.2, upper_share = 0.9;
  const unsigned circles = circles_round(box, start);
  std::vector<View> views;
  for (unsigned i = 0; i <= 4 * circles; ++i) {
    const auto corner = static_cast<unsigned>((seed + i) % 4);  // from the south west on
    const double up = circles == 1 ? i % 2 : std::min(i / 4, circles - 1) / (circles - 1.0);
    const double share = lower_share + up * (upper_share - lower_share);
    const Vector3d place(corner == 1 || corner == 2 ? high.x() : low.x(),
                         corner >= 2 ? high.y() : low.y(),
                         bottom + share * (box.max().z() - bottom));
    const Vector3d middle(box.center().x(), box.center().y(), place.z());
    views.push_back(geometry::look_at(place, middle));
  }
  return views;
}

/// To and fro over the box, along its longer side, as far apart as the flight is high over its
/// foot; what is looked at is to the left of the way and below.
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
      Vector3d place(0.0, 0.0, height);
      place[across] = box.min()[across] + width * (strip + 0.5) / count;
      place[along] = is_end == (strip % 2 == 0) ? box.max()[along] : box.min()[along];
      views.push_back({place, direction});
    }
  }
  if (seed % 2 == 0) std::ranges::reverse(views);
  return views;
}

/// A line that stands at the box's edge may see nothing of what is in it, and nothing can be
/// planned from that: such a flight begins within the first strip, and flies back to its beginning.
void begin_inside(std::vector<View>& strips) {
  constexpr double share = 0.25;
  View inside = strips.front();
  inside.position += share * (strips[1].position - strips[0].position);
  strips.insert(strips.begin(), inside);
}

}  // namespace

Opening usual_opening(const AlignedBox3d& box) {
  if (box.isEmpty()) return Opening::none;
  const bool is_flat = box.sizes().head<2>().minCoeff() > 2.0 * box.sizes().z();
  return is_flat ? Opening::strips : Opening::orbit;
}

std::vector<View> opening_views(const StartOptions& start, std::uint64_t seed) {
  std::vector<View> views;
  if (start.opening == Opening::orbit) views = orbit(start, seed);
  if (start.opening == Opening::strips) {
    views = strips(start, seed);
    if (start.sees_lines) begin_inside(views);
  }
  if (const auto& mount = start.mount; mount && mount->look_pitch != 0.0) {
    for (View& view : views) {
      view = geometry::scanner_view(*mount, geometry::nose_view(*mount, view));
    }
  }
  return views;
}

}  // namespace skycap::missions::session
