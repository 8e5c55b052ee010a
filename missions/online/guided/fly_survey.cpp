#include "missions/online/guided/fly_survey.h"

#include <algorithm>
#include <utility>

#include "flight/interpreter/flight_facts.h"
#include "geometry/error.h"
#include "missions/online/guided/preflight.h"

namespace skycap::missions::online {
namespace {

/// Margin above the clearance from which the climb is verified, so that the ground is not an
/// obstacle [m].
constexpr double ground_margin = 0.5;

GuidedLimits make_limits(const flight::FlightOptions& flight) {
  const flight::ClearanceBudget clearance = flight.budget();
  return {.corridor = clearance.tracking_error + std::max(clearance.margin, 0.0),
          .arrival = clearance.tracking_error,
          .hold = flight.rest_before(),
          .pad_radius = flight::pad_tolerance,
          .pad_height = flight::pad_height_tolerance};
}

}  // namespace

void require_flyable(const flight::FlightOptions& flight) {
  const auto reject = [](const std::string& what) { throw Error(ErrorKind::bad_config, what); };
  if (!flight.has_vehicle()) {
    reject("flight.vehicle is missing; set an ArduPilot vehicle, such as generic_ardupilot");
  }
  if (flight.capture.is_moving) {
    reject(
        "sensor.capture: moving conflicts with skycap fly, which scans at views only; set "
        "sensor.capture: stops (skycap serve accepts en-route scans)");
  }
  if (flight.required_vehicle().autopilot != flight::AutopilotType::ardupilot) {
    reject(
        "flight.vehicle " + flight.vehicle_name +
        " does not use ArduPilot; live flights require ArduCopter, for example generic_ardupilot");
  }
  if (!flight.is_georeferenced) {
    reject("missing georeference; set site.latitude_deg and site.longitude_deg");
  }
}

FlightEnd fly_survey(const flight::FlightOptions& flight, LiveSurvey& survey,
                     flight::mavlink::Port& port, Sensor sensor, FlightOptions options,
                     const std::stop_token& stop) {
  const Eigen::Vector3d pad = survey.flight()->pad();
  const flight::Motion motion(flight.required_vehicle(), flight.route(pad).conditions);
  const GuidedLimits limits = make_limits(flight);
  options.checked_height = flight.clearance + ground_margin;
  flight::mavlink::AutopilotLink link(port);
  const flight::GeodeticPoint& origin = flight.site.origin;
  if (MaybeFailure failure =
          prepare(link, FlightFrame(origin, pad), pad, flight.required_vehicle(), limits, stop)) {
    return {failure, false};
  }
  GuidedFlight vehicle(link, FlightFrame(origin, pad), motion, limits, stop);
  return LiveFlight(survey, vehicle, motion, std::move(sensor), std::move(options)).run();
}

}  // namespace skycap::missions::online
