#include <skycap/survey/view_limits.h>

#include "example.h"

// Tests views inside the fence, below the minimum height, and outside.
const Example view_limits_example("survey/view_limits", [] {
  skycap::survey::ViewLimits limits;
  limits.min_height = 2.0;
  limits.geofence = {{-30, -30}, {30, -30}, {30, 30}, {-30, 30}};
  limits.validate();
  return limits.allow(skycap::geometry::look_at({20, 0, 5}, {0, 0, 5})) &&
         !limits.allow(skycap::geometry::look_at({20, 0, 1}, {0, 0, 5})) &&
         !limits.allow(skycap::geometry::look_at({40, 0, 5}, {0, 0, 5}));
});
