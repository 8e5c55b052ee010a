#include <skycap/geometry/error.h>
#include <skycap/sim/sensor.h>

#include "example.h"

// Configures a scanner with 32 lasers and wide beams. A scanner that never fires is rejected.
const Example sensor_example("sim/sensor", [] {
  skycap::sim::LidarConfig scanner;
  scanner.channels.clear();
  for (int laser = 0; laser < 32; ++laser) {
    scanner.channels.push_back({.elevation = -0.3 + 0.02 * laser});
  }
  scanner.firing_period = 5e-5;  // [s]
  scanner.beam = {.rings = 2, .divergence_horizontal = 3e-3, .divergence_vertical = 3e-3};
  scanner.validate();
  scanner.firing_period = 0.0;
  try {
    scanner.validate();
  } catch (const skycap::Error&) {
    return true;  // the message contains the reason
  }
  return false;
});
