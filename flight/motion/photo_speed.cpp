#include "flight/motion/photo_speed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

/// Motion during the exposure and the readout, in ground sampling distances.
constexpr double max_blur = 0.5, max_skew = 1.0;

double ratio(double length, double time) {
  return time > 0.0 ? length / time : std::numeric_limits<double>::infinity();
}

}  // namespace

void PhotoShutter::validate() const {
  const auto require = [](const char* name, double value, bool is_right, const char* rule) {
    if (is_right && std::isfinite(value)) return;
    throw Error(ErrorKind::bad_config,
                std::string(name) + " is " + std::to_string(value) + "; it must be " + rule);
  };
  require("gsd", gsd, gsd > 0.0, "above 0");
  require("exposure", exposure, exposure >= 0.0, "at least 0");
  require("readout", readout, readout >= 0.0, "at least 0");
  require("min_interval", min_interval, min_interval >= 0.0, "at least 0");
}

double PhotoSpeeds::min() const { return std::min({blur, rolling_shutter, trigger, vehicle}); }

const char* PhotoSpeeds::limit() const {
  struct Limit {
    double speed;
    const char* name;
  };
  const std::array limits{Limit{vehicle, "cruise speed"}, Limit{blur, "motion blur"},
                          Limit{rolling_shutter, "rolling shutter"},
                          Limit{trigger, "trigger interval"}};
  return std::ranges::min_element(limits, {}, &Limit::speed)->name;
}

PhotoSpeeds photo_speeds(const PhotoShutter& shutter, double spacing, double vehicle_speed) {
  return {.blur = ratio(max_blur * shutter.gsd, shutter.exposure),
          .rolling_shutter = ratio(max_skew * shutter.gsd, shutter.readout),
          .trigger = ratio(spacing, shutter.min_interval),
          .vehicle = vehicle_speed};
}

}  // namespace skycap::flight
