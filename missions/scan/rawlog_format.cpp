// Loader of the module that contains MRPT; see rawlog_module.h.
#include "missions/scan/cloud_formats.h"
#include "missions/scan/rawlog_module.h"
#include "missions/support/module.h"

namespace skycap::missions::scan {
namespace {

SensorMotion motion(const sim::Trajectory& trajectory, const Eigen::Isometry3d& mount) {
  return {[&trajectory](double time) { return trajectory.pose(time); }, mount};
}

}  // namespace

std::shared_ptr<const CloudFormat> rawlog_format(const CloudFormatContext& context) {
  const sim::LidarFlight& flight = context.flight;
  const RawlogSetup setup = {context.sensor_name, context.sensor, flight.ground_truth.start(),
                             motion(flight.estimated, flight.estimated_body_from_sensor),
                             motion(flight.ground_truth, flight.body_from_sensor)};
  const auto make_format =
      support::module_function<MakeRawlogFormat>("libskycap_rawlog.so", make_rawlog_format_name);
  return std::shared_ptr<const CloudFormat>(make_format(setup));
}

}  // namespace skycap::missions::scan
