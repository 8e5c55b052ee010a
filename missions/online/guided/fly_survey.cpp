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
constexpr double ground_spare = 0.5;

GuidedLimits limits_of(const flight::FlightOptions& flight) {
  const flight::ClearanceBudget clearance = flight.budget();
  return {.corridor = clearance.tracking_error + std::max(clearance.margin, 0.0),
          .arrival = clearance.tracking_error,
          .hold = flight.rest_before(),
          .pad_radius = flight::pad_tolerance,
          .pad_height = flight::pad_height_tolerance};
}

}  // namespace

void require_flyable(const flight::FlightOptions& flight) {
  const auto refuse = [](const std::string& what) { throw Error(ErrorKind::bad_config, what); };
  if (!flight.is_flown()) {
    refuse("flight.vehicle is missing; set an ArduPilot vehicle, such as generic_ardupilot");
  }
  if (flight.capture.is_moving) {
    refuse(
        "sensor.capture: moving conflicts with skycap fly, which scans at views only; remove it "
        "(skycap serve accepts en-route scans)");
  }
  if (flight.flown().dialect != flight::Dialect::ardupilot) {
    refuse(
        "flight.vehicle " + flight.vehicle_name +
        " does not use ArduPilot; live flights require ArduCopter, for example generic_ardupilot");
  }
  if (!flight.has_place) {
    refuse("missing georeference; set site.latitude_deg and site.longitude_deg");
  }
}

FlightEnd fly_survey(const flight::FlightOptions& flight, LiveSurvey& survey,
                     flight::mavlink::Port& port, Sensor sensor, FlightOptions options,
                     const std::stop_token& stop) {
  const Eigen::Vector3d pad = survey.flight()->pad();
  const flight::Motion motion(flight.flown(), flight.route(pad).conditions);
  const GuidedLimits limits = limits_of(flight);
  options.vouched = flight.clearance + ground_spare;
  flight::mavlink::AutopilotLink link(port);
  const flight::GeodeticPoint& origin = flight.site.origin;
  if (MaybeTrouble trouble = prepare(link, FlightFrame(origin, pad), pad, limits, stop)) {
    return {trouble, false};
  }
  GuidedFlight vehicle(link, FlightFrame(origin, pad), motion, limits, stop);
  return LiveFlight(survey, vehicle, motion, std::move(sensor), std::move(options)).run();
}

}  // namespace skycap::missions::online
