/// The mission package: the files that a survey leaves behind. docs/reference/results.md is the
/// manual.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "flight/space/measured_space.h"
#include "geometry/io/output_folder.h"
#include "geometry/place/pose.h"
#include "missions/config/key_override.h"
#include "missions/config/mission_setup.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/coverage_map.h"
#include "missions/package/flight_files.h"
#include "missions/simulation/measurement.h"
#include "missions/simulation/survey_runner.h"
#include "survey/skycap/skycap_planner.h"

namespace skycap::missions::package {

/// Coverage of a finished survey: shares of samples. What was not measured is missing.
struct CoverageFigures {
  double all = 0.0;               ///< of the whole surface
  std::optional<double> visible;  ///< of what admissible views can see
  std::optional<double> ceiling;  ///< of the whole surface, attainable
  /// The surface as the simulator knows it, for the map and the holes of a survey whose planner
  /// believes nothing; see true_patches().
  std::vector<survey::skycap::BelievedPatch> patches = {};
  std::optional<TrueCoverage> truth = {};  ///< of a simulated survey
  /// What views cover when they are flown again; null where that cannot be simulated, or the survey
  /// was interrupted.
  std::function<simulation::CoveredAgain(const std::vector<session::ViewInFlight>&)> fly_again = {};
};

/// What a simulated survey covered of the true surface; what could be covered at all only of one
/// that has ended, unless a stop is requested. Keeps references to options and scene.
CoverageFigures coverage_figures(const evaluation::SimulationOptions& options,
                                 const session::SurveyRecord& record,
                                 const evaluation::SurveyScene& scene, unsigned threads,
                                 const std::stop_token& stop);

/// Commits what stage_package() and others have staged. A survey that was interrupted goes beside a
/// complete one instead of over it, into the folder "interrupted", and keeps its journal.
void commit_package(const session::SurveyRecord& record, geometry::OutputFolder& folder);

/// Stages summary.json, cloud.ply, views.csv and trajectory.tum in `folder`; the caller commits. A
/// flown survey's package also holds its route files and free_space.bin, which they were proven in
/// (flight::MeasuredSpace::write()); what they say is returned. Every number is written with as
/// many digits as it takes to read the same number back, so equal surveys give equal files; only
/// summary.json holds times. A stop that is requested leaves the cloud without normals and, while
/// the route is made, the survey without one, and its failure says so: `skycap export` makes it
/// later.
std::optional<SurveyMission> stage_package(const config::MissionSetup& setup,
                                           const session::SurveyRecord& record,
                                           const CoverageFigures& coverage, unsigned threads,
                                           geometry::OutputFolder& folder,
                                           std::stop_token stop = {});

/// The file of a package that says what the rest is.
inline constexpr const char* summary_name = "summary.json";

/// Where a flown survey's routes were proven.
inline constexpr const char* free_space_name = "free_space.bin";

/// The page that shows it; void when the mission is planned again.
inline constexpr const char* report_name = "report.html";

/// What `skycap fly-test` adds to it; void when the mission is planned again.
inline constexpr const char* fly_test_name = "fly_test.json";

/// What a package's summary says of its survey.
struct PackageSummary {
  config::MissionSetup mission;  ///< with all keys as they were in force
  std::vector<geometry::View> views;
  std::vector<Way> ways;                   ///< ways[i] was flown to view i; empty if it is not said
  std::optional<Eigen::Vector3d> pad;      ///< of a survey that was flown
  std::vector<flight::PadGround> grounds;  ///< of pad and rally points, where it was measured
  bool has_choice = false;  ///< whether views were to be chosen anew when it was planned
  std::optional<package::StationPlan> anew{};  ///< the mission's stations, if they were chosen so

  /// What is flown: those stations, or the survey's views.
  const std::vector<geometry::View>& stations() const { return anew ? anew->views : views; }
};

/// The same of a summary's text; `name` stands for the file in messages.
PackageSummary parse_package_summary(const std::string& text, const std::string& name,
                                     const std::vector<config::KeyOverride>& overrides = {});

/// Reads a package's summary; `overrides` take the place of the mission's keys. Throws
/// Error{bad_file} naming the file if it is missing or not as stage_package() wrote it.
PackageSummary read_package_summary(const std::filesystem::path& folder,
                                    const std::vector<config::KeyOverride>& overrides);

/// What a package holds of a flown survey.
struct PackagedSurvey {
  std::string name;  ///< of the mission
  /// By all keys as they were in force; in_given_order() of stations chosen anew.
  flight::FlightOptions flight;
  session::RunOptions run;
  std::vector<geometry::View> views;  ///< that are flown: PackageSummary::stations()
  std::vector<Way> ways;              ///< to them
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<flight::PadGround> grounds;  ///< see PackageSummary
  flight::MeasuredSpace measured;
};

/// Whether a JSON file of results is there and says "complete": true.
bool is_complete_result(const std::filesystem::path& json_file);

/// Reads the package of a flown survey, as read_package_summary() does.
PackagedSurvey read_package(const std::filesystem::path& folder,
                            const std::vector<config::KeyOverride>& overrides);

/// The views of a survey, in their order.
std::vector<geometry::View> views_of(const session::SurveyRecord& record);

/// The pieces of surface that are known: as the planner believes, or else as the simulator knows.
std::span<const survey::skycap::BelievedPatch> known_surface(const session::SurveyRecord& record,
                                                             const CoverageFigures& coverage);

/// views.csv: a line for each view.
std::string views_csv(const session::SurveyRecord& record);

/// trajectory.tum: "timestamp tx ty tz qx qy qz qw" of world_from_camera for each view, the
/// format of the TUM RGB-D benchmark. Nothing was flown, so a view's number is its timestamp.
std::string trajectory_tum(const session::SurveyRecord& record);

/// summary.json, as docs/reference/results.md describes it.
std::string summary_json(const config::MissionSetup& setup, const session::SurveyRecord& record,
                         const CoverageFigures& coverage,
                         const std::optional<SurveyMission>& flight = {});

/// Planning time of a whole survey by part, in the order of execution.
std::vector<survey::PartTime> planning_time_by_part(const session::SurveyRecord& record);

}  // namespace skycap::missions::package
