// Loads the module that knows MRPT; see rawlog_module.h.
#include <dlfcn.h>

#include "geometry/error.h"
#include "missions/cloud_formats.h"
#include "missions/rawlog_module.h"

namespace skycap::missions {
namespace {

MakeRawlogFormat* load_module() {
  // Never unloaded: formats it has made may outlive any scope here.
  void* const module = ::dlopen(SKYCAP_RAWLOG_MODULE, RTLD_NOW | RTLD_LOCAL);
  void* const function = module != nullptr ? ::dlsym(module, make_rawlog_format_name) : nullptr;
  if (function == nullptr) {
    throw Error(ErrorKind::bad_file, std::string("rawlogs need the module ") +
                                         SKYCAP_RAWLOG_MODULE +
                                         ", which cannot be loaded: " + ::dlerror());
  }
  return reinterpret_cast<MakeRawlogFormat*>(function);
}

SensorMotion motion(const sim::Trajectory& trajectory, const Eigen::Isometry3d& mount) {
  return {[&trajectory](double time) { return trajectory.pose(time); }, mount};
}

}  // namespace

std::shared_ptr<const CloudFormat> rawlog_format(const CloudFormatContext& context) {
  const sim::LidarFlight& flight = context.flight;
  const RawlogSetup setup = {context.sensor_name, context.sensor, flight.flown.start(),
                             motion(flight.believed, flight.believed_body_from_sensor),
                             motion(flight.flown, flight.body_from_sensor)};
  return std::shared_ptr<const CloudFormat>(load_module()(setup));
}

}  // namespace skycap::missions
