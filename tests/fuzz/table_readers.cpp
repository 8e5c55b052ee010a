// Tables and small files that accompany a mission: routes of other programs, control points,
// sampled flights, scene tiles, results of other planners, stored intermediate results.
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

#include "flight/flown/imported_route.h"
#include "geometry/io/record_log.h"
#include "geometry/pose/world.h"
#include "missions/batch/benchmark/other_results.h"
#include "missions/config/photo_camera_reader.h"
#include "missions/config/vehicle_reader.h"
#include "missions/evaluation/reachable_space.h"
#include "missions/evaluation/tally_file.h"
#include "missions/inspection/flight_file.h"
#include "missions/package/profile_file.h"
#include "missions/photo/control_points.h"
#include "missions/scene/scene_tiles.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"

namespace skycap::fuzz {
namespace {

namespace fs = std::filesystem;

const flight::Site site{{51.753458, -1.254022, 111.5}, 46.7};

/// Reads a route or a track with each declaration of its heights.
int run_imported(const char* name, const std::uint8_t* bytes, std::size_t size) {
  const auto path = file_with(name, bytes_to_string(bytes, size));
  flight::FlightFacts facts{.site = site};
  facts.vehicle = missions::config::find_vehicle("generic");
  for (const auto heights : {flight::TrackHeights::automatic, flight::TrackHeights::takeoff,
                             flight::TrackHeights::absolute}) {
    run_reader(name, [&] {
      auto route = flight::read_imported_route(path, facts, true, heights);
      require(!route.points.empty(), "a route without points");
      double last = route.points.front().time;
      for (const flight::ImportedPoint& point : route.points) {
        require(point.position.allFinite(), "a waypoint at no position");
        require(point.time >= last, "a route that goes back in time");
        require(point.hold >= 0.0 && point.captures >= 0, "a waypoint with a negative rest");
        last = point.time;
      }
      const std::size_t count = route.points.size();
      const std::size_t removed = flight::remove_pad_column(route, {0, 0, 0}, 2.0, 30.0);
      require(removed + route.points.size() == count, "waypoints that are not counted");
    });
  }
  return 0;
}

int run_flight_csv(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("flight.csv", [&] {
    namespace inspection = missions::inspection;
    const auto flight =
        inspection::read_flight_csv(file_with("flight.csv", bytes_to_string(bytes, size)));
    require(!flight.empty(), "a flight without samples");
    for (std::size_t i = 1; i < flight.size(); ++i) {
      require(flight[i].time > flight[i - 1].time, "a flight that goes back in time");
    }
    inspection::write_flight_csv(flight);
  });
}

/// The caller of these readers adds the file name to the message.
int run_control_points(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("", [&] {
    const auto points = missions::photo::read_control_points(bytes_to_string(bytes, size), site);
    for (const auto& point : points) {
      require(geometry::is_valid_position(point.position), "a point out of the world");
      require(!point.name.empty(), "a point without a name");
    }
  });
}

int run_profile(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("", [&] {
    for (const auto& row : missions::package::read_profile(bytes_to_string(bytes, size))) {
      require(std::isfinite(row.begin) && std::isfinite(row.end) && std::isfinite(row.height),
              "a row without numbers");
    }
  });
}

/// Reads a list of tiles next to one mesh, tiles/a.ply.
int run_tiles(const std::uint8_t* bytes, std::size_t size) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "tiles");
  std::ofstream(folder / "tiles/a.ply") << "ply\n";
  std::ofstream(folder / "scene.tiles", std::ios::binary) << bytes_to_string(bytes, size);
  return run_reader("scene.tiles", [&] {
    missions::scene::SceneOptions scene;
    scene.model = "scene.tiles";
    for (const auto& tile : missions::scene::find_tiles(scene, folder)) {
      require(!tile.shifts.empty(), "a tile that is nowhere");
      for (const auto& shift : tile.shifts) require(shift.allFinite(), "a tile at no position");
    }
  });
}

int run_other_results(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("other.json", [&] {
    const auto file = file_with("other.json", bytes_to_string(bytes, size));
    for (const auto& cell : missions::batch::read_other_results(file)) {
      require(!cell.trials.empty(), "results without trials");
    }
  });
}

int run_photo_camera(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("camera.yaml", [&] {
    missions::config::read_photo_camera(bytes_to_string(bytes, size), "camera.yaml").validate();
  });
}

/// Reads an evaluated part of a cloud: the JSON file, a line "%", the distances.
int run_tally(const std::uint8_t* bytes, std::size_t size) {
  const std::string text = bytes_to_string(bytes, size);
  const std::size_t middle = std::min(text.find("%\n"), size);
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "piece.json", std::ios::binary) << text.substr(0, middle);
  std::ofstream(folder / "distances.bin", std::ios::binary)
      << text.substr(std::min(middle + 2, size));
  return run_reader(folder.string(), [&] {
    if (!missions::evaluation::has_tally(folder, "a")) return;
    const auto tally = missions::evaluation::read_tally(folder, 4);
    missions::evaluation::CloudTally all;
    all.is_covered.resize(4);
    all.add(tally);
  });
}

/// Reads reachable space after its checksum has been corrected, and queries it.
int run_reach(const std::uint8_t* bytes, std::size_t size) {
  std::string text = bytes_to_string(bytes, size);
  constexpr std::size_t head = 80, checksum = 72;
  if (text.size() >= head) {
    const auto put = [&](std::uint32_t value) { std::memcpy(&text[checksum], &value, 4); };
    put(geometry::compute_crc32(std::string_view(text).substr(head)));
    put(geometry::compute_crc32(std::string_view(text).substr(0, head)));
  }
  const auto space = missions::evaluation::ReachableSpace::read(text);
  if (!space) return 0;
  const auto joins = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return true; };
  for (const double at : {0.0, 0.5, 3.0, -1e6, 1e300}) space->leads_to({at, at, at}, joins);
  require(missions::evaluation::ReachableSpace::read(space->bytes()).has_value(),
          "it cannot be read again");
  return 0;
}

constexpr Reader readers[] = {
    {"imported_csv",
     [](const std::uint8_t* b, std::size_t n) { return run_imported("m.csv", b, n); }},
    {"imported_kml",
     [](const std::uint8_t* b, std::size_t n) { return run_imported("m.kml", b, n); }},
    {"imported_plan",
     [](const std::uint8_t* b, std::size_t n) { return run_imported("m.plan", b, n); }},
    {"flight_csv", run_flight_csv},
    {"control_points", run_control_points},
    {"profile", run_profile},
    {"tiles", run_tiles},
    {"other_results", run_other_results},
    {"photo_camera", run_photo_camera},
    {"tally", run_tally},
    {"reach", run_reach},
};

}  // namespace

std::span<const Reader> table_readers() { return readers; }

}  // namespace skycap::fuzz
