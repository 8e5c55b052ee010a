// Keys of the section `scan`: recorded data and flight of the sensor platform.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

/// Returns an accessor of a member of the scan settings.
auto scan(auto member) {
  return [member](auto& m) -> auto& { return m.scan.*member; };
}

std::vector<Key> orbit_keys() {
  using Orbit = scan::OrbitOptions;
  const auto orbit = [](auto member) {
    return [member](auto& m) -> auto& { return m.scan.orbit.*member; };
  };
  return {
      vector_key("scan.orbit.centre", "m", between(-1e6, 1e6), orbit(&Orbit::centre),
                 "Centre of the platform's circles; heights are relative to its z."),
      number_key("scan.orbit.radius", "m", above(0, 1e4), orbit(&Orbit::radius),
                 "Radius of the circles."),
      number_key("scan.orbit.min_height", "m", between(-1e4, 1e4), orbit(&Orbit::min_height),
                 "Height of the first circle."),
      number_key("scan.orbit.max_height", "m", between(-1e4, 1e4), orbit(&Orbit::max_height),
                 "Height of the last circle."),
      integer_key(
          "scan.orbit.circles", "", between(1, 1000), orbit(&Orbit::circles),
          "Number of circles, evenly spaced in height. A single circle is flown at min_height."),
      number_key("scan.orbit.speed", "m/s", above(0, 100), orbit(&Orbit::speed),
                 "Speed along the circles and the climbs between them."),
      angle_key("scan.orbit.start_deg", between(-360, 360), orbit(&Orbit::start),
                "Start of the circles: direction from the centre, counter-clockwise from east."),
  };
}

std::vector<Key> navigation_keys() {
  using Navigation = sim::NavigationErrors;
  const auto navigation = [](auto member) {
    return [member](auto& m) -> auto& { return m.scan.navigation.*member; };
  };
  return {
      number_key("scan.navigation.horizontal_sigma", "m", between(0, 100),
                 navigation(&Navigation::horizontal_sigma),
                 "Standard deviation of the estimated position along each horizontal axis (east "
                 "and north), in scans and in surveys with a vehicle."),
      number_key("scan.navigation.vertical_sigma", "m", between(0, 100),
                 navigation(&Navigation::vertical_sigma),
                 "Standard deviation of the estimated height."),
      angle_key("scan.navigation.tilt_sigma_deg", between(0, 45),
                navigation(&Navigation::tilt_sigma),
                "Standard deviation of the estimated roll and pitch."),
      angle_key("scan.navigation.heading_sigma_deg", between(0, 45),
                navigation(&Navigation::heading_sigma),
                "Standard deviation of the estimated heading."),
      number_key("scan.navigation.correlation_time", "s", between(0, 1e5),
                 navigation(&Navigation::correlation_time),
                 "Correlation time of the navigation errors: time in which their correlation falls "
                 "to 1/e."),
  };
}

std::vector<Key> source_keys() {
  return {
      text_key("scan.sensor", scan(&scan::ScanFlightOptions::sensor),
               "Sensor of skycap scan: a preset of sim/sensors/presets, or the path of a sensor "
               "file (NAME.yaml), relative to the mission file."),
      otherwise(
          "the orbit below",
          text_key("scan.route", scan(&scan::ScanFlightOptions::route),
                   "Route file to fly, relative to the mission file; equivalent to --route.")),
  };
}

std::vector<Key> platform_keys() {
  return {
      choice_key("scan.crs", {"local", "utm"}, scan(&scan::ScanFlightOptions::crs),
                 "Coordinates of LAS and E57 files: local is the mission frame; utm is WGS84/UTM "
                 "in the zone of the site, which requires a georeference. Heights are above the "
                 "EGM96 geoid if site.geoid_undulation is known, otherwise above the ellipsoid."),
      number_key("scan.speed", "m/s", above(0, 100), scan(&scan::ScanFlightOptions::speed),
                 "Speed along a route whose file contains no times."),
      vector_key("scan.mount.position", "m", between(-10, 10),
                 scan(&scan::ScanFlightOptions::mount_position),
                 "Position of the sensor in the platform frame (x forward, y left, z up)."),
      angles_key("scan.mount.rotation_deg", between(-360, 360),
                 scan(&scan::ScanFlightOptions::mount_rotation),
                 "Rotation of the sensor in the platform frame: about x, then y, then z."),
  };
}

std::vector<Key> recording_keys() {
  return {
      vector_key("scan.lever_arm_error", "m", between(-10, 10),
                 scan(&scan::ScanFlightOptions::lever_arm_error),
                 "Lever-arm error: error of the estimated mount.position."),
      angles_key("scan.boresight_error_deg", between(-45, 45),
                 scan(&scan::ScanFlightOptions::boresight_error),
                 "Boresight error: error of the estimated mount rotation, small angles about the "
                 "platform's axes."),
      number_key("scan.frame_period", "s", between(1e-6, 1e5),
                 scan(&scan::ScanFlightOptions::frame_period),
                 "Interval between camera images along a route that does not define them."),
      number_key("scan.depth_unit", "m", above(0, 1), scan(&scan::ScanFlightOptions::depth_unit),
                 "Depth of one step of a 16-bit depth image."),
  };
}

}  // namespace

std::vector<Key> scan_keys() {
  return joined(
      {source_keys(), orbit_keys(), platform_keys(), navigation_keys(), recording_keys()});
}

}  // namespace skycap::missions::config
