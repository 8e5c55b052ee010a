// Files in folders that a user specifies: recordings, journals, results.
#include <algorithm>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/io/record_log.h"
#include "geometry/points/depth_image.h"
#include "geometry/pose/world.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/online/recordings/rawlog_sequence.h"
#include "missions/online/recordings/recorded_sequence.h"
#include "missions/package/fleet/timetable_file.h"
#include "missions/package/package.h"
#include "missions/report/result_pages.h"
#include "missions/scan/laser_checkpoint.h"
#include "missions/simulation/survey_journal.h"
#include "missions/support/journal_text.h"
#include "missions/support/sha256.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::fuzz {
namespace {

namespace fs = std::filesystem;

/// Reads a journal, and opens it for writing.
int run_records(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("x.journal", [&] {
    const fs::path file = file_with("x.journal", bytes_to_string(bytes, size));
    const geometry::RecordedLines lines = geometry::read_records(file);
    require(lines.whole_bytes + lines.torn_bytes == size, "bytes that nobody has counted");
    geometry::RecordLog(file).append("one more");
    auto again = geometry::read_records(file);
    require(again.torn_bytes == 0, "a journal that stays torn");
    require(again.records.back() == "one more", "a record that is not there");
    again.records.pop_back();
    require(again.records == lines.records, "records that change when another comes");
  });
}

/// Reads the journal of an unfinished survey: the valid first record, followed by these lines.
int run_survey_journal(const std::uint8_t* bytes, std::size_t size) {
  using namespace missions;
  static const config::MissionSetup setup = config::parse_mission(
      "scene: {model: 'builtin:teapot', detail: coarse, longest_side: 1.0}\n"
      "planner: {density: 5200, resolution_radius: 0.0525, occluder_spacing: 0.03}\n"
      "evaluation: {coverage_distance: 0.03, samples: 100, visible_directions: 10,\n"
      "             attainable_views: 0}\n",
      "m.yaml");
  static const evaluation::SurveyScene scene(setup.simulation, ".", setup.run.threads);
  static const std::string identity = support::identity_text(
      setup.identity(),
      {{"format", support::journal_format},
       {"surface",
        support::sha256(std::as_bytes(std::span<const Eigen::Vector3f>(scene.samples().points)))}});
  return run_reader("survey.journal", [&] {
    const fs::path journal = fresh_folder() / "survey.journal";
    std::size_t lines = 0;
    {
      geometry::RecordLog log(journal);
      log.append(identity);
      std::istringstream text(bytes_to_string(bytes, size));
      for (std::string line; std::getline(text, line); ++lines) log.append(line);
    }
    const simulation::SurveyJournal known(journal, setup.identity(), scene, true);
    require(known.views() == lines, "views that are not in the journal");
  });
}

/// Reads the last record in a scan journal.
int run_checkpoint(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("scan.journal", [&] {
    using Json = nlohmann::ordered_json;
    Json json;
    try {
      json = geometry::parse_json<Json>(bytes_to_string(bytes, size));
    } catch (const Json::exception&) {
      return;
    }
    missions::scan::to_json(missions::scan::parse_laser_checkpoint(json, 1, "scan.journal"));
  });
}

/// Reads the two lists of a TUM sequence, separated by a line "%".
int run_sequence(const std::uint8_t* bytes, std::size_t size) {
  const std::string text = bytes_to_string(bytes, size);
  const std::size_t middle = std::min(text.find("%\n"), size);
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "depth.txt", std::ios::binary) << text.substr(0, middle);
  std::ofstream(folder / "groundtruth.txt", std::ios::binary)
      << text.substr(std::min(middle + 2, size));
  return run_reader(folder.string(), [&] {
    const auto sequence = missions::online::read_sequence(folder, 1000);
    require(!sequence.frames.empty(), "a sequence of nothing");
    for (const auto& frame : sequence.frames) {
      require(geometry::is_valid_position(frame.world_from_sensor.translation()),
              "a frame of no place");
    }
  });
}

/// Reads a rawlog with the MRPT library in a separate process, which libFuzzer cannot observe, and
/// parses that process's output, which it can.
int run_rawlog(const std::uint8_t* bytes, std::size_t size) {
  namespace online = missions::online;
  return run_reader("x.rawlog", [&] {
    const fs::path file = file_with("x.rawlog", bytes_to_string(bytes, size));
    online::RawlogSequence sequence(file, {}, [](const std::string&) {});
    require(!sequence.pose_source().empty(), "poses from nowhere");
    while (const auto frame = sequence.next()) {
      require(geometry::is_valid_position(frame->world_from_sensor.translation()),
              "a frame of no place");
      const auto found = online::make_scan(*frame, {.is_scanner = true}, {});
      require(found.scan.points.size() <= geometry::max_depth_pixels, "a scan of too many points");
    }
  });
}

/// Reads a depth image after its chunk checksums have been corrected.
int run_depth_png(const std::uint8_t* bytes, std::size_t size) {
  std::string text = bytes_to_string(bytes, size);
  for (std::size_t at = 8; at + 12 <= text.size();) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[at + i]); };
    const std::size_t length = (std::size_t{byte(0)} << 24) | (std::size_t{byte(1)} << 16) |
                               (std::size_t{byte(2)} << 8) | byte(3);
    if (length > text.size() - at - 12) break;
    const std::uint32_t crc =
        geometry::compute_crc32(std::string_view(text).substr(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) {
      text[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    }
    at += 12 + length;
  }
  return run_reader("depth.png", [&] {
    const geometry::DepthImage image = geometry::read_depth_png(file_with("depth.png", text));
    require(image.width > 0 && image.height > 0 &&
                image.values.size() ==
                    static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
            "an image of other sides");
  });
}

int run_timetable(const std::uint8_t* bytes, std::size_t size) {
  const std::string vehicle = "vehicle: generic";
  static const missions::config::MissionSetup setup = missions::config::parse_mission(
      tests::flight_mission().replace(tests::flight_mission().find(vehicle), vehicle.size(),
                                      "vehicles: [generic, generic_ardupilot], separation: 6, "
                                      "timing_tolerance: 2"),
      "m.yaml");
  return run_reader("timetable.csv", [&] {
    const auto rows = missions::package::read_timetable(
        file_with("timetable.csv", bytes_to_string(bytes, size)), setup.flight());
    for (const auto& row : rows) {
      require(row.vehicle < 2, "a vehicle that the mission does not have");
      require(geometry::is_valid_position(row.pad), "a pad out of the world");
      require(row.landing >= row.start, "a sortie that lands before it takes off");
      require(fs::path(row.file).filename() == row.file, "a file out of the folder");
    }
  });
}

/// Creates the HTML report of results with these figures.
int run_page(const char* name, const std::uint8_t* bytes, std::size_t size) {
  namespace report = missions::report;
  const fs::path folder = fresh_folder();
  std::ofstream(folder / name, std::ios::binary) << bytes_to_string(bytes, size);
  return run_reader(name, [&] {
    for (const report::MadePage& page : report::made_pages(folder, 100, {})) {
      require(page.text && page.text->ends_with("</html>\n"), "a page that has no end");
      require(page.text->find("<img src=x") == std::string::npos, "a name that is no text");
    }
  });
}

constexpr Reader readers[] = {
    {"records", run_records},
    {"survey_journal", run_survey_journal},
    {"checkpoint", run_checkpoint},
    {"sequence", run_sequence},
    {"rawlog", run_rawlog},
    {"depth_png", run_depth_png},
    {"timetable", run_timetable},
    {"page_survey",
     [](const std::uint8_t* b, std::size_t n) { return run_page("summary.json", b, n); }},
    {"page_scan", [](const std::uint8_t* b, std::size_t n) { return run_page("scan.json", b, n); }},
    {"page_trials",
     [](const std::uint8_t* b, std::size_t n) { return run_page("trials.json", b, n); }},
    {"page_district",
     [](const std::uint8_t* b, std::size_t n) { return run_page("district.json", b, n); }},
    {"page_benchmark",
     [](const std::uint8_t* b, std::size_t n) { return run_page("results.json", b, n); }},
};

}  // namespace

std::span<const Reader> record_readers() { return readers; }

}  // namespace skycap::fuzz
