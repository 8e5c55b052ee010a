#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "geometry/pose/world.h"
#include "missions/batch/benchmark/methods.h"
#include "missions/batch/benchmark/trials.h"
#include "missions/batch/campaign/campaign_file.h"
#include "missions/batch/district/district_file.h"
#include "missions/batch/district/preparation.h"
#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "missions/config/sensor_reader.h"
#include "missions/config/vehicle_reader.h"
#include "missions/package/package.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"

namespace skycap::fuzz {
namespace {

namespace config = missions::config;

/// Requires that an accepted number is within the range of its key, up to the rounding of degrees.
void require_in_range(const config::Key& key, double value) {
  const double slack = 1e-12 * std::abs(value);
  require(value >= key.range.min - slack && value <= key.range.max + slack,
          key.path + " is " + std::to_string(value));
}

void require_sane(const config::MissionSetup& setup) {
  for (const config::Key& key : config::mission_keys()) {
    const auto value = key.get(*setup.document);
    if (!value) continue;
    if (const auto* number = std::get_if<double>(&*value)) require_in_range(key, *number);
    if (const auto* vector = std::get_if<Eigen::Vector3d>(&*value)) {
      for (const double coordinate : *vector) require_in_range(key, coordinate);
    }
  }
}

int run_mission(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("m.yaml", [&] {
    require_sane(missions::config::parse_mission(bytes_to_string(bytes, size), "m.yaml"));
  });
}

int run_sensor(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("s.yaml", [&] {
    const auto sensor = missions::config::read_sensor(bytes_to_string(bytes, size), "s.yaml");
    std::visit([](const auto& config) { config.validate(); }, sensor.sensor);
  });
}

int run_vehicle(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("v.yaml", [&] {
    missions::config::read_vehicle(bytes_to_string(bytes, size), "v.yaml").validate();
  });
}

int run_summary(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("summary.json", [&] {
    const auto path = file_with("summary.json", bytes_to_string(bytes, size));
    const auto summary = missions::package::read_package_summary(path.parent_path(), {});
    require_sane(summary.mission);
    require(!summary.pad || geometry::is_valid_position(*summary.pad), "a pad out of the world");
    for (const geometry::View& view : summary.views) {
      require(geometry::is_valid_position(view.position), "a view out of the world");
      require(view.direction.allFinite() && view.direction.norm() > 0.0, "a view of nothing");
    }
  });
}

/// Run names must not lead outside the campaign's folder.
int run_campaign(const std::uint8_t* bytes, std::size_t size) {
  namespace batch = missions::batch;
  return run_reader("c.yaml", [&] {
    const batch::Manifest manifest(batch::parse_campaign(bytes_to_string(bytes, size), "c.yaml"));
    require(manifest.size() > 0 && manifest.size() <= batch::max_items, "items without bound");
    for (const std::size_t number : {std::size_t{0}, manifest.size() - 1}) {
      const batch::ManifestLine line = manifest.line(number);
      for (const auto& part : line.folder()) {
        require(!part.empty() && part != "/" && !part.string().starts_with("."),
                "an item out of its campaign: " + line.folder().string());
      }
      require(line.json().find('\n') == std::string::npos, "an item of two lines");
    }
  });
}

bool is_on_earth(const missions::wizard::Click& position) {
  return std::abs(position.latitude_deg) <= 90.0 && std::abs(position.longitude_deg) <= 180.0;
}

/// Results go to a folder with the district's name, and positions are on the Earth.
int run_district(const std::uint8_t* bytes, std::size_t size) {
  namespace batch = missions::batch;
  return run_reader("d.yaml", [&] {
    const auto given = batch::parse_district(bytes_to_string(bytes, size), "d.yaml");
    require(missions::batch::is_plain(given.name), "no name of a folder: " + given.name);
    require(missions::batch::find_method(given.planner) != nullptr, "no planner: " + given.planner);
    require(given.merge_distance >= 0.0 && given.merge_distance <= 100.0,
            "merge_distance is out of its range");
    const batch::TargetChoice& targets = given.targets;
    require(targets.within.empty() || targets.within.size() == 2, "a box without two corners");
    require(targets.distance >= 0.0 && targets.distance <= 50'000.0,
            "distance is out of its range");
    for (const auto& positions : {given.pads, targets.within}) {
      for (const auto& position : positions)
        require(is_on_earth(position), "a place off the Earth");
    }
    require(!targets.near || is_on_earth(*targets.near), "a place off the Earth");
    for (const config::KeyOverride& change : given.set) {
      require(config::find_key(change.path) != nullptr, "a change of no key: " + change.path);
    }
  });
}

/// Reads a plan. The plan that is written from it must be read as equal.
int run_district_plan(const std::uint8_t* bytes, std::size_t size) {
  namespace batch = missions::batch;
  return run_reader(batch::district_plan_name, [&] {
    const auto path = file_with(batch::district_plan_name, bytes_to_string(bytes, size));
    const std::string text = batch::district_plan_json(batch::read_district_plan(path));
    const auto again = file_with(batch::district_plan_name, text);
    require(batch::district_plan_json(batch::read_district_plan(again)) == text,
            "it is another when it is read again");
  });
}

/// Reads a trial. A damaged trial counts as not run and is not an error.
int run_trial(const std::uint8_t* bytes, std::size_t size) {
  const auto path = file_with("trial.json", bytes_to_string(bytes, size));
  missions::batch::finished_trial(path, "");
  return 0;
}

/// Reads a journal, which must only change files within its folder.
int run_journal(const std::uint8_t* bytes, std::size_t size) {
  const auto outside = fresh_folder(), folder = outside / "folder";
  std::filesystem::create_directory(folder);
  for (const auto& path : {outside / "kept", folder / ".part-1-a", folder / "a"}) {
    std::ofstream(path) << "kept";
  }
  std::ofstream(folder / ".commit", std::ios::binary) << bytes_to_string(bytes, size);
  run_reader(folder.string(), [&] { geometry::finish_commit(folder); });
  require(geometry::read_file(outside / "kept") == "kept", "a journal changes other folders");
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(outside)) count += entry.exists();
  require(count == 2, "a journal makes files in other folders");
  return 0;
}

constexpr Reader readers[] = {
    {"mission", run_mission},   {"sensor", run_sensor},     {"vehicle", run_vehicle},
    {"summary", run_summary},   {"trial", run_trial},       {"journal", run_journal},
    {"campaign", run_campaign}, {"district", run_district}, {"prepared", run_district_plan}};

}  // namespace

std::span<const Reader> mission_readers() { return readers; }

}  // namespace skycap::fuzz
