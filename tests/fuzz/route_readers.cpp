#include <cmath>
#include <limits>

#include "flight/calibration/flight_log.h"
#include "flight/export/export.h"
#include "flight/export/parameters.h"
#include "flight/flown/flown_track.h"
#include "flight/interpreter/interpret.h"
#include "geometry/pose/world.h"
#include "missions/config/vehicle_reader.h"
#include "missions/scan/scan_route.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"

namespace skycap::fuzz {
namespace {

const flight::Site site{{51.753458, -1.254022, 111.5}, 46.7};

/// Returns the facts of a mission with all properties against which a route is checked.
flight::FlightFacts full_facts() {
  flight::FlightFacts facts{.site = site};
  facts.vehicle = missions::config::find_vehicle("generic_ardupilot");
  facts.is_pad_known = false;
  facts.rally = {{20, 5, 0}};
  facts.hold = 2.0;
  const std::vector<Eigen::Vector2d> square = {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}};
  facts.no_fly.push_back({"tower", square, 0.0, 30.0});
  facts.fence = flight::Prism{"fence", square, -10.0, 60.0};
  geometry::View view;
  view.position = {3, 4, 10};
  view.direction = {0, 1, 0};
  facts.views.push_back(view);
  facts.photo = flight::PhotoShutter{.gsd = 0.01};
  return facts;
}

/// Reads the positions of a route, its interpretations for two missions and its return altitude.
int run_route(const char* name, const std::uint8_t* bytes, std::size_t size) {
  return run_reader(name, [&] {
    const auto path = file_with(name, bytes_to_string(bytes, size));
    for (const Eigen::Vector3d& position : flight::read_route(path, site, {0, 0, 0})) {
      require(geometry::is_valid_position(position), "a place out of the world");
    }
    for (const flight::FormatInfo& info : flight::formats()) {
      const bool is_own = std::string_view(name).ends_with(info.extension);
      if (is_own) flight::validate(bytes_to_string(bytes, size), info.format);
    }
    const auto height = flight::read_return_height(path);
    require(!height || std::isfinite(*height), "a height of return that is no number");
    static const flight::FlightFacts full = full_facts();
    flight::FlightFacts facts{.site = site};
    facts.vehicle = missions::config::find_vehicle("generic");
    for (const flight::FlightFacts& known : {facts, full}) {
      const auto route = flight::interpret_file(path, known);
      require(std::isfinite(flight::length(route)), "a route of no length");
      for (const flight::InterpretedSegment& segment : route.segments) {
        require(segment.to.allFinite(), "a stretch to nowhere");
      }
      for (const flight::FlownPass& pass : route.is_fly_through) {
        require(pass.position.allFinite(), "a photo at no position");
        require(pass.stops_before <= route.stops.size(), "a photo after a stop that is not there");
      }
    }
  });
}

/// Reads a route and prepares a simulated scan along it.
int run_scan_route(const char* name, const std::uint8_t* bytes, std::size_t size) {
  return run_reader(name, [&] {
    const auto path = file_with(name, bytes_to_string(bytes, size));
    const auto route = missions::scan::read_scan_route(path, {}, missions::scan::Platform::gimbal);
    for (const sim::StampedPose& pose : route.platform.poses()) {
      require(geometry::is_valid_position(pose.position), "a pose out of the world");
      require(std::isfinite(pose.time), "a pose at no time");
      require(std::abs(pose.attitude.norm() - 1.0) < 1e-6, "an attitude that is no rotation");
    }
    for (const double time : route.image_times) require(std::isfinite(time), "an image at no time");
  });
}

int run_trajectory(const char* name, const std::uint8_t* bytes, std::size_t size) {
  run_scan_route(name, bytes, size);
  return run_route(name, bytes, size);
}

int run_parameters(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("", [&] {
    const auto parameters = flight::read_parameters(bytes_to_string(bytes, size));
    for (const flight::Parameter& parameter : parameters) {
      require(std::isfinite(parameter.value), "a parameter that is no number");
    }
    for (const auto autopilot : {flight::AutopilotType::ardupilot, flight::AutopilotType::px4}) {
      const auto height = flight::return_height(parameters, autopilot);
      require(!height || std::isfinite(*height), "a height of return that is no number");
      flight::return_problems(parameters, autopilot);
    }
  });
}

int run_log(const char* name, const std::uint8_t* bytes, std::size_t size) {
  return run_reader(name, [&] {
    double last = -std::numeric_limits<double>::infinity();
    const auto log = flight::read_flight_log(file_with(name, bytes_to_string(bytes, size)));
    for (const flight::LogSample& sample : log.samples) {
      require(sample.time >= last, "a log that goes back in time");
      require(sample.velocity.allFinite() && std::isfinite(sample.power), "a sample of no number");
      last = sample.time;
    }
  });
}

/// Reads the log of a flight and places it in the frame of a mission.
int run_flown(const char* name, const std::uint8_t* bytes, std::size_t size) {
  return run_reader(name, [&] {
    const auto log = flight::read_flown_log(file_with(name, bytes_to_string(bytes, size)));
    const auto track = flight::place_track(log, site, true, {0, 0, 0}, {});
    double last = -std::numeric_limits<double>::infinity();
    for (const flight::TrackState& state : track.states) {
      require(state.time >= last, "a track that goes back in time");
      require(state.position.allFinite(), "a position that is not finite");
      last = state.time;
    }
    for (const flight::TrackState& state : track.captures) {
      require(state.position.allFinite(), "a capture at a position that is not finite");
    }
  });
}

constexpr Reader readers[] = {
    {"plan", [](const std::uint8_t* b, std::size_t n) { return run_route("m.plan", b, n); }},
    {"waypoints",
     [](const std::uint8_t* b, std::size_t n) { return run_route("m.waypoints", b, n); }},
    {"kmz", [](const std::uint8_t* b, std::size_t n) { return run_route("m.kmz", b, n); }},
    {"kml", [](const std::uint8_t* b, std::size_t n) { return run_route("m.kml", b, n); }},
    {"geojson", [](const std::uint8_t* b, std::size_t n) { return run_route("m.geojson", b, n); }},
    {"litchi",
     [](const std::uint8_t* b, std::size_t n) { return run_route("m.litchi.csv", b, n); }},
    {"csv", [](const std::uint8_t* b, std::size_t n) { return run_trajectory("m.csv", b, n); }},
    {"tum", [](const std::uint8_t* b, std::size_t n) { return run_trajectory("m.tum", b, n); }},
    {"views",
     [](const std::uint8_t* b, std::size_t n) { return run_scan_route("views.csv", b, n); }},
    {"dataflash", [](const std::uint8_t* b, std::size_t n) { return run_log("log.bin", b, n); }},
    {"log", [](const std::uint8_t* b, std::size_t n) { return run_log("log.csv", b, n); }},
    {"flown_dataflash",
     [](const std::uint8_t* b, std::size_t n) { return run_flown("log.bin", b, n); }},
    {"flown_ulog", [](const std::uint8_t* b, std::size_t n) { return run_flown("log.ulg", b, n); }},
    {"flown_csv", [](const std::uint8_t* b, std::size_t n) { return run_flown("log.csv", b, n); }},
    {"flown_mrk", [](const std::uint8_t* b, std::size_t n) { return run_flown("log.mrk", b, n); }},
    {"flown_gpx", [](const std::uint8_t* b, std::size_t n) { return run_flown("log.gpx", b, n); }},
    {"flown_srt", [](const std::uint8_t* b, std::size_t n) { return run_flown("log.srt", b, n); }},
    {"flown_tum", [](const std::uint8_t* b, std::size_t n) { return run_flown("log.tum", b, n); }},
    {"parameters", run_parameters},
};

}  // namespace

std::span<const Reader> route_readers() { return readers; }

}  // namespace skycap::fuzz
