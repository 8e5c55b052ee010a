/// Mission package: the result files of a survey (docs/reference/results.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "flight/clearance/measured_space.h"
#include "geometry/io/output_folder.h"
#include "geometry/pose/pose.h"
#include "missions/config/key_override.h"
#include "missions/config/mission_setup.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/coverage_map.h"
#include "missions/package/flight_files.h"
#include "missions/simulation/measurement.h"
#include "missions/simulation/survey_runner.h"
#include "survey/surfel/surfel_planner.h"

namespace skycap::missions::package {

/// Coverage of a finished survey as fractions of the surface samples. Empty members were not
/// measured.
struct CoverageFigures {
  double all = 0.0;                           ///< Fraction of the whole surface.
  std::optional<double> visible;              ///< Fraction of the visible surface.
  std::optional<double> attainable_coverage;  ///< Attainable fraction of the whole surface.
  /// Ground-truth surface for the map and the holes of a survey whose planner has no surface
  /// estimate; see true_patches().
  std::vector<survey::surfel::EstimatedPatch> patches = {};
  std::optional<TrueCoverage> truth = {};  ///< Only for simulated surveys.
  /// Computes the coverage of views in a simulated re-flight, see reflight_coverage(). Null if it
  /// cannot be simulated or if the survey was interrupted.
  std::function<simulation::CoveredAgain(const std::vector<session::ViewInFlight>&,
                                         const simulation::VisitScan&, const std::stop_token&)>
      fly_again = {};
};

/// Computes the coverage of a simulated survey. The visible and attainable fractions are left empty
/// if the survey was interrupted or a stop is requested. Keeps references to `options` and `scene`.
CoverageFigures coverage_figures(const evaluation::SimulationOptions& options,
                                 const session::SurveyRecord& record,
                                 const evaluation::SurveyScene& scene, unsigned threads,
                                 const std::stop_token& stop);

/// Commits all staged files. An interrupted survey does not overwrite a complete one: it is written
/// to the folder "interrupted" and keeps its journal.
void commit_package(const session::SurveyRecord& record, geometry::OutputFolder& folder);

/// Stages summary.json, cloud.ply, views.csv and trajectory.tum in `folder`; the caller commits.
/// For flown surveys, also stages the route files and the free space in which they were verified,
/// free_space.bin (flight::MeasuredSpace::write()). Returns the flight of such a survey.
///
/// Numbers are written with enough digits to restore their exact values, so that equal surveys give
/// equal files. Only summary.json contains times. After a stop request the cloud has no normals. If
/// the route is not complete by then, it is omitted and the flight's `failure` contains the reason.
/// `skycap export` can plan it later.
std::optional<SurveyMission> stage_package(const config::MissionSetup& setup,
                                           const session::SurveyRecord& record,
                                           const CoverageFigures& coverage, unsigned threads,
                                           geometry::OutputFolder& folder,
                                           std::stop_token stop = {});

/// File with the description of the package.
inline constexpr const char* summary_name = "summary.json";

/// File with the free space in which a flown survey's routes were verified.
inline constexpr const char* free_space_name = "free_space.bin";

/// HTML report; becomes invalid when the mission is planned again.
inline constexpr const char* report_name = "report.html";

/// Result of `skycap fly-test`; becomes invalid when the mission is planned again.
inline constexpr const char* fly_test_name = "fly_test.json";

/// Contents of a package's summary.
struct PackageSummary {
  config::MissionSetup mission;  ///< Mission with all effective keys.
  std::vector<geometry::View> views;
  std::vector<Polyline> paths;         ///< ways[i] is the flown path to view i; empty if unknown.
  std::optional<Eigen::Vector3d> pad;  ///< Pad of a flown survey.
  std::vector<flight::LandingSurface>
      landing_surfaces;     ///< Measured ground of the pad and rally points.
  bool has_choice = false;  ///< Replanning was enabled.
  std::optional<package::CapturePlan>
      replanned{};  ///< Replanned stations, if the mission uses them.

  /// Returns the views of the mission: the replanned stations or the survey's views.
  const std::vector<geometry::View>& capture_points() const {
    return replanned ? replanned->views : views;
  }
};

/// Parses the text of a package's summary. `name` is the file name in messages.
PackageSummary parse_package_summary(const std::string& text, const std::string& name,
                                     const std::vector<config::KeyOverride>& overrides = {});

/// Reads the summary of the package in `folder`. `overrides` replace keys of the mission. Throws
/// Error{bad_file} naming the file if it is missing or invalid.
PackageSummary read_package_summary(const std::filesystem::path& folder,
                                    const std::vector<config::KeyOverride>& overrides);

/// Package of a flown survey.
struct PackagedSurvey {
  std::string name;  ///< Name of the mission.
  /// Options from all effective keys. For replanned stations, those of with_fixed_order().
  flight::FlightOptions flight;
  session::RunOptions run;
  std::vector<geometry::View> views;  ///< Views of the mission, PackageSummary::capture_points().
  std::vector<Polyline> paths;        ///< Paths to the views.
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<flight::LandingSurface>
      landing_surfaces;  ///< Measured ground of the pad and rally points.
  flight::MeasuredSpace measured;
};

/// Returns true if the JSON file of results exists and contains "complete": true.
bool is_complete_result(const std::filesystem::path& json_file);

/// Reads the package of a flown survey. Throws like read_package_summary().
PackagedSurvey read_package(const std::filesystem::path& folder,
                            const std::vector<config::KeyOverride>& overrides);

/// Returns the views of a survey in order.
std::vector<geometry::View> collect_views(const session::SurveyRecord& record);

/// Returns the known surface patches: the planner's estimate if it exists, otherwise the ground
/// truth.
std::span<const survey::surfel::EstimatedPatch> known_surface(const session::SurveyRecord& record,
                                                              const CoverageFigures& coverage);

/// Returns the contents of views.csv, one line per view.
std::string views_csv(const session::SurveyRecord& record);

/// Returns the contents of trajectory.tum: "timestamp tx ty tz qx qy qz qw" of world_from_camera
/// for each view, in the format of the TUM RGB-D benchmark. The timestamp is the view's index,
/// because views have no capture times.
std::string trajectory_tum(const session::SurveyRecord& record);

/// Returns the contents of summary.json (docs/reference/results.md).
std::string summary_json(const config::MissionSetup& setup, const session::SurveyRecord& record,
                         const CoverageFigures& coverage,
                         const std::optional<SurveyMission>& flight = {});

/// Returns the total planning time by component, in order of execution.
std::vector<survey::PartTime> planning_time_by_part(const session::SurveyRecord& record);

}  // namespace skycap::missions::package
