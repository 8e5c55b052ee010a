#include "missions/package/fleet/timetable_verification.h"

#include <algorithm>
#include <cmath>

#include "flight/clearance/position_text.h"
#include "flight/fleet/timetable.h"
#include "flight/interpreter/interpret.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using support::short_text;

/// Tolerance of landing times, because route files round positions to centimetres [s].
constexpr double landing_tolerance = 0.5;

std::string make_title(const TimetableRow& row) {
  return "vehicle " + std::to_string(row.vehicle + 1) + ", " + row.file;
}

/// Verification of all rows and their flights.
class TimetableVerifier {
 public:
  TimetableVerifier(const std::filesystem::path& path, const flight::FlightOptions& options)
      : path_(path), options_(options), rows_(read_timetable(path, options)) {
    for (const TimetableRow& row : rows_) {
      flights_.push_back(make_flight(row));
      vehicles_.push_back(row.vehicle);
    }
  }

  TimetableVerification run(double up_to) {
    verification_.sorties = rows_.size();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      verification_.makespan = std::max(verification_.makespan, flights_[i].landing());
      check_landing(i);
      for (std::size_t j = 0; j < rows_.size(); ++j) check_pads_and_turns(i, j);
    }
    check_pairs(up_to);
    return std::move(verification_);
  }

 private:
  flight::TimedFlight make_flight(const TimetableRow& row) const {
    const double jerk = options_.fleet.vehicles.at(row.vehicle).mode.jerk;
    return {interpret_flight_file(path_, row, options_).script, jerk, row.start};
  }

  void check_landing(std::size_t i) {
    const double landing = flights_[i].landing();
    if (std::abs(landing - rows_[i].landing) <= landing_tolerance) return;
    verification_.problems.push_back(make_title(rows_[i]) + " lands at " + short_text(landing) +
                                     " s, not at " + short_text(rows_[i].landing) + " s");
  }

  void check_pads_and_turns(std::size_t i, std::size_t j) {
    const TimetableRow &one = rows_[i], &other = rows_[j];
    if (one.vehicle == other.vehicle) {
      if (one.sortie >= other.sortie || flights_[i].landing() <= other.start) return;
      verification_.problems.push_back(make_title(other) + " starts at " + short_text(other.start) +
                                       " s, before " + one.file + " has landed");
      return;
    }
    const double distance = distance_from(flights_[i].script, other.pad);
    if (distance >= options_.clearance) return;
    verification_.problems.push_back(
        make_title(one) + " violates the separation: it comes within " + short_text(distance) +
        " m of the take-off point of vehicle " + std::to_string(other.vehicle + 1));
  }

  void check_pairs(double up_to) {
    const flight::SeparationRule rule = options_.fleet.rule();
    verification_.distance = up_to;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      for (std::size_t j = i + 1; j < rows_.size(); ++j) {
        if (vehicles_[i] == vehicles_[j]) continue;
        verification_.distance =
            std::min(verification_.distance,
                     verified_distance(flights_[i], flights_[j], rule.tolerance, up_to));
        const auto encounter = too_near(flights_[i], flights_[j], rule);
        if (!encounter) continue;
        verification_.problems.push_back(
            make_title(rows_[i]) + " and " + make_title(rows_[j]) + " may come within " +
            short_text(encounter->distance) + " m of each other, " + short_text(encounter->time) +
            " s after the first start, at " + flight::position_text(encounter->first) + " and " +
            flight::position_text(encounter->second));
      }
    }
  }

  const std::filesystem::path& path_;
  const flight::FlightOptions& options_;
  std::vector<TimetableRow> rows_;
  std::vector<flight::TimedFlight> flights_;
  std::vector<std::size_t> vehicles_;
  TimetableVerification verification_;
};

}  // namespace

InterpretedFile interpret_flight_file(const flight::FlightOptions& own, const std::string& content,
                                      flight::Format format) {
  const flight::FlightFacts facts = own.facts();
  InterpretedFile interpreted{flight::interpret(content, format, facts), {}};
  flight::throw_first(interpreted.route.problems, "cannot be flown");
  if (interpreted.route.segments.empty()) throw Error(ErrorKind::bad_file, "contains no flight");
  const flight::Motion motion(own.required_vehicle(), own.route(facts.pad).conditions);
  interpreted.script = make_flight_script(interpreted.route, motion);
  return interpreted;
}

InterpretedFile interpret_flight_file(const std::filesystem::path& path, const TimetableRow& row,
                                      const flight::FlightOptions& options) {
  const std::filesystem::path file = path.parent_path() / row.file;
  const std::string content = geometry::read_file(file, flight::largest_route_file);
  try {
    return interpret_flight_file(options.for_vehicle(row.vehicle, row.pad), content,
                                 flight::detect_format(file, content));
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
}

std::vector<flight::FleetFlight> fleet_flights(const std::filesystem::path& path,
                                               const flight::FlightOptions& options) {
  std::vector<flight::FleetFlight> flights;
  for (const TimetableRow& row : read_timetable(path, options)) {
    const flight::FlightOptions own = options.for_vehicle(row.vehicle, row.pad);
    const flight::Motion motion(own.required_vehicle(), own.route(row.pad).conditions);
    flights.push_back({{interpret_flight_file(path, row, options).script, motion, std::nullopt},
                       row.vehicle,
                       row.start});
  }
  return flights;
}

std::vector<Vector3d> left_by(const std::filesystem::path& path,
                              const flight::FlightOptions& options, std::size_t vehicle,
                              double after) {
  const double tolerance = options.fleet.timing_tolerance;
  std::vector<Vector3d> left;
  for (const TimetableRow& row : read_timetable(path, options)) {
    if (row.vehicle != vehicle) continue;
    const InterpretedFile interpreted = interpret_flight_file(path, row, options);
    double now = row.start;
    std::size_t next = 0;
    for (std::size_t i = 0; i < interpreted.script.size(); ++i) {
      now += interpreted.script[i].duration();
      if (next == interpreted.route.stops.size()) break;
      const flight::InterpretedStop& stop = interpreted.route.stops[next];
      if (stop.item != interpreted.route.segments[i].to_item) continue;
      ++next;
      if (now + tolerance > after) left.push_back(stop.position);
    }
  }
  return left;
}

TimetableVerification verify_timetable(const std::filesystem::path& path,
                                       const flight::FlightOptions& options, double up_to) {
  return TimetableVerifier(path, options).run(up_to);
}

}  // namespace skycap::missions::package
