#include "missions/config/opening_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/place/camera.h"
#include "missions/config/mission_flight.h"
#include "missions/config/site.h"
#include "missions/config/survey_sensor.h"

namespace skycap::missions::config {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::View;

/// From the box: the clearance, the voxels that the box may grow by, and room to spare.
double spare_of(const config::Mission& mission) { return 1.5 * mission.flight.clearance; }

/// The least z that views may have there.
double lowest_of(const config::Mission& mission) {
  const std::optional<double> least = view_limits(mission).least_height;
  return std::max(least.value_or(mission.scene.position.z()), mission.scene.position.z()) + 0.5;
}

/// How often round the box: once for each band of its height that is no higher than the way is from
/// the box's middle, or than planners look from.
unsigned circles_round(const AlignedBox3d& box, const config::Mission& mission) {
  constexpr double most = 32.0;
  const double away = 0.5 * box.sizes().head<2>().minCoeff() + spare_of(mission);
  const double apart = std::max(away, view_distance_of(mission));
  return static_cast<unsigned>(std::clamp(std::ceil(box.sizes().z() / apart - 1e-9), 1.0, most));
}

/// Round the box, anticlockwise, the box on the left: once, up and down between two heights, or in
/// circles from the one to the other, each of whose last sides climbs to the next.
std::vector<View> orbit(const config::Mission& mission) {
  const AlignedBox3d box = unknown_box_of(mission);
  const double spare = spare_of(mission);
  const Vector3d low = box.min() - Vector3d::Constant(spare);
  const Vector3d high = box.max() + Vector3d::Constant(spare);
  const double bottom = std::max(low.z(), lowest_of(mission));
  constexpr double lower_share = 0.2, upper_share = 0.9;
  const unsigned circles = circles_round(box, mission);
  std::vector<View> views;
  for (unsigned i = 0; i <= 4 * circles; ++i) {
    const auto corner = static_cast<unsigned>((mission.seed + i) % 4);  // from the south west on
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
std::vector<View> strips(const config::Mission& mission) {
  const AlignedBox3d box = unknown_box_of(mission);
  const int along = box.sizes().x() >= box.sizes().y() ? 0 : 1, across = 1 - along;
  const double height = box.max().z() + spare_of(mission);
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
  if (mission.seed % 2 == 0) std::ranges::reverse(views);
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

config::Opening usual_opening(const config::Mission& mission) {
  const AlignedBox3d box = unknown_box_of(mission);
  if (box.isEmpty()) return config::Opening::none;
  const bool is_flat = box.sizes().head<2>().minCoeff() > 2.0 * box.sizes().z();
  return is_flat ? config::Opening::strips : config::Opening::orbit;
}

namespace {

/// Points a second on each metre along the way and each across it, at the view distance.
double points_abeam(const config::Mission& mission) {
  const sim::LidarConfig& lidar = *mission.sensor.scanner;
  const double distance = view_distance_of(mission);
  const double swath = 2.0 * distance * std::tan(0.5 * mission.sensor.camera.camera.horizontal_fov);
  switch (kind_of(lidar)) {
    case ScannerKind::ring: {
      const geometry::Camera camera(side_camera(lidar).camera);
      const double rays = camera.focal_length_px().prod() / (distance * distance);  // on a m^2
      return swath * std::abs(lidar.rotation_rate) * rays;
    }
    case ScannerKind::line:
      return std::abs(lidar.rotation_rate) / (distance * azimuth_step(lidar));
    case ScannerKind::rosette:
      break;
  }
  const geometry::Camera camera(mission.sensor.camera.camera);
  const double period = mission.sensor.is_moving() ? mission.sensor.frame_period : rosette_period;
  return swath * camera.focal_length_px().prod() / (distance * distance) / period;
}

}  // namespace

double scanning_speed(const config::Mission& mission) {
  // Lines are even, and lie over each other nowhere: what is stored of them is most of what comes.
  const bool is_even = kind_of(*mission.sensor.scanner) == ScannerKind::line;
  const double spacing = (is_even ? 1.0 : 0.5) * mission.planner.see.effective_spacing();
  return std::min(points_abeam(mission) * spacing * spacing, 0.5 * vehicle_of(mission).max_speed);
}

std::vector<View> opening_views(const config::Mission& mission) {
  if (!mission.flight.is_flown()) return {};
  std::vector<View> views;
  if (mission.flight.opening == config::Opening::orbit) views = orbit(mission);
  if (mission.flight.opening == config::Opening::strips) {
    views = strips(mission);
    const auto& scanner = mission.sensor.scanner;
    if (scanner && kind_of(*scanner) == ScannerKind::line) begin_inside(views);
  }
  if (const auto& mount = mission.sensor.mount; mount && mount->look_pitch != 0.0) {
    for (View& view : views) view = scanner_view(*mount, nose_view(*mount, view));
  }
  return views;
}

}  // namespace skycap::missions::config
