#include <skycap/missions/sensors.h>

#include "example.h"

// Looks up sensor presets by name, as configurations of the simulators.
const Example sensors_example("missions/sensors", [] {
  return skycap::missions::library::laser_scanner("ouster_os1_128").channels.size() == 128 &&
         skycap::missions::library::depth_camera("intel_d435").camera.width == 848;
});
