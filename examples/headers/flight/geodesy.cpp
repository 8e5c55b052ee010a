#include <cmath>

#include <skycap/flight/geodesy.h>

#include "example.h"

// Converts a local position to geodetic coordinates and back.
const Example geodesy_example("flight/geodesy", [] {
  const skycap::flight::LocalFrame frame(
      {.latitude_deg = 51.7534, .longitude_deg = -1.2540, .height = 110.0});
  const auto geodetic = frame.to_geodetic({100.0, 0.0, 20.0});  // 100 m east, 20 m up
  return geodetic.longitude_deg > -1.2540 && std::abs(geodetic.height - 130.0) < 0.01 &&
         frame.to_local(geodetic).isApprox(Eigen::Vector3d(100.0, 0.0, 20.0), 1e-8);
});
