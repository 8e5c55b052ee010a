// Random corruption of each mission file in a package. A file is rejected with the location of the
// error, or an independent flight of its items keeps the mission's clearance according to CGAL's
// exact distances. The package is that of a small mission, or those in SKYCAP_PACKAGES (folders
// separated by colons).
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "flight/export/wpml_file.h"
#include "flight/interpreter/interpreted_route.h"
#include "flight/interpreter/mission_interpreter.h"
#include "flight/interpreter/wpml_interpreter.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/package.h"
#include "missions/package/verification/stated_return.h"
#include "missions/package/verification/true_space.h"
#include "tests/flight/interpreter/random_spoiling.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions::cli {
namespace {

using flight::Problems;

/// Returns the number of corruptions of each file.
int corruptions() { return std::getenv("SKYCAP_PACKAGES") == nullptr ? 60 : 200; }

/// Returns the packages from the environment, or a new one in the folder.
std::vector<std::filesystem::path> packages(const tests::TestFolder& folder) {
  const char* const named = std::getenv("SKYCAP_PACKAGES");
  if (named == nullptr) {
    const auto run = tests::run_skycap({"plan", folder.write("m.yaml", tests::flight_mission()),
                                        "--no-report", "--out", folder / "out"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    // `plan` writes only the formats of the vehicle.
    const auto exported =
        tests::run_skycap({"export", folder / "out", "--format", "kmz", "--out", folder / "kmz"});
    EXPECT_EQ(exported.exit_code, 0) << exported.err;
    std::filesystem::copy_file(folder / "kmz/mission.kmz", folder / "out/mission.kmz");
    return {folder / "out"};
  }
  std::vector<std::filesystem::path> folders;
  std::stringstream list(named);
  for (std::string each; std::getline(list, each, ':');) folders.emplace_back(each);
  return folders;
}

/// Returns true if the message names an item, waypoint or part of the file.
bool names_location(const std::string& problem) {
  for (const char* where : {"item ", "waypoint ", "line ", "mission.", "geoFence", "template.kml",
                            "waylines.wpml", "doJumpId", "the mission ends in the air"}) {
    if (problem.find(where) != std::string::npos) return true;
  }
  return false;
}

/// Mission of a package, with the independent check of its files.
class Shipped {
 public:
  explicit Shipped(const std::filesystem::path& folder)
      : summary_(package::read_package_summary(folder, {})),
        model_(evaluation::placed_model(summary_.mission.scene(), "")),
        space_(package::true_space(flight(), model_, summary_.pad->z())),
        oracle_(model_) {}

  flight::Ground ground() const {
    const flight::Site& site = flight().site;
    return {site.origin.latitude_deg, site.origin.longitude_deg, site.origin.height,
            site.undulation_for("the test"), *summary_.pad};
  }

  flight::FlightFacts facts(flight::AutopilotType autopilot) const {
    flight::FlightFacts facts = flight().facts();
    facts.pad = *summary_.pad;
    facts.is_pad_known = true;
    facts.views = summary_.views;
    facts.vehicle = flight().vehicle_for(flight().required_vehicle(), autopilot);
    return facts;
  }

  flight::AutopilotType autopilot_for_file(const std::filesystem::path& file) const {
    return *package::autopilot_for_file(file, flight().required_vehicle());
  }

  /// Returns all problems that `check --route` reports, except those of returns.
  Problems find_problems(const flight::InterpretedRoute& route) const {
    Problems problems = route.problems;
    const double clearance = flight().clearance;
    const flight::RouteVerification verification =
        verify(route, space_.everywhere, space_.over_pad, clearance - flight::rounding_bound,
               clearance + 1.0);
    problems.insert(problems.end(), verification.problems.begin(), verification.problems.end());
    return problems;
  }

  bool keeps_clear(const std::vector<Eigen::Vector3d>& positions) const {
    const double clearance = flight().clearance - 3.0 * flight::rounding_bound;
    return flight::keeps_clear(oracle_, positions, clearance);
  }

 private:
  const flight::FlightOptions& flight() const { return summary_.mission.flight(); }

  package::PackageSummary summary_;
  geometry::Mesh model_;
  package::TrueSpace space_;
  flight::CgalOracle oracle_;
};

struct CorruptedMission {
  Problems problems;
  std::vector<Eigen::Vector3d> positions;  ///< positions of an independent flight
};

void expect_rejected_or_harmless(const Shipped& shipped, const std::filesystem::path& file,
                                 const std::function<CorruptedMission()>& corrupt) {
  int rejected = 0;
  for (int i = 0; i < corruptions(); ++i) {
    const CorruptedMission corrupted = corrupt();
    if (corrupted.problems.empty()) {
      EXPECT_TRUE(shipped.keeps_clear(corrupted.positions)) << file << ", spoiling " << i;
      continue;
    }
    ++rejected;
    for (const std::string& problem : corrupted.problems) {
      EXPECT_TRUE(names_location(problem)) << file << ", spoiling " << i << ": " << problem;
    }
  }
  std::cout << file.string() << ": " << rejected << " of " << corruptions() << " refused, "
            << corruptions() - rejected << " harmless\n";
  EXPECT_GT(rejected, corruptions() / 4);
}

void corrupt_items(const Shipped& shipped, const std::filesystem::path& path) {
  const std::string content = geometry::read_file(path);
  const flight::MavlinkMission good =
      path.extension() == ".plan" ? flight::read_plan(content) : flight::read_waypoints(content);
  const flight::FlightFacts facts = shipped.facts(shipped.autopilot_for_file(path));
  ASSERT_TRUE(shipped.find_problems(interpret(good, facts)).empty()) << path;
  const flight::Ground ground = shipped.ground();
  std::mt19937_64 random(11);
  expect_rejected_or_harmless(shipped, path, [&]() -> CorruptedMission {
    flight::MavlinkMission file = good;
    corrupt(file, random, ground.around(40, 40));
    return {shipped.find_problems(interpret(file, facts)), make_flight(file.items, ground)};
  });
}

void corrupt_wpml(const Shipped& shipped, const std::filesystem::path& path) {
  const flight::KmzContent good = flight::unpack_kmz(geometry::read_file(path));
  const flight::FlightFacts facts = shipped.facts(flight::AutopilotType::dji);
  ASSERT_TRUE(shipped.find_problems(interpret(good, facts)).empty()) << path;
  const flight::Ground ground = shipped.ground();
  std::mt19937_64 random(12);
  int number = 0;
  expect_rejected_or_harmless(shipped, path, [&]() -> CorruptedMission {
    flight::KmzContent kmz = good;
    std::string& text = number++ % 4 == 0 ? kmz.template_kml : kmz.waylines_wpml;
    text = flight::corrupted(text, random);
    Problems problems = flight::validate_kmz(flight::pack_kmz(kmz));
    if (problems.empty()) problems = shipped.find_problems(interpret(kmz, facts));
    return {problems, make_flight(kmz.waylines_wpml, ground)};
  });
}

TEST(ShippedFiles, AreRejectedOrHarmlessWhenCorrupted) {
  const tests::TestFolder made;
  const std::vector<std::filesystem::path> folders = packages(made);
  ASSERT_FALSE(folders.empty());
  for (const std::filesystem::path& folder : folders) {
    const Shipped shipped(folder);
    std::set<std::string> extensions;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::filesystem::path& path = entry.path();
      if (path.extension() == ".plan" || path.extension() == ".waypoints") {
        corrupt_items(shipped, path);
      } else if (path.extension() == ".kmz") {
        corrupt_wpml(shipped, path);
      } else {
        continue;
      }
      extensions.insert(path.extension().string());
    }
    const bool is_made = std::getenv("SKYCAP_PACKAGES") == nullptr;
    EXPECT_GE(extensions.size(), is_made ? 3U : 1U) << folder;
  }
}

}  // namespace
}  // namespace skycap::missions::cli
