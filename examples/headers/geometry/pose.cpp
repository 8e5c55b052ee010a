#include <skycap/geometry/pose.h>

#include "example.h"

// A target is on the optical axis, z, at its distance from the sensor.
const Example pose_example("geometry/pose", [] {
  const Eigen::Vector3d chimney(10.0, 5.0, 12.0), sensor(10.0, 1.0, 15.0);
  const skycap::geometry::View view = skycap::geometry::look_at(sensor, chimney);
  const Eigen::Isometry3d world_from_camera = skycap::geometry::camera_pose(view);
  return (world_from_camera.inverse() * chimney).isApprox(Eigen::Vector3d(0.0, 0.0, 5.0), 1e-12);
});
