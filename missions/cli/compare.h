/// Command compare: options, action and command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "missions/cli/command_options.h"
#include "missions/config/key_override.h"

namespace skycap::missions::cli {

struct CompareOptions {
  /// results folder written by plan(), or a mission file
  std::filesystem::path package;
  std::vector<std::filesystem::path> logs;    ///< flight logs in flight order
  std::vector<std::filesystem::path> routes;  ///< route files; default: those of the vehicle
  /// Mission file whose scene is used as ground truth.
  std::optional<std::filesystem::path> truth;
  std::optional<std::filesystem::path> cloud;  ///< measured cloud
  double max_deviation = 3.0;    ///< distance at which a leg or capture counts as flown [m]
  std::string heights = "auto";  ///< auto, takeoff or absolute
  std::optional<std::filesystem::path> out;  ///< output folder; default: compare in the package
  std::vector<config::KeyOverride> overrides;
  bool has_report = true;
  bool is_quiet = false;
};

/// Compares flight logs with the mission of a results folder. Writes compare.json, its HTML
/// report and the route files of a patch mission for the missed views. Returns exit code 1 if a leg
/// was not flown or a capture was missed.
int compare(const CompareOptions& options, const Console& console);

void add_compare(CLI::App& app, const Console& console, Action& action);

}  // namespace skycap::missions::cli
