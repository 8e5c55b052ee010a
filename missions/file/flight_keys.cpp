/// The keys of the sections `site` and `flight`: where the survey is, and how it is flown.
#include "flight/motion/vehicle.h"
#include "missions/file/key_builders.h"

namespace skycap::missions::file {
namespace {

/// The key `flight.vehicle`: a profile's name, or none.
Key vehicle_key() {
  Key key = key_for(
      "flight.vehicle", KeyType::choice, [](Mission & m) -> auto& { return m.flight.vehicle; },
      "What flies. With a vehicle the survey goes only where it can fly, and the package holds the "
      "route; without one the sensor is taken to reach every view.");
  key.choices = {"none"};
  for (const flight::Vehicle& vehicle : flight::vehicle_profiles()) {
    key.choices.push_back(vehicle.name);
  }
  return key;
}

std::vector<Key> site_keys() {
  return {
      otherwise("not known",
                number(
                    "site.latitude_deg", "degrees", between(-90, 90),
                    [](Mission & m) -> auto& { return m.georeference.latitude; },
                    "WGS84 latitude of the origin of the mission's frame (x east, y north, z up). "
                    "Without a place no mission files are written, only local coordinates.")),
      otherwise("not known", number(
                                 "site.longitude_deg", "degrees", between(-180, 180),
                                 [](Mission & m) -> auto& { return m.georeference.longitude; },
                                 "WGS84 longitude of the origin, east positive.")),
      number(
          "site.ellipsoid_height", "m", between(-1000, 10000),
          [](Mission & m) -> auto& { return m.georeference.ellipsoid_height; },
          "Height of the origin above the WGS84 ellipsoid."),
      otherwise("not known",
                number(
                    "site.geoid_undulation", "m", between(-120, 120),
                    [](Mission & m) -> auto& { return m.georeference.geoid_undulation; },
                    "Height of the geoid (EGM96) above the ellipsoid at the site. Formats with "
                    "heights above sea level are not written without it.")),
  };
}

}  // namespace

std::vector<Key> flight_keys() {
  const auto field = [](auto member) {
    return [member](Mission & m) -> auto& { return m.flight.*member; };
  };
  using Flight = FlightConfig;
  std::vector<Key> keys = site_keys();
  std::ranges::move(
      std::vector<Key>{
          vehicle_key(),
          number("flight.clearance", "m", above(0, 1000), field(&Flight::clearance),
                 "Every leg is proven to keep this from everything that is not known to be free: "
                 "the vehicle's radius, the three errors below, and what is left as margin."),
          number("flight.position_error", "m", between(0, 100), field(&Flight::position_error),
                 "How far off the vehicle may take itself to be: 0.05 with RTK, 1.5 to 3 without."),
          number("flight.tracking_error", "m", between(0, 100), field(&Flight::tracking_error),
                 "How far the vehicle may stray from a straight leg with stops."),
          number("flight.map_error", "m", between(0, 100), field(&Flight::map_error),
                 "How far off measured obstacles may be: noise and registration."),
          otherwise(
              "planner.scene_box",
              box_corner("flight.unknown_box.min", field(&Flight::unknown_box), false,
                         "Lower corner of the box around the building in which only what has been "
                         "measured free is flown through. Outside of it the pilot vouches for the "
                         "airspace above the ground.")),
          otherwise("planner.scene_box",
                    box_corner("flight.unknown_box.max", field(&Flight::unknown_box), true,
                               "Upper corner of that box.")),
          number("flight.free_without_return", "m", between(0, 1e4),
                 field(&Flight::free_without_return),
                 "Up to this depth pixels without a return prove space free. 0: they prove "
                 "nothing, right for sensors that may miss dark, shiny or thin things."),
          otherwise("on the ground beside unknown_box, at the first view",
                    vector("flight.takeoff", "m", between(-1e6, 1e6), field(&Flight::takeoff),
                           "The pad for take-off and landing.")),
          otherwise(
              "5, or flight.clearance and 1 more",
              number("flight.takeoff_climb", "m", between(0, 1000), field(&Flight::takeoff_climb),
                     "Straight up from the pad before the first leg.")),
          number("flight.cruise_speed", "m/s", above(0, 100), field(&Flight::cruise_speed),
                 "Wanted speed on legs."),
          number("flight.hold", "s", between(0, 3600), field(&Flight::hold),
                 "Time at rest at each view before the capture, when the vehicle has settled and "
                 "heading and gimbal have turned."),
          number("flight.hold_after", "s", between(0, 3600), field(&Flight::hold_after),
                 "Time at rest after the capture, for shutter lag, exposure and readout."),
          number("flight.wind_speed", "m/s", between(0, 100), field(&Flight::wind_speed),
                 "Steady wind, for times and energy."),
          number("flight.wind_from_deg", "degrees", between(0, 360), field(&Flight::wind_from),
                 "Where the wind blows from, clockwise from north."),
          number("flight.temperature", "degrees Celsius", between(-40, 60),
                 field(&Flight::temperature), "Of the battery; cold ones hold less."),
          number("flight.reserve", "share", between(0, 0.9), field(&Flight::reserve),
                 "Of the battery, left at landing of every sortie."),
          choice("flight.order", {"shortest", "survey"}, field(&Flight::order),
                 "Order of the views in the exported mission: the shortest tour found, or as "
                 "surveyed."),
          choice("flight.style", {"stop", "blend", "smooth"}, field(&Flight::style),
                 "How legs with corners are flown: with a stop in each, round them, or along one "
                 "smooth curve, where that is proven and faster. Trajectories (csv, ned-csv, tum) "
                 "and KML hold curves; the other files stop in corners."),
      },
      std::back_inserter(keys));
  return keys;
}

}  // namespace skycap::missions::file
