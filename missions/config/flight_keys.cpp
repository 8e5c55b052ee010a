// Keys of the sections `site` and `flight`: location of the survey and flight execution.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

/// Creates a list key with the unit metre.
template <class Field>
Key metre_list_key(std::string path, KeyType type, Field field, std::string meaning) {
  Key key = list_key(std::move(path), type, field, std::move(meaning));
  key.unit = "m";
  key.fallback = "none";
  return key;
}

/// Returns an accessor of a member of the flight options.
auto flight(auto member) {
  return [member](auto& m) -> auto& { return m.flight.options.*member; };
}

/// Returns an accessor of a member of FlightSection.
auto section(auto member) {
  return [member](auto& m) -> auto& { return m.flight.*member; };
}

/// Creates the key `flight.rally`: positions on the ground.
Key rally_key() {
  Key key =
      metre_list_key("flight.rally", KeyType::vectors, flight(&flight::FlightOptions::rally),
                     "Rally points [x, y, z] on the ground. On return, the vehicle flies to the "
                     "nearest of these and the take-off point. The pilot must check the airspace "
                     "above each, up to flight.takeoff_climb. Not supported by DJI.");
  key.range = between(-1e6, 1e6);
  return key;
}

/// Returns an accessor of a member of the fleet options.
auto fleet(auto member) {
  return [member](auto& m) -> auto& { return m.flight.options.fleet.*member; };
}

/// Removes the value of a key for missions without a fleet. `fallback` describes the default for a
/// fleet.
Key fleet_key(std::string fallback, Key key) {
  key.fallback = std::move(fallback);
  key.get = [get = key.get](const MissionDocument& mission) -> std::optional<KeyValue> {
    return mission.flight.options.fleet.names.empty() ? std::nullopt : get(mission);
  };
  return key;
}

/// Creates the key `flight.vehicles`: a list of strings without a unit.
Key vehicles_key() {
  Key key = list_key("flight.vehicles", KeyType::texts, fleet(&flight::FleetOptions::names),
                     "Fleet of vehicles that share the mission's views, each specified as in "
                     "flight.vehicle. A name may be listed twice. The first vehicle flies the "
                     "survey. A list of one vehicle is equivalent to flight.vehicle.");
  key.fallback = "none";
  return key;
}

/// Creates the key `flight.pads`: one ground position per vehicle.
Key pads_key() {
  Key key = metre_list_key("flight.pads", KeyType::vectors, fleet(&flight::FleetOptions::pads),
                           "Take-off and landing points of flight.vehicles, in the same order.");
  key.range = between(-1e6, 1e6);
  key.fallback = "a row from flight.takeoff along the side of unknown_box";
  return key;
}

/// Returns the keys of fleets.
std::vector<Key> fleet_keys() {
  return {
      vehicles_key(),
      pads_key(),
      fleet_key("makespan",
                choice_key("flight.fleet_goal", {"makespan", "total_time"},
                           fleet(&flight::FleetOptions::goal),
                           "Objective for distributing the views among flight.vehicles. makespan: "
                           "minimum time until the last landing. total_time: minimum total flight "
                           "time.")),
      fleet_key("10 m",
                number_key("flight.separation", "m", above(0, 10'000),
                           fleet(&flight::FleetOptions::separation),
                           "Minimum planned separation between any two airborne vehicles of "
                           "flight.vehicles, at all times. Includes their radii and errors.")),
      fleet_key("10 s",
                number_key("flight.timing_tolerance", "s", between(0, 3600),
                           fleet(&flight::FleetOptions::timing_tolerance),
                           "Maximum time by which each vehicle of flight.vehicles may be early or "
                           "late during its flight without violating flight.separation.")),
  };
}

/// Creates the key `flight.extra_unknown_boxes`: boxes around neighbours.
Key extra_unknown_boxes_key() {
  Key key = metre_list_key(
      "flight.extra_unknown_boxes", KeyType::vectors, section(&FlightSection::extra_unknown_boxes),
      "Additional boxes in which unknown space is treated as occupied, for example around "
      "neighbouring targets: the lower and upper corner of each box. The package stores the "
      "measured space in these boxes for the joint flight.");
  key.range = between(-1e6, 1e6);
  return key;
}

/// Returns the keys that determine how legs are verified.
std::vector<Key> safety_keys() {
  return {
      text_key(
          "flight.vehicle", flight(&flight::FlightOptions::vehicle_name),
          "Vehicle: a preset of flight/motion/presets, or the path of a vehicle file (NAME.yaml), "
          "relative to the mission file. With a vehicle, the survey uses only views that the "
          "vehicle can reach, and the package contains the route. none: every view is reachable."),
      number_key("flight.clearance", "m", above(0, 1000), flight(&flight::FlightOptions::clearance),
                 "Minimum distance between the vehicle's centre and anything not known to be free, "
                 "verified for every leg. Includes the vehicle radius and the position, tracking "
                 "and map errors; the remainder is margin."),
      otherwise("the vehicle's",
                number_key("flight.position_error", "m", between(0, 100),
                           flight(&flight::FlightOptions::position_error),
                           "Maximum navigation error. Typical: 0.05 m with RTK, 1.5 to 3 m "
                           "without.")),
      number_key("flight.tracking_error", "m", between(0, 100),
                 flight(&flight::FlightOptions::tracking_error),
                 "Maximum cross-track error on a straight leg between stops."),
      number_key("flight.map_error", "m", between(0, 100),
                 flight(&flight::FlightOptions::map_error),
                 "Maximum error of measured obstacles (noise and registration)."),
      otherwise(
          "planner.scene_box",
          box_corner("flight.unknown_box.min", section(&FlightSection::unknown_box), false,
                     "Lower corner of the box in which unknown space is treated as occupied. "
                     "Outside it, airspace above the ground is assumed free, except for measured "
                     "obstacles and obstacles in prior data; the pilot must check it.")),
      otherwise("planner.scene_box",
                box_corner("flight.unknown_box.max", section(&FlightSection::unknown_box), true,
                           "Upper corner of the unknown box.")),
      extra_unknown_boxes_key(),
      number_key("flight.no_return_free_range", "m", between(0, 1e4),
                 flight(&flight::FlightOptions::free_without_return),
                 "Depth up to which no-return pixels count as free space. 0: no-return pixels are "
                 "ignored, as required for sensors that may miss dark, shiny or thin surfaces."),
  };
}

/// Returns the keys that determine how legs are flown.
std::vector<Key> conduct_keys() {
  return {
      otherwise("on the ground next to unknown_box, near the first view",
                vector_key("flight.takeoff", "m", between(-1e6, 1e6),
                           flight(&flight::FlightOptions::takeoff),
                           "Take-off point, where the vehicle also lands.")),
      otherwise("5, or flight.clearance + 1 if larger",
                number_key("flight.takeoff_climb", "m", between(0, 1000),
                           flight(&flight::FlightOptions::takeoff_climb),
                           "Vertical climb above the take-off point before the first leg.")),
      rally_key(),
      otherwise(
          "from the prior terrain if not measured",
          angle_key("flight.pad_slope_deg", between(0, 60),
                    flight(&flight::FlightOptions::pad_slope),
                    "Slope of the ground at the take-off point and the rally points, as inspected "
                    "by the pilot. Slopes that the survey measures take precedence.")),
      angle_key("flight.max_pad_slope_deg", between(0, 60),
                flight(&flight::FlightOptions::max_pad_slope),
                "Maximum slope of the ground for take-off and landing."),
      number_key("flight.cruise_speed", "m/s", above(0, 100),
                 flight(&flight::FlightOptions::cruise_speed), "Cruise speed on legs."),
      number_key("flight.hold", "s", between(0, 3600), flight(&flight::FlightOptions::hold),
                 "Hover time at each view before the capture, after the vehicle, its heading and "
                 "the gimbal have settled."),
      number_key("flight.hold_after", "s", between(0, 3600),
                 flight(&flight::FlightOptions::hold_after),
                 "Hover time after the capture, for shutter lag, exposure and readout."),
      number_key("flight.wind_speed", "m/s", between(0, 100),
                 flight(&flight::FlightOptions::wind_speed),
                 "Steady wind speed, used for time and energy estimates."),
      angle_key("flight.wind_from_deg", between(0, 360), flight(&flight::FlightOptions::wind_from),
                "Direction from which the wind blows, clockwise from north."),
      number_key("flight.battery_temperature", "degrees Celsius", between(-40, 60),
                 flight(&flight::FlightOptions::temperature),
                 "Battery temperature. Cold batteries hold less energy."),
      number_key("flight.reserve", "fraction", between(0, 0.9),
                 flight(&flight::FlightOptions::reserve),
                 "Fraction of the battery left at the landing of every sortie."),
      otherwise(
          "orbit or strips with sensor.lidar, otherwise none",
          choice_key(
              "flight.initial_pattern", {"none", "orbit", "strips"},
              section(&FlightSection::initial_pattern),
              "Flight pattern flown outside unknown_box before view planning starts: orbits around "
              "the box, or strips above it (for boxes wider than twice their height).")),
      choice_key(
          "flight.views", {"fastest", "survey", "replanned"}, flight(&flight::FlightOptions::views),
          "Views of the exported mission. fastest: the faster of the next two that keeps the "
          "coverage of the surveyed views in a predicted re-flight. survey: the surveyed views. "
          "replanned: new views and a new tour, optimised together to cover the measured surface "
          "in less time (planner skycap only). Without that planner, with flight.order: survey, "
          "with flight.vehicles and in LiDAR surveys in flight, fastest selects the surveyed "
          "views."),
      choice_key("flight.order", {"shortest", "survey"}, flight(&flight::FlightOptions::order),
                 "Order of the views in the exported mission: shortest tour found, or order of the "
                 "survey."),
      choice_key("flight.free_space", {"measured", "assumed"}, section(&FlightSection::free_space),
                 "Free space in a photo mission or an inspection, which do not measure free space. "
                 "measured: only outside flight.unknown_box. assumed: everywhere beyond the "
                 "clearance and the uncertainty of prior data; the pilot must check the airspace "
                 "for trees, wires "
                 "and anything that the prior data does not contain."),
      choice_key("flight.style", {"stop", "blend", "smooth", "fly-through"},
                 flight(&flight::FlightOptions::style),
                 "Flight style at the corners of the route. stop: stop at each corner. blend: "
                 "round the corners. smooth: one smooth curve, where it is verified and faster. "
                 "fly-through: fly-through capture without stops at views, at a speed that keeps "
                 "images sharp (sensor.exposure). Trajectories (csv, ned-csv, tum) and KML contain "
                 "curves; with the other files, the vehicle stops at corners and views."),
  };
}

}  // namespace

std::vector<Key> site_keys() {
  return {
      metre_list_key(
          "site.geofence", KeyType::polygon, [](auto& m) -> auto& { return m.site.geofence; },
          "Geofence: polygon of [east, north] positions in the mission frame that contains all "
          "views."),
      metre_list_key(
          "site.no_fly", KeyType::volumes, [](auto& m) -> auto& { return m.site.no_fly; },
          "No-fly volumes: upright prisms that no view or leg may enter; floor and ceiling are z "
          "in the mission frame."),
      otherwise("unlimited", number_key(
                                 "site.min_height", "m", between(-1e6, 1e6),
                                 [](auto& m) -> auto& { return m.site.min_height; },
                                 "Minimum z of a view in the mission frame.")),
      otherwise("unlimited", number_key(
                                 "site.max_height", "m", between(-1e6, 1e6),
                                 [](auto& m) -> auto& { return m.site.max_height; },
                                 "Maximum z of a view in the mission frame.")),
      otherwise(
          "unknown",
          number_key(
              "site.latitude_deg", "degrees", between(-90, 90),
              [](auto& m) -> auto& { return m.georeference.latitude_deg; },
              "WGS84 latitude of the origin of the mission frame (x east, y north, z up). Without "
              "a georeference, only local coordinates are written, and no mission files.")),
      otherwise("unknown", number_key(
                               "site.longitude_deg", "degrees", between(-180, 180),
                               [](auto& m) -> auto& { return m.georeference.longitude_deg; },
                               "WGS84 longitude of the origin, east positive.")),
      number_key(
          "site.ellipsoid_height", "m", between(-1000, 10000),
          [](auto& m) -> auto& { return m.georeference.ellipsoid_height; },
          "Height of the origin above the WGS84 ellipsoid."),
      otherwise(
          "from EGM96",
          number_key(
              "site.geoid_undulation", "m", between(-120, 120),
              [](auto& m) -> auto& { return m.georeference.geoid_undulation; },
              "Height of the geoid (EGM96) above the ellipsoid at the site. Formats with heights "
              "above mean sea level require it if PROJ's EGM96 grid is not installed.")),
  };
}

std::vector<Key> flight_keys() { return joined({safety_keys(), conduct_keys(), fleet_keys()}); }

}  // namespace skycap::missions::config
