#include "missions/photo/photo_table.h"

#include <map>

#include "flight/export/text.h"
#include "geometry/angle.h"

namespace skycap::missions::photo {
namespace {

using flight::fixed;
using geometry::degrees_per_radian;
using survey::photo::PhotoPlan;
using survey::photo::PlannedPhoto;

std::string yaw_text(const PlannedPhoto& photo) {
  const std::string text = fixed(photo.yaw * degrees_per_radian, 4);
  return text == "360.0000" ? "0.0000" : text;
}

}  // namespace

std::string image_name(const PlannedPhoto& photo, const std::string& extension) {
  return photo.name + extension;
}

std::string photo_table(const PhotoPlan& plan, const std::optional<flight::Site>& site,
                        const PoseSigmas& sigmas) {
  std::string text =
      "name,event,time_s,x,y,z,latitude,longitude,ellipsoid_height,yaw_deg,pitch_deg,roll_deg,"
      "sigma_xyz_m,sigma_ypr_deg,gsd_m,sortie\n";
  std::optional<flight::LocalFrame> frame;
  if (site) frame.emplace(site->origin);
  std::map<std::uint32_t, int> events;  // Number of photos so far, by sortie.
  for (const PlannedPhoto& photo : plan.photos) {
    const Eigen::Vector3d& position = photo.view.position;
    text += image_name(photo) + "," + std::to_string(++events[photo.sortie]) + "," +
            fixed(photo.time, 2);
    for (const double value : position) text += "," + fixed(value, 3);
    if (frame) {
      const flight::GeodeticPoint point = frame->to_geodetic(position);
      text += "," + flight::degrees(point.latitude_deg) + "," +
              flight::degrees(point.longitude_deg) + "," + fixed(point.height, 3);
    } else {
      text += ",,,";
    }
    text += "," + yaw_text(photo) + "," + fixed(photo.pitch * degrees_per_radian, 4) + ",0.0000," +
            fixed(sigmas.position, 3) + "," + fixed(sigmas.angle * degrees_per_radian, 3) + "," +
            (photo.gsd > 0.0 ? fixed(photo.gsd, 5) : "") + "," + std::to_string(photo.sortie + 1) +
            "\n";
  }
  return text;
}

OdmAngles odm_angles(const PlannedPhoto& photo) {
  return {.yaw_deg = photo.yaw * degrees_per_radian,
          .pitch_deg = photo.pitch * degrees_per_radian + 90.0,
          .roll_deg = 0.0};
}

std::string odm_geolocations(const PhotoPlan& plan, const flight::Site& site,
                             const PoseSigmas& sigmas) {
  std::string text = "EPSG:4326\n";
  const flight::LocalFrame frame(site.origin);
  for (const PlannedPhoto& photo : plan.photos) {
    const flight::GeodeticPoint point = frame.to_geodetic(photo.view.position);
    const OdmAngles angles = odm_angles(photo);
    text += image_name(photo) + " " + flight::degrees(point.longitude_deg) + " " +
            flight::degrees(point.latitude_deg) + " " + fixed(point.height, 3) + " " +
            yaw_text(photo) + " " + fixed(angles.pitch_deg, 4) + " " + fixed(angles.roll_deg, 4) +
            " " + fixed(sigmas.position, 3) + " " + fixed(sigmas.position, 3) + "\n";
  }
  return text;
}

void stage_photo_tables(const PhotoPlan& plan, const std::optional<flight::Site>& site,
                        const PoseSigmas& sigmas, geometry::OutputFolder& folder) {
  folder.write(photo_table_name, photo_table(plan, site, sigmas));
  if (site) folder.write(odm_file_name, odm_geolocations(plan, *site, sigmas));
}

}  // namespace skycap::missions::photo
