/// Between the mission's frame and what an autopilot knows of places: latitude, longitude, and the
/// height above where it was armed, which is the pad.
#pragma once

#include <Eigen/Core>

#include "flight/export/geodesy.h"

namespace skycap::missions::online {

struct VehiclePlace {
  double latitude_deg = 0.0, longitude_deg = 0.0;
  double height_above_home = 0.0;  ///< [m]
};

class FlightFrame {
 public:
  FlightFrame(const flight::GeodeticPoint& origin, const Eigen::Vector3d& pad)
      : frame_(origin), home_height_(frame_.to_geodetic(pad).height) {}

  Eigen::Vector3d to_mission(const VehiclePlace& place) const {
    return frame_.to_local(
        {place.latitude_deg, place.longitude_deg, home_height_ + place.height_above_home});
  }

  VehiclePlace to_vehicle(const Eigen::Vector3d& place) const {
    const flight::GeodeticPoint point = frame_.to_geodetic(place);
    return {point.latitude_deg, point.longitude_deg, point.height - home_height_};
  }

 private:
  flight::LocalFrame frame_;
  double home_height_;  ///< above the ellipsoid [m]
};

}  // namespace skycap::missions::online
