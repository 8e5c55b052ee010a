#include "tests/flight/export/sample_plan.h"

#include <stdexcept>

#include "tests/flight/scenes.h"

namespace skycap::flight {

Obstacles sample_site() {
  Obstacles obstacles;
  obstacles.mesh = scenes::box({-10, -10, 0}, {10, 10, 15});
  obstacles.ground_height = 0.0;
  obstacles.no_fly = {{"heliport", {{30, -10}, {50, -10}, {50, 10}, {30, 10}}},
                      {"shed", {{-25, -24}, {-20, -24}, {-20, -16}, {-25, -16}}, 0.0, 2.0}};
  obstacles.fence = Prism{"site", {{-60, -60}, {60, -60}, {60, 60}, {-60, 60}}, -1.0, 60.0};
  return obstacles;
}

namespace {

/// Returns a plan for these capture points.
FlightPlan plan_for(const Vehicle& vehicle, const std::vector<CapturePoint>& capture_points,
                    FlightStyle style, const std::optional<PhotoShutter>& photo = {}) {
  const Obstacles obstacles = sample_site();
  const KnownSpace space(obstacles), pad_space(without_ground(obstacles));
  RouteOptions options;
  options.photo = photo;
  options.takeoff = {-30, -25, 0};
  options.style = style;
  options.passing = {.speed = 3.0, .max_cut = 0.5, .exposure = 0.001, .period = 1.0};
  options.returns = ReturnOptions{{AutopilotType::ardupilot, AutopilotType::px4}, 40.0};
  const Route route = plan_route(capture_points, vehicle, space, &pad_space, options);
  if (route.sorties.size() != 1 || !route.unreached.empty()) {
    throw std::logic_error("the sample flight must be one sortie through all stations" +
                           (route.unreached.empty() ? "" : ": " + route.unreached[0].reason));
  }
  const Site site{{51.753458, -1.254022, 111.5}, 46.7};
  return flight_plan(route, 0, "sample", site, obstacles, Corners::rounded);
}

/// Returns capture points that look at the centre of the building.
std::vector<CapturePoint> stations_at(const std::vector<Eigen::Vector3d>& positions) {
  std::vector<CapturePoint> capture_points;
  for (const Eigen::Vector3d& position : positions) {
    capture_points.push_back({geometry::look_at(position, {0, 0, 7}), 2.0, 2,
                              static_cast<std::uint32_t>(capture_points.size() + 10)});
  }
  return capture_points;
}

}  // namespace

FlightPlan photo_row_plan(const Vehicle& vehicle) {
  std::vector<CapturePoint> capture_points;
  for (std::uint32_t i = 0; i < 6; ++i) {
    capture_points.push_back({{{3.0 * i - 7.5, -16.0, 8.0}, Eigen::Vector3d::UnitY()}, 1.0, 1, i});
  }
  return plan_for(vehicle, capture_points, FlightStyle::stop,
                  PhotoShutter{.gsd = 0.005, .exposure = 0.001, .min_interval = 0.7});
}

FlightPlan sample_plan(const Vehicle& vehicle) {
  return plan_for(vehicle,
                  stations_at({{-16, -12.5, 7.25}, {14, -16, 8}, {16, 14, 9.5}, {-14, 16, 18}}),
                  FlightStyle::stop);
}

FlightPlan corner_plan(FlightStyle style) {
  return plan_for(vehicle_profile("generic"), stations_at({{0, -14, 8}, {0, 14, 8}, {-14, 0, 8}}),
                  style);
}

}  // namespace skycap::flight
