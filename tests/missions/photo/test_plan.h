/// Small plan of photos for tests.
#pragma once

#include "flight/route/route.h"
#include "survey/photo/photo_plan.h"

namespace skycap::missions::photo {

inline geometry::PhotoCameraConfig mavic_3e() {
  geometry::PhotoCameraConfig camera;
  camera.name = "mavic_3e_wide";
  camera.focal_length = 0.01229;
  camera.sensor_size = {0.0173, 0.013};
  camera.width = 5280;
  camera.height = 3956;
  camera.min_interval = 0.7;
  return camera;
}

/// Returns a photo with the angles of its view.
inline survey::photo::PlannedPhoto photo(const std::string& name, const geometry::View& view) {
  survey::photo::PlannedPhoto photo;
  photo.name = name;
  photo.view = view;
  photo.yaw = flight::compute_yaw(view);
  photo.pitch = flight::compute_pitch(view);
  photo.gsd = 0.005;
  return photo;
}

/// Returns photos straight down, to the north, slightly down to the east, and up to the south-west.
/// The names are not in the order of the photos.
inline survey::photo::PhotoPlan test_plan() {
  survey::photo::PhotoPlan plan;
  plan.camera = mavic_3e();
  plan.gsd = 0.005;
  plan.view_distance = geometry::PhotoCamera(plan.camera).distance(plan.gsd);
  plan.photos = {photo("photo_0004", {{0, 0, 18}, {0, 0, -1}}),
                 photo("photo_0001", {{0, -15, 3}, {0, 1, 0}}),
                 photo("photo_0002", geometry::look_at({-14, 1, 6}, {0, 0, 2})),
                 photo("photo_0003", geometry::look_at({9, 8, 2}, {0, 0, 5}))};
  plan.photos[2].sortie = 1;
  plan.photos[3].sortie = 1;
  plan.photos[1].time = 62.5;
  return plan;
}

}  // namespace skycap::missions::photo
