#include "flight/interpreter/verified_export.h"

#include <algorithm>
#include <system_error>

#include "flight/export/scanner_commands.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/interpreter/interpret.h"
#include "flight/interpreter/interpreted_route.h"
#include "flight/interpreter/photographs.h"
#include "geometry/error.h"
#include "geometry/io/file.h"

namespace skycap::flight {
namespace {

/// Returns the obstacles for the climb from the pad: only the rules. The pilot must check measured
/// obstacles there.
KnownSpace space_over_pad(const FlightPlan& plan) {
  Obstacles rules;
  rules.no_fly = plan.no_fly;
  rules.fence = plan.fence;
  rules.priors = plan.priors;
  return KnownSpace(without_ground(std::move(rules)));
}

}  // namespace

ExportResult export_flight(const FlightPlan& plan, Format format, const FreeSpace& space,
                           const std::filesystem::path& path) {
  const std::filesystem::path temporary = path.string() + ".part";
  const auto reject = [&](const Problems& problems) {
    if (problems.empty()) return;
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(ErrorKind::bad_geometry,
                path.string() +
                    " was not written: verification of its contents failed: " + problems.front());
  };
  geometry::write_file(temporary, write(plan, format));
  const std::string content = geometry::read_file(temporary);
  reject(validate(content, format));
  const FlightFacts facts = make_flight_facts(plan);
  const InterpretedRoute route = interpret(content, format, facts);
  reject(route.problems);
  // A scanner captures no images. Its views are verified with the recording.
  const bool is_scanned = !commanded_scanner(plan.vehicle.wpml.payload).empty();
  if (captures_images(format) && !is_scanned) reject(missing_photographs(route, facts));
  const double clearance = std::max(0.0, plan.clearance - rounding_bound);
  const RouteVerification verification =
      verify(route, space, space_over_pad(plan), clearance, plan.clearance + reported_surplus);
  reject(verification.problems);
  std::error_code failure;
  std::filesystem::rename(temporary, path, failure);
  if (failure) {
    throw Error(ErrorKind::bad_file, path.string() + " cannot be written: " + failure.message());
  }
  return {verification.clearance, make_notes(plan, format), list_captures(content, format, route)};
}

}  // namespace skycap::flight
