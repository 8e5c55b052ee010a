#include "missions/online/guided/fly_survey.h"

#include <algorithm>
#include <utility>

#include "flight/interpreter/flight_facts.h"
#include "geometry/error.h"
#include "missions/config/mission_flight.h"
#include "missions/online/guided/preflight.h"

namespace skycap::missions::online {
namespace {

/// The climb is proven from so much above the clearance on, where the ground is no matter [m].
constexpr double ground_spare = 0.5;

GuidedLimits limits_of(const config::Mission& mission) {
  const flight::ClearanceBudget clearance = config::clearance_of(mission);
  return {.corridor = clearance.tracking_error + std::max(clearance.margin, 0.0),
          .arrival = clearance.tracking_error,
          .hold = config::hold_of(mission),
          .pad_radius = flight::pad_tolerance,
          .pad_height = flight::pad_height_tolerance};
}

}  // namespace

void require_flyable(const config::Mission& mission) {
  const auto refuse = [](const std::string& what) { throw Error(ErrorKind::bad_config, what); };
  if (!mission.flight.is_flown()) {
    refuse("flight.vehicle is missing; what flies must be named, such as generic_ardupilot");
  }
  if (mission.sensor.is_moving()) {
    refuse(
        "sensor.capture is moving, and skycap fly takes its scans at views; leave it out (skycap "
        "serve takes in scans from the way)");
  }
  if (config::vehicle_of(mission).dialect != flight::Dialect::ardupilot) {
    refuse("flight.vehicle " + mission.flight.vehicle +
           " is no ArduPilot's; only ArduCopter is flown live, such as generic_ardupilot");
  }
  if (!config::has_place(mission)) {
    refuse(
        "site.latitude_deg and site.longitude_deg are missing; the autopilot must be told places "
        "on the Earth");
  }
}

FlightEnd fly_survey(const config::Mission& mission, online::LiveSurvey& survey,
                     flight::mavlink::Port& port, Sensor sensor, FlightOptions options,
                     const std::stop_token& stop) {
  const Eigen::Vector3d pad = survey.flight()->pad();
  const flight::Motion motion(config::vehicle_of(mission),
                              config::route_options_of(mission, pad).conditions);
  const GuidedLimits limits = limits_of(mission);
  options.vouched = mission.flight.clearance + ground_spare;
  flight::mavlink::AutopilotLink link(port);
  const flight::GeodeticPoint origin = config::site_of(mission).origin;
  if (MaybeTrouble trouble = prepare(link, FlightFrame(origin, pad), pad, limits, stop)) {
    return {trouble, false};
  }
  GuidedFlight vehicle(link, FlightFrame(origin, pad), motion, limits, stop);
  return LiveFlight(survey, vehicle, motion, std::move(sensor), std::move(options)).run();
}

}  // namespace skycap::missions::online
