#include <skycap/missions/sensors.h>

#include "example.h"

// Sensors by their names, as settings for the simulators.
const Example sensors_example("missions/sensors", [] {
  return skycap::missions::library::laser_scanner("ouster_os1_128").channels.size() == 128 &&
         skycap::missions::library::depth_camera("intel_d435").camera.width == 848;
});
