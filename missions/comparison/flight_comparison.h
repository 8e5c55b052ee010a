/// Comparison of flight logs with the mission in a results folder: legs, captures, clearance,
/// coverage of the flown captures, and a patch mission for the missed views. Without a plan, only
/// clearance and coverage.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/flown/flown_track.h"
#include "flight/flown/route_comparison.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/output_folder.h"
#include "missions/config/key_override.h"
#include "missions/config/mission_setup.h"
#include "missions/package/flight_files.h"
#include "missions/package/holes.h"
#include "missions/session/view_in_flight.h"
#include "survey/photo/photo_planner.h"

namespace skycap::missions::comparison {

struct CompareRequest {
  std::filesystem::path folder;             ///< Results folder of `skycap plan`, or a mission file.
  std::vector<std::filesystem::path> logs;  ///< In flight order.
  /// Route files that were flown, in flight order. Empty: the files of the mission's vehicle.
  std::vector<std::filesystem::path> routes;
  /// Mission file whose scene is used as ground truth. Empty: the scene of the mission.
  std::optional<std::filesystem::path> truth;
  /// Measured cloud in the mission's frame. Empty: that of the results folder.
  std::optional<std::filesystem::path> cloud;
  flight::ComparisonOptions comparison;
  flight::TrackHeights heights = flight::TrackHeights::automatic;
  std::vector<config::KeyOverride> overrides;
};

/// Minimum distance of a track from a surface.
struct SurfaceDistance {
  double distance = 0.0;                               ///< [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Position of the vehicle.
  double time = 0.0;                                   ///< Time since take-off [s].
};

/// Coverage of the scene by captures, each simulated with an empty cloud and the same noise.
struct ComparedCoverage {
  /// All planned captures, at their planned poses. Empty without a plan.
  std::optional<package::ReflightCoverage> planned;
  package::ReflightCoverage flown;  ///< The captures that were made, at their flown poses.
  /// Flown captures and those of the patch mission. Empty without a patch mission.
  std::optional<package::ReflightCoverage> patched;
  package::MissingSurface missing;  ///< Surface that the flown captures do not cover.
  geometry::AttributedCloud map;    ///< Coverage map of the flown captures.
};

/// Expected photogrammetric reconstruction by photos, for missions with a photo camera.
struct ComparedPhotos {
  std::optional<survey::photo::PhotoFigures> planned;  ///< Empty without a plan.
  survey::photo::PhotoFigures flown;  ///< Photos that were taken, at their flown poses.
  /// Flown photos and those of the patch mission. Empty without a patch mission.
  std::optional<survey::photo::PhotoFigures> patched;
};

struct FlightComparison {
  std::string name;                ///< Name of the mission.
  bool has_plan = true;            ///< False if the mission was not planned by Skycap.
  std::vector<std::string> files;  ///< Route files.
  double clearance = 0.0;          ///< Required clearance [m].
  flight::PlannedFlight plan;
  flight::FlownTrack track;
  flight::RouteComparison route;
  /// One per planned capture: it was not made, or the camera looked elsewhere by more than half of
  /// its smaller field of view.
  std::vector<bool> is_missed;
  std::vector<std::size_t> missed_views;          ///< Indices of the mission's views, ascending.
  std::optional<SurfaceDistance> cloud_distance;  ///< Empty without a measured cloud.
  std::optional<SurfaceDistance> model_distance;  ///< Empty unless the scene was simulated.
  /// Distance of each state of the track from the cloud, otherwise from the model [m]. NaN next to
  /// the take-off point. Empty without a surface.
  std::vector<double> distances;
  /// Evenly distributed points of the measured cloud.
  std::vector<Eigen::Vector3f> cloud;
  config::MissionSetup mission;
  std::optional<Eigen::Vector3d> pad;           ///< Take-off point.
  std::optional<ComparedCoverage> coverage;     ///< Empty without a scene.
  std::optional<ComparedPhotos> photos;         ///< Empty without a photo camera.
  std::string no_coverage;                      ///< Reason why the coverage was not computed.
  std::optional<package::SurveyMission> patch;  ///< Empty if no view was missed.

  std::size_t num_flown_legs() const;
  std::size_t num_missed_captures() const;
};

/// Name of the file with the results.
inline constexpr const char* comparison_name = "compare.json";
/// Name of the file with the coverage map of the flown captures, or with a part of the measured
/// cloud if the coverage was not computed.
inline constexpr const char* surface_name = "surface.ply";
/// Prefix of the files of the patch mission.
inline constexpr const char* patch_stem = "patch";

/// Compares logs with a mission and stages the patch mission in `folder`. `report` receives the
/// current step. Throws Error{bad_file} for unreadable logs and results, and the errors of
/// package::read_package() and place_track().
FlightComparison compare_flight(const CompareRequest& request, geometry::OutputFolder& folder,
                                const std::function<void(const std::string&)>& report,
                                const std::stop_token& stop);

/// Stages compare.json and surface.ply (docs/reference/results.md).
void stage_comparison(const FlightComparison& comparison, const CompareRequest& request,
                      geometry::OutputFolder& folder);

/// Returns the lines that the program prints.
std::string comparison_text(const FlightComparison& comparison);

}  // namespace skycap::missions::comparison
