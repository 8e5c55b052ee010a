/// Conversion between the mission frame and the autopilot's positions: latitude, longitude, and
/// height above home. Home is the pad, where the vehicle was armed.
#pragma once

#include <Eigen/Core>

#include "flight/export/geodesy.h"

namespace skycap::missions::online {

struct VehiclePosition {
  double latitude_deg = 0.0, longitude_deg = 0.0;
  double height_above_home = 0.0;  ///< [m]
};

class FlightFrame {
 public:
  FlightFrame(const flight::GeodeticPoint& origin, const Eigen::Vector3d& pad)
      : frame_(origin), home_height_(frame_.to_geodetic(pad).height) {}

  Eigen::Vector3d to_mission(const VehiclePosition& position) const {
    return frame_.to_local(
        {position.latitude_deg, position.longitude_deg, home_height_ + position.height_above_home});
  }

  VehiclePosition to_vehicle(const Eigen::Vector3d& position) const {
    const flight::GeodeticPoint point = frame_.to_geodetic(position);
    return {point.latitude_deg, point.longitude_deg, point.height - home_height_};
  }

 private:
  flight::LocalFrame frame_;
  double home_height_;  ///< Ellipsoidal height of the pad [m].
};

}  // namespace skycap::missions::online
