/// Tower with a capture point on each side, for the examples of flights.
#pragma once

#include <vector>

#include <skycap/flight/clearance.h>
#include <skycap/flight/flight_plan.h>
#include <skycap/flight/obstacles.h>
#include <skycap/flight/route.h>

inline skycap::flight::KnownSpace tower_space() {
  const skycap::flight::Prism tower{"tower", {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, 0.0, 30.0};
  return skycap::flight::KnownSpace({.mesh = skycap::flight::surface(tower), .ground_height = 0.0});
}

inline skycap::flight::Route tower_route(const skycap::flight::FreeSpace& space) {
  const std::vector<skycap::flight::CapturePoint> capture_points{
      {.view = skycap::geometry::look_at({-15, 0, 15}, {0, 0, 15})},
      {.view = skycap::geometry::look_at({15, 0, 15}, {0, 0, 15})}};
  return plan_route(capture_points, {}, space, nullptr, {.takeoff = {-30, -30, 0}});
}

inline skycap::flight::FlightPlan tower_plan(const skycap::flight::FreeSpace& space) {
  const skycap::flight::Site site{.origin = {51.7534, -1.2540, 110.0}, .geoid_undulation = 47.0};
  return flight_plan(tower_route(space), 0, "tower", site);
}
