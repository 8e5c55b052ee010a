#include "missions/wizard/photo_proposal.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/pose/photo_camera.h"
#include "missions/config/photo_camera_reader.h"
#include "missions/config/vehicle_reader.h"

namespace skycap::missions::wizard {
namespace {

/// Ratio of the sampling distances of a coarse and a final pass, as in photo.pass.
constexpr double coarser = 3.0;

/// Maximum position error at which the poses of photos help the reconstruction [m].
constexpr double max_error_of_poses = 0.3;

constexpr double min_stand_off = 3.0;

}  // namespace

bool is_photo_camera(const std::string& sensor) {
  const auto names = config::photo_camera_presets();
  return std::ranges::find(names, sensor) != names.end();
}

std::string find_photo_vehicle(const std::string& camera) {
  if (camera.starts_with("zenmuse_")) return "m350_rtk";
  for (const std::string_view vehicle : config::vehicle_presets()) {
    const std::string own = config::find_vehicle_camera(std::string(vehicle));
    if (!own.empty() && ("dji_" + camera).starts_with(own)) return std::string(vehicle);
  }
  return "generic";
}

PhotoValues propose_photos(const std::string& camera, double gsd, const flight::Vehicle& vehicle,
                           double clearance, double uncertainty, bool is_coarse) {
  const geometry::PhotoCamera photo_camera(config::find_photo_camera(camera));
  constexpr double unit = 0.5;
  PhotoValues values{.camera = camera,
                     .camera_name = photo_camera.config().name,
                     .gsd = gsd,
                     .is_coarse = is_coarse,
                     .has_poses = vehicle.position_error <= max_error_of_poses,
                     .view_distance = photo_camera.distance(is_coarse ? coarser * gsd : gsd)};
  values.stand_off =
      std::max(min_stand_off, unit * std::ceil((clearance + uncertainty) / unit - 1e-9));
  if (values.view_distance < values.stand_off) {
    throw Error(
        ErrorKind::bad_config,
        fmt::format(
            "photo.gsd ({:g} m) requires a view distance of {:.2f} m, which is less than the "
            "stand-off of {:g} m; raise photo.gsd to {:.1g} m or more, or use a longer lens",
            gsd, values.view_distance, values.stand_off,
            1e-4 *
                std::ceil(1e4 * photo_camera.gsd(values.stand_off) / (is_coarse ? coarser : 1.0))));
  }
  return values;
}

std::string photo_sections(const PhotoValues& values, const std::string& camera) {
  std::string text = fmt::format(
      "sensor: {{photo_camera: {}}}  # {}\n"
      "photo:\n"
      "  gsd: {:g}  # ground sampling distance on the surface in metres; the view distance is "
      "{:.2f} m\n",
      camera, values.camera_name, values.gsd, values.view_distance);
  if (values.is_coarse) {
    text +=
        "  # First of two flights, because only an outline is known. Its photos have three times "
        "this gsd.\n"
        "  # Reconstruct a mesh from them, set it as the target's file under `prior`, remove "
        "`pass`, and plan again.\n"
        "  pass: coarse\n";
  }
  if (!values.has_poses) {
    text +=
        "  # Without RTK, the photogrammetry program estimates the poses. With RTK, set "
        "flight.position_error: 0.1\n"
        "  # and poses: known, and remove min_partners.\n"
        "  poses: unknown\n"
        "  min_partners: 4  # stereo partners of each surface point\n";
  }
  return text + fmt::format(
                    "limits:\n  stand_off: {:g}  # metres, minimum distance of a photo from any "
                    "surface\n",
                    values.stand_off);
}

}  // namespace skycap::missions::wizard
