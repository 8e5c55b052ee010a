/// Fixture: repeated scans during 1.5 s of flight around a cube of 2 m.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/missions/results_in.h"
#include "tests/missions/run_skycap.h"

namespace skycap::tests {

/// Returns all results of a scan, except the duration in scan.json and the HTML report.
inline std::map<std::string, std::string> scan_results_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> results = results_in(folder, {"scan.html"});
  auto summary = nlohmann::ordered_json::parse(results.at("scan.json"));
  EXPECT_GT(summary.at("simulation_s").get<double>(), 0.0);
  summary.erase("simulation_s");
  results["scan.json"] = summary.dump();
  return results;
}

/// Results are written to "part", and the expected results to "whole".
class CubeScan : public testing::Test {
 protected:
  CubeScan() {
    folder_.write("cube.obj",
                  "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\n"
                  "v -1 1 2\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    folder_.write("laser.yaml",
                  "name: Test laser\nkind: spinning\ncolumns_per_turn: 500\nrotation_rate_hz: 20\n"
                  "channels: {count: 16, lowest_deg: -20, highest_deg: 10}\n"
                  "range: {min: 0.1, max: 50}\nerrors: {sigma: 0.01}\n");
    folder_.write("camera.yaml",
                  "name: Test camera\nkind: camera\nwidth_px: 20\nheight_px: 10\n"
                  "horizontal_fov_deg: 10\nvertical_fov_deg: 5\n");
    folder_.write("views.csv",
                  "view,x,y,z,direction_x,direction_y,direction_z\n"
                  "0,5,0,1,-1,0,0\n1,4,0,1,-1,0,0\n2,3,0,1,-1,0,0\n3,3,.5,1,-1,0,0\n");
    folder_.write("m.yaml",
                  "scene: {model: cube.obj}\n"
                  "scan:\n"
                  "  sensor: laser.yaml\n"
                  "  orbit: {radius: 5, min_height: 1, circles: 1, speed: 20}\n"
                  "evaluation: {coverage_distance: 0.1}\n");
  }

  std::vector<std::string> scan(const std::string& out,
                                const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"scan", folder_ / "m.yaml", "--out", folder_ / out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// Expects equal results in both folders.
  void expect_same_results() const {
    const auto part = scan_results_in(folder_ / "part"), whole = scan_results_in(folder_ / "whole");
    for (const auto& [name, content] : whole) {
      EXPECT_TRUE(part.contains(name) && part.at(name) == content) << name;
    }
    EXPECT_EQ(part.size(), whole.size());
  }

  static std::vector<std::string> with(std::vector<std::string> options,
                                       const std::vector<std::string>& more) {
    options.insert(options.end(), more.begin(), more.end());
    return options;
  }

  TestFolder folder_;
  const std::vector<std::string> clouds_{"--format", "las,ply,pcd,xyz,rawlog", "--with-truth"};
};

}  // namespace skycap::tests
