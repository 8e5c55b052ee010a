// The keys of `site` and `flight`: where the survey is, and how it is flown.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

/// A key whose value is a list; an empty one stands for none.
template <class Field>
Key list_key(std::string path, KeyType type, Field field, std::string meaning) {
  using List = std::remove_reference_t<decltype(field(std::declval<MissionDocument&>()))>;
  Key key;
  key.path = std::move(path);
  key.type = type;
  key.unit = "m";
  key.fallback = "none";
  key.meaning = std::move(meaning);
  key.set = [field](MissionDocument& mission, const KeyValue& value) {
    field(mission) = std::get<List>(value);
  };
  key.get = [field](const MissionDocument& mission) -> std::optional<KeyValue> {
    const List& stored = field(mission);
    return stored.empty() ? std::nullopt : std::optional<KeyValue>(stored);
  };
  return key;
}

/// The field of the flight's settings that `member` points to.
auto flight(auto member) {
  return [member](auto& m) -> auto& { return m.flight.options.*member; };
}

/// The same of what follows from other keys where it is not given.
auto section(auto member) {
  return [member](auto& m) -> auto& { return m.flight.*member; };
}

/// The key `flight.rally`: places on the ground.
Key rally_key() {
  Key key = list_key("flight.rally", KeyType::vectors, flight(&flight::FlightOptions::rally),
                     "Other places on the ground to land at, [x, y, z] each, which the pilot "
                     "vouches for up to flight.takeoff_climb as for the pad: a vehicle that is "
                     "called home goes to the nearest of these and the pad. Not for DJI's "
                     "vehicles.");
  key.range = between(-1e6, 1e6);
  return key;
}

/// The field of the fleet's settings that `member` points to.
auto fleet(auto member) {
  return [member](auto& m) -> auto& { return m.flight.options.fleet.*member; };
}

/// A key that a mission without a fleet has no value of; `fallback` says what a fleet has.
Key of_fleet(std::string fallback, Key key) {
  key.fallback = std::move(fallback);
  key.get = [get = key.get](const MissionDocument& mission) -> std::optional<KeyValue> {
    return mission.flight.options.fleet.names.empty() ? std::nullopt : get(mission);
  };
  return key;
}

/// The key `flight.vehicles`: a list of texts without a unit.
Key vehicles_key() {
  Key key = list_key("flight.vehicles", KeyType::texts, fleet(&flight::FleetOptions::names),
                     "Several vehicles, each as for flight.vehicle, that share the mission's "
                     "stations; the same name may stand there twice. The first of them flies the "
                     "survey. One in the list is the same as flight.vehicle.");
  key.unit.clear();
  return key;
}

/// The key `flight.pads`: a place on the ground for each vehicle.
Key pads_key() {
  Key key = list_key("flight.pads", KeyType::vectors, fleet(&flight::FleetOptions::pads),
                     "Where each of flight.vehicles takes off and lands, in the same order.");
  key.range = between(-1e6, 1e6);
  key.fallback = "in a row, from flight.takeoff along the side of unknown_box";
  return key;
}

/// Several vehicles at once.
std::vector<Key> fleet_keys() {
  return {
      vehicles_key(),
      pads_key(),
      of_fleet(
          "makespan",
          choice_key("flight.fleet_goal", {"makespan", "flown"}, fleet(&flight::FleetOptions::goal),
                     "What the stations are shared out for: that the last of flight.vehicles "
                     "lands soonest, or that all together fly least.")),
      of_fleet("10 m",
               number_key("flight.separation", "m", above(0, 10'000),
                          fleet(&flight::FleetOptions::separation),
                          "Between any two of flight.vehicles in the air, by plan, at all times: "
                          "their radii and errors are a part of it.")),
      of_fleet("10 s", number_key("flight.timing_tolerance", "s", between(0, 3600),
                                  fleet(&flight::FleetOptions::timing_tolerance),
                                  "By which each of flight.vehicles may be early or late, anywhere "
                                  "in its flight, and still keep flight.separation.")),
  };
}

/// The key `flight.unknown_beside`: boxes of neighbours.
Key unknown_beside_key() {
  Key key =
      list_key("flight.unknown_beside", KeyType::vectors, section(&FlightSection::unknown_beside),
               "Further boxes in which only what has been measured free is flown through, "
               "such as those of neighbours that are surveyed, too: the lower and the upper "
               "corner of each, one behind the other. The package keeps what was measured in "
               "them for the flight of all.");
  key.range = between(-1e6, 1e6);
  return key;
}

/// What proves a leg.
std::vector<Key> safety_keys() {
  return {
      text_key("flight.vehicle", flight(&flight::FlightOptions::vehicle_name),
               "What flies: a preset of flight/motion/presets, or the path of a description "
               "(NAME.yaml), relative to the mission file. With a vehicle the survey goes only "
               "where it can fly, and the package holds the route; with none the sensor is taken "
               "to reach every view."),
      number_key("flight.clearance", "m", above(0, 1000), flight(&flight::FlightOptions::clearance),
                 "Every leg is proven to keep this from everything that is not known to be free: "
                 "the vehicle's radius, the three errors below, and what is left as margin."),
      otherwise("the vehicle's",
                number_key("flight.position_error", "m", between(0, 100),
                           flight(&flight::FlightOptions::position_error),
                           "Maximum navigation error. Typical: 0.05 m with RTK, 1.5 to 3 m "
                           "without.")),
      number_key("flight.tracking_error", "m", between(0, 100),
                 flight(&flight::FlightOptions::tracking_error),
                 "How far the vehicle may stray from a straight leg with stops."),
      number_key("flight.map_error", "m", between(0, 100),
                 flight(&flight::FlightOptions::map_error),
                 "How far off measured obstacles may be: noise and registration."),
      otherwise(
          "planner.scene_box",
          box_corner("flight.unknown_box.min", section(&FlightSection::unknown_box), false,
                     "Lower corner of the box around the building in which only what has been "
                     "measured free is flown through. Outside of it the pilot vouches for the "
                     "airspace above the ground.")),
      otherwise("planner.scene_box",
                box_corner("flight.unknown_box.max", section(&FlightSection::unknown_box), true,
                           "Upper corner of that box.")),
      unknown_beside_key(),
      number_key("flight.free_without_return", "m", between(0, 1e4),
                 flight(&flight::FlightOptions::free_without_return),
                 "Up to this depth pixels without a return prove space free. 0: they prove "
                 "nothing, right for sensors that may miss dark, shiny or thin things."),
  };
}

/// How the legs are flown.
std::vector<Key> conduct_keys() {
  return {
      otherwise(
          "on the ground beside unknown_box, at the first view",
          vector_key("flight.takeoff", "m", between(-1e6, 1e6),
                     flight(&flight::FlightOptions::takeoff), "The pad for take-off and landing.")),
      otherwise("5, or flight.clearance and 1 more",
                number_key("flight.takeoff_climb", "m", between(0, 1000),
                           flight(&flight::FlightOptions::takeoff_climb),
                           "Straight up from the pad before the first leg.")),
      rally_key(),
      otherwise("by the prior terrain, where it is not measured",
                angle_key("flight.pad_slope_deg", between(0, 60),
                          flight(&flight::FlightOptions::pad_slope),
                          "How steep the pad and the rally points are, as the pilot found it. What "
                          "the survey measures there counts before it.")),
      angle_key("flight.steepest_pad_deg", between(0, 60),
                flight(&flight::FlightOptions::steepest_pad),
                "The steepest ground that the vehicle may take off from and land on."),
      number_key("flight.cruise_speed", "m/s", above(0, 100),
                 flight(&flight::FlightOptions::cruise_speed), "Wanted speed on legs."),
      number_key("flight.hold", "s", between(0, 3600), flight(&flight::FlightOptions::hold),
                 "Time at rest at each view before the capture, when the vehicle has settled and "
                 "heading and gimbal have turned."),
      number_key("flight.hold_after", "s", between(0, 3600),
                 flight(&flight::FlightOptions::hold_after),
                 "Time at rest after the capture, for shutter lag, exposure and readout."),
      number_key("flight.wind_speed", "m/s", between(0, 100),
                 flight(&flight::FlightOptions::wind_speed), "Steady wind, for times and energy."),
      angle_key("flight.wind_from_deg", between(0, 360), flight(&flight::FlightOptions::wind_from),
                "Where the wind blows from, clockwise from north."),
      number_key("flight.temperature", "degrees Celsius", between(-40, 60),
                 flight(&flight::FlightOptions::temperature),
                 "Of the battery; cold ones hold less."),
      number_key("flight.reserve", "share", between(0, 0.9),
                 flight(&flight::FlightOptions::reserve),
                 "Of the battery, left at landing of every sortie."),
      otherwise("orbit or strips with sensor.lidar, else none",
                choice_key(
                    "flight.opening", {"none", "orbit", "strips"}, section(&FlightSection::opening),
                    "What the survey begins with, outside of unknown_box, before the planner "
                    "chooses: once or more often round the box, or strips over it, which are for "
                    "boxes wider than twice their height.")),
      choice_key(
          "flight.views", {"survey", "anew"}, flight(&flight::FlightOptions::views),
          "Which views the exported mission takes: those of the survey, or chosen anew, views "
          "and tour together, to cover what the survey measured in fewer seconds. For the "
          "planner skycap."),
      choice_key("flight.order", {"shortest", "survey"}, flight(&flight::FlightOptions::order),
                 "Order of the views in the exported mission: the shortest tour found, or as "
                 "surveyed."),
      choice_key(
          "flight.style", {"stop", "blend", "smooth", "pass"},
          flight(&flight::FlightOptions::style),
          "How legs with corners are flown: with a stop in each, round them, or along one "
          "smooth curve, where that is proven and faster; pass: past the views too, pictures "
          "being taken without a stop, no faster than they stay sharp (sensor.exposure). "
          "Trajectories (csv, ned-csv, tum) and KML hold curves; the other files stop in "
          "corners and at views."),
  };
}

}  // namespace

std::vector<Key> site_keys() {
  return {
      list_key(
          "site.geofence", KeyType::polygon, [](auto& m) -> auto& { return m.site.geofence; },
          "Polygon, east and north in the mission's frame, that views stay inside of."),
      list_key(
          "site.no_fly", KeyType::volumes, [](auto& m) -> auto& { return m.site.no_fly; },
          "Upright prisms that views stay outside of; bottom and top are z in the mission's "
          "frame."),
      otherwise("unlimited", number_key(
                                 "site.lowest_height", "m", between(-1e6, 1e6),
                                 [](auto& m) -> auto& { return m.site.lowest_height; },
                                 "Least z of a view in the mission's frame.")),
      otherwise("unlimited", number_key(
                                 "site.highest_height", "m", between(-1e6, 1e6),
                                 [](auto& m) -> auto& { return m.site.highest_height; },
                                 "Greatest z of a view in the mission's frame.")),
      otherwise("not known",
                number_key(
                    "site.latitude_deg", "degrees", between(-90, 90),
                    [](auto& m) -> auto& { return m.georeference.latitude_deg; },
                    "WGS84 latitude of the origin of the mission's frame (x east, y north, z up). "
                    "Without a place no mission files are written, only local coordinates.")),
      otherwise("not known", number_key(
                                 "site.longitude_deg", "degrees", between(-180, 180),
                                 [](auto& m) -> auto& { return m.georeference.longitude_deg; },
                                 "WGS84 longitude of the origin, east positive.")),
      number_key(
          "site.ellipsoid_height", "m", between(-1000, 10000),
          [](auto& m) -> auto& { return m.georeference.ellipsoid_height; },
          "Height of the origin above the WGS84 ellipsoid."),
      otherwise("EGM96's",
                number_key(
                    "site.geoid_undulation", "m", between(-120, 120),
                    [](auto& m) -> auto& { return m.georeference.geoid_undulation; },
                    "Height of the geoid (EGM96) above the ellipsoid at the site. Where PROJ's "
                    "grid of EGM96 is not installed, formats with heights above sea level are not "
                    "written without it.")),
  };
}

std::vector<Key> flight_keys() { return joined({safety_keys(), conduct_keys(), fleet_keys()}); }

}  // namespace skycap::missions::config
