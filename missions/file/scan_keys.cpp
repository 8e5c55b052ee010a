// What `skycap scan` records, and how the carrier flies.
#include "missions/file/key_builders.h"

namespace skycap::missions::file {

std::vector<Key> scan_keys() {
  const auto scan = [](auto member) {
    return [member](Mission & m) -> auto& { return m.scan.*member; };
  };
  const auto orbit = [](auto member) {
    return [member](Mission & m) -> auto& { return m.scan.orbit.*member; };
  };
  const auto navigation = [](auto member) {
    return [member](Mission & m) -> auto& { return m.scan.navigation.*member; };
  };
  using Scan = ScanConfig;
  using Orbit = OrbitConfig;
  using Navigation = sim::NavigationErrors;
  return {
      number(
          "scene.reflectance", "", between(0, 1),
          [](Mission & m) -> auto& { return m.scene.reflectance; },
          "Diffuse reflectance of surfaces at the laser's wavelength, for skycap scan."),
      otherwise("-", text(
                         "scene.materials", [](Mission & m) -> auto& { return m.scene.materials; },
                         "YAML file of reflectances, a line NAME: VALUE for each material of the "
                         "model (usemtl of an OBJ), relative to the mission file.")),
      text("scan.sensor", scan(&Scan::sensor),
           "Sensor of skycap scan: a preset of sim/sensors/presets, or the path of a description "
           "(NAME.yaml), relative to the mission file."),
      otherwise("the orbit below",
                text("scan.route", scan(&Scan::route),
                     "File of the route that is flown, relative to the mission file; the same as "
                     "--route.")),
      vector("scan.orbit.centre", "m", between(-1e6, 1e6), orbit(&Orbit::centre),
             "Point round which the carrier circles; heights count from its z."),
      number("scan.orbit.radius", "m", above(0, 1e4), orbit(&Orbit::radius),
             "Radius of the circles."),
      number("scan.orbit.lowest", "m", between(-1e4, 1e4), orbit(&Orbit::lowest),
             "Height of the first circle."),
      number("scan.orbit.highest", "m", between(-1e4, 1e4), orbit(&Orbit::highest),
             "Height of the last circle."),
      integer("scan.orbit.circles", "", between(1, 1000), orbit(&Orbit::circles),
              "How many circles, evenly spaced in height; a single one is the lowest."),
      number("scan.orbit.speed", "m/s", above(0, 100), orbit(&Orbit::speed),
             "Speed along the circles and the climbs between them."),
      number("scan.orbit.start_deg", "degrees", between(-360, 360), orbit(&Orbit::start),
             "Where the circles begin: direction from the centre, anticlockwise from east."),
      choice("scan.crs", {"local", "utm"}, scan(&Scan::crs),
             "Coordinates of LAS files: the mission's frame, or UTM on WGS84, in the zone of the "
             "site, which utm needs; heights are then above the EGM96 geoid if "
             "site.geoid_undulation is known, else above the ellipsoid."),
      number("scan.speed", "m/s", above(0, 100), scan(&Scan::speed),
             "Speed along a route whose file has no times."),
      vector("scan.mount.position", "m", between(-10, 10), scan(&Scan::mount_position),
             "Where the sensor is on its carrier, whose x points forward, y left, z up."),
      vector("scan.mount.rotation_deg", "degrees", between(-360, 360), scan(&Scan::mount_rotation),
             "How the sensor is turned on its carrier: about x, then y, then z."),
      number("scan.navigation.horizontal_sigma", "m", between(0, 100),
             navigation(&Navigation::horizontal_sigma),
             "Standard deviation of the believed position, east and north each."),
      number("scan.navigation.vertical_sigma", "m", between(0, 100),
             navigation(&Navigation::vertical_sigma), "The same of the height."),
      number("scan.navigation.tilt_sigma_deg", "degrees", between(0, 45),
             navigation(&Navigation::tilt_sigma), "The same of roll and of pitch."),
      number("scan.navigation.heading_sigma_deg", "degrees", between(0, 45),
             navigation(&Navigation::heading_sigma), "The same of the heading."),
      number("scan.navigation.correlation_time", "s", between(0, 1e5),
             navigation(&Navigation::correlation_time),
             "How long these errors take to change: their correlation falls to 1/e."),
      vector("scan.lever_arm_error", "m", between(-10, 10), scan(&Scan::lever_arm_error),
             "Error of the believed mount.position."),
      vector("scan.boresight_error_deg", "degrees", between(-45, 45), scan(&Scan::boresight_error),
             "Error of the believed rotation, small angles about the carrier's axes."),
      number("scan.frame_period", "s", between(1e-6, 1e5), scan(&Scan::frame_period),
             "Time between the images of a camera, along a route that does not say where."),
      number("scan.depth_unit", "m", above(0, 1), scan(&Scan::depth_unit),
             "What one step of a 16-bit depth image stands for."),
  };
}

}  // namespace skycap::missions::file
