/// Commands of the program. Each function returns the exit code: 0 success, 1 negative result.
/// Invalid input is reported by throwing Error.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "missions/batch/benchmark/uniform_comparison.h"
#include "missions/cli/console.h"
#include "missions/config/mission_reader.h"

namespace skycap::missions::cli {

/// Options for work in numbered items that a scheduler can run.
struct TaskOptions {
  std::optional<std::string> index;  ///< index of the task, see batch::task_index()
  std::size_t chunk = 0;             ///< items per task; zero: one item, or the scheduler's default
  bool collects = false;             ///< whether to collect completed items without running any
  std::optional<std::string> engine;  ///< scheduler that runs all tasks

  bool is_set() const { return index || engine || collects || chunk > 0; }
};

struct PlanOptions {
  std::filesystem::path mission;
  std::optional<std::filesystem::path> out;  ///< output folder; default: results/NAME
  std::vector<config::KeyOverride> overrides;
  std::size_t trials = 0;  ///< number of surveys; zero: a single survey with a mission package
  bool resumes = false;    ///< whether to resume an interrupted survey; trials are always resumed
  bool has_report = true;  ///< whether to write an HTML report
  bool is_quiet = false;
  bool is_verbose = false;
  std::optional<std::filesystem::path> control_points;  ///< CSV file, for photo missions
};

/// Simulates the survey of a mission and writes the mission package or the results of trials.
/// Returns exit code 1 if the survey was interrupted, no view is reachable from the first, or no
/// route exists.
int plan(const PlanOptions& options, const Console& console);

/// Options that identify a live survey.
struct LiveOptions {
  std::filesystem::path mission;
  std::filesystem::path survey;  ///< folder of the survey
  bool has_report = true;        ///< whether to write an HTML report
  std::vector<config::KeyOverride> overrides;
};

struct NextOptions : LiveOptions {
  std::optional<std::filesystem::path> scan;  ///< scan to add before planning the next view
  std::string pose;  ///< sensor pose of the scan; conflicts with `pose_file`
  std::optional<std::filesystem::path> pose_file;  ///< file with the sensor pose of the scan
  std::string pose_sigma;  ///< standard deviations of the pose; conflicts with `pose_covariance`
  std::string pose_covariance;  ///< covariance of the pose; default: from the mission
  std::string intrinsics;       ///< camera intrinsics of a depth image
  double depth_unit = 0.001;    ///< unit of depth values in an image [m]
  bool is_in_world = false;     ///< whether the cloud's points are in the world frame
  bool is_en_route = false;     ///< whether the scan was captured en route
  std::string id;               ///< identifier of the scan; default: its checksum
  std::optional<std::filesystem::path> dataset;  ///< recording to add instead of a scan
  std::string sensor;                            ///< sensor label in a rawlog
  /// Poses of a rawlog's sensor; default: those in the rawlog.
  std::optional<std::filesystem::path> poses;
  std::size_t until = 1'000'000;                ///< maximum number of frames from the recording
  std::optional<std::string> rejection_reason;  ///< reason for rejecting the proposed view
  bool is_json = false;
  bool is_quiet = false;
};

/// Prints the next view of a live survey. Exit codes: 0 next view; 10 survey complete; 11 all
/// useful views were rejected; 12 last scan rejected because its pose is wrong.
int next(const NextOptions& options, const Console& console);

/// Writes the mission package of a live survey into its folder. The survey may be continued
/// afterwards. Returns exit code 1 if the package has no route.
int finish(const LiveOptions& options, const Console& console);

struct ServeOptions : LiveOptions {
  std::optional<std::filesystem::path> socket;  ///< path of a Unix socket; conflicts with `port`
  std::optional<std::uint16_t> port;            ///< TCP port on 127.0.0.1
  bool is_quiet = false;
};

/// Serves a live survey on a socket until a client finishes it, and prints the address. Returns
/// exit code 1 if the survey is interrupted or has no route.
int serve(const ServeOptions& options, const Console& console);

struct BenchmarkOptions {
  std::vector<std::filesystem::path> missions;
  std::vector<std::string> planners = {"all"};  ///< names from methods(), or "all"
  /// Names from sim::model_families(), or "all". A model of each family replaces the missions'
  /// scene model; each trial's seed generates a different model. Empty: the missions' own models.
  std::vector<std::string> scenes;
  std::vector<std::filesystem::path> also;  ///< results of other programs (batch/other_results.h)
  /// Numbers of views of the fixed sets of uniform and random.
  std::vector<std::size_t> set_views{std::begin(batch::default_set_views),
                                     std::end(batch::default_set_views)};
  std::size_t trials = 10;                   ///< trials per planner and mission
  std::optional<std::filesystem::path> out;  ///< output folder; default: results/benchmark
  std::vector<config::KeyOverride> overrides;
  /// Number of surveys run concurrently, one thread each; zero: one per processor.
  unsigned threads = 0;
  bool has_report = true;  ///< whether to write an HTML report
  bool is_quiet = false;
};

/// Compares planners on missions as in the paper: surveys from identical starts, Tables 1 and 2,
/// and coverage curves. Completed surveys of an earlier run in the folder are reused. Returns exit
/// code 1 if interrupted.
int benchmark(const BenchmarkOptions& options, const Console& console);

struct CheckOptions {
  std::filesystem::path mission;
  std::optional<std::filesystem::path> route;
  std::optional<double> return_height;  ///< vehicle's return altitude above the take-off point [m]
  bool prints_setup = false;  ///< whether to print the resolved setup instead of checking the scene
  std::vector<config::KeyOverride> overrides;
};

/// Checks a mission file and its scene, and prints derived values. With a route, it verifies that
/// each leg and return keeps the clearance and the site's rules. The clearance is checked against
/// the scene and the ground. Returns exit code 1 and prints a list if one does not.
int check(const CheckOptions& options, const Console& console);

struct ExportOptions {
  std::filesystem::path package;             ///< package folder written by plan()
  std::vector<std::string> formats;          ///< names from flight::formats()
  std::optional<std::filesystem::path> out;  ///< output folder; default: the package
  /// Number of the lost fleet vehicle, from 1, whose waypoints are reassigned.
  std::optional<std::size_t> lost;
  std::optional<double> after;  ///< time of the loss in the fleet's timetable [s]
  /// Route or track from elsewhere; `package` may then be a mission file, too.
  std::optional<std::filesystem::path> route;
  std::optional<double> simplify;  ///< maximum deviation of the simplified route [m]
  bool repairs = false;            ///< whether legs that are not free go round obstacles
  std::string heights = "auto";    ///< auto, takeoff or absolute
  std::string captures = "file";   ///< file, all or none
  std::vector<config::KeyOverride> overrides;
};

/// Plans a flight through the views of a completed survey and writes it in other formats or for
/// another vehicle. Returns exit code 1 if no view is reachable.
int export_package(const ExportOptions& options, const Console& console);

/// Verifies a route from elsewhere against the scene, the prior data and the airspace of a mission
/// and writes it like a planned flight, with its profile. Prints the legs that are not verified and
/// returns exit code 1 without files if there are any and `repairs` is not set.
int export_route(const ExportOptions& options, const Console& console);

struct FlyTestCommandOptions {
  std::filesystem::path package;             ///< package folder written by plan()
  std::optional<std::filesystem::path> out;  ///< output folder; default: the package
  /// Mission file whose scene is used as ground truth for the clearance.
  std::optional<std::filesystem::path> truth;
  std::size_t flights = 100;
  /// Returns from random states; one more from each second of the flight.
  std::size_t returns = 1000;
  /// Maximum wind speed [m/s]; default: from the mission, at least 5 m/s.
  std::optional<double> wind_speed;
  std::optional<double> position_error;  ///< maximum position error [m]; default: from the mission
  std::optional<double> return_height;   ///< vehicle's return altitude above the take-off point [m]
  std::vector<config::KeyOverride> overrides;
  bool is_quiet = false;
};

/// Simulates repeated flights of every route file in a package, with wind and failsafes, and writes
/// fly_test.json. Returns exit code 1 if interrupted, if the battery is insufficient, or if a
/// flight comes closer to an obstacle than permitted. The permitted distance is the clearance minus
/// the error allowances included in it.
int fly_test(const FlyTestCommandOptions& options, const Console& console);

struct CalibrateOptions {
  std::filesystem::path log;  ///< ArduPilot .bin log or .csv file
  std::string vehicle;        ///< preset most similar to the vehicle flown
  /// output file; default: LOG.yaml, where LOG is the stem of the log
  std::optional<std::filesystem::path> out;
  std::optional<double> mass;        ///< mass in flight [kg]; default: from the preset
  std::optional<double> battery_wh;  ///< battery energy [Wh]; default: from the preset
  double air_density = 1.225;        ///< air density during the flight [kg/m^3]
};

/// Fits a vehicle's power and endurance to a flight log and writes a vehicle file.
int calibrate(const CalibrateOptions& options, const Console& console);

struct ScanCommandOptions {
  std::filesystem::path mission;
  std::optional<std::filesystem::path> route;  ///< route file; default: from the mission
  std::optional<std::filesystem::path> out;    ///< output folder; default: results/NAME/scan
  std::optional<std::string> sensor;           ///< sensor preset or file; default: from the mission
  /// Formats of a laser scanner's points. For depth cameras, only "rawlog" has an effect; it is
  /// written in addition to the PNG files.
  std::vector<std::string> formats = {"las"};
  bool with_truth = false;  ///< whether to record ground-truth points as well
  bool resumes = false;     ///< whether to resume an interrupted scan
  bool has_report = true;   ///< whether to write an HTML report
  std::size_t shards = 0;   ///< number of separately recorded pieces; zero: not divided
  TaskOptions task;         ///< scheduler options of the pieces
  std::vector<config::KeyOverride> overrides;
  bool is_quiet = false;
};

/// Simulates the flight along a route and records the sensor's measurements. Returns exit code 1 if
/// interrupted or if a piece is missing.
int scan(const ScanCommandOptions& options, const Console& console);

struct EvaluateOptions {
  std::filesystem::path cloud;      ///< point cloud to evaluate; conflicts with `mesh`
  std::filesystem::path mesh;       ///< mesh to evaluate, at points sampled on its surface
  std::filesystem::path flight;     ///< flight around a structure to evaluate, instead of a cloud
  std::string model;                ///< builtin:NAME, model:NAME, mesh file or mission file
  std::filesystem::path reference;  ///< earlier cloud of the same building, instead of `model`
  bool is_aligned = false;          ///< whether to align the cloud with the reference first
  double cylinder = 0.0;            ///< M3C2 cylinder diameter d [m]; zero: from the point spacing
  double normal_scale = 0.0;        ///< M3C2 normal scale D [m]; zero: twice the cylinder diameter
  double max_change = 0.0;  ///< greatest distance that is searched [m]; zero: five diameters
  double registration_error = 0.0;  ///< [m]
  std::optional<double> distance;   ///< coverage distance r_d [m]; default: from the mission file
  std::size_t samples = 100'000;
  std::size_t shards = 0;  ///< number of separately evaluated pieces of a cloud; zero: not divided
  std::optional<std::filesystem::path> out;  ///< output folder for the pieces and their results
  TaskOptions task;                          ///< scheduler options of the pieces
  unsigned threads = 0;                      ///< number of threads; zero: one per processor
  /// Output of the density of a cloud, computed from all points. Empty: not computed.
  std::optional<std::filesystem::path> density;
  double density_cell = 0.5;   ///< Cell size of the raster, and radius around surface points [m].
  double min_density = 100.0;  ///< Required density [points per m^2].
  bool is_json = false;
  bool is_quiet = false;
};

/// Prints the coverage and accuracy of a cloud or mesh with respect to a model, or of a flight with
/// respect to an inspection mission. Returns exit code 1 if a piece is missing, or if the flight
/// exceeds a limit or violates the clearance.
int evaluate(const EvaluateOptions& options, const Console& console);

struct ConvertOptions {
  std::filesystem::path in, out;
  std::array<double, 3> shift = {0.0, 0.0, 0.0};  ///< added to all coordinates
  std::optional<std::filesystem::path> crs;       ///< file with the reference system as WKT
  bool is_quiet = false;
};

/// Converts a point cloud to another format.
int convert_cloud(const ConvertOptions& options, const Console& console);

struct ReconstructOptions {
  std::filesystem::path cloud;
  /// Output file; default: CLOUD_mesh.ply in the cloud's folder.
  std::optional<std::filesystem::path> out;
  int depth = 0;
  double spacing = 0.0;
  double min_density = 0.2;
  unsigned threads = 0;
};

/// Reconstructs a mesh from a cloud (reconstruction.h) and writes it to a file.
int reconstruct_cloud(const ReconstructOptions& options, const Console& console);

struct ModelOptions {
  std::string name;  ///< builtin or downloadable model, or a mission file
  std::optional<std::filesystem::path> out;
  std::optional<std::filesystem::path> render;
  std::optional<std::string> detail;  ///< level of detail; default: scene.detail
};

/// Downloads a model if it is not installed, and writes or renders it.
int model(const ModelOptions& options, const Console& console);

struct ReportOptions {
  std::filesystem::path folder;  ///< folder of results
  /// output file, for a folder with a single report; default: in the folder
  std::optional<std::filesystem::path> out;
  std::size_t points = 0;  ///< maximum number of displayed points; zero: the report's default
};

/// Writes the HTML reports of a results folder, as the commands that produced the results do.
int report_results(const ReportOptions& options, const Console& console);

struct ViewOptions {
  std::filesystem::path what;                ///< results folder, cloud or mission file
  std::optional<std::filesystem::path> out;  ///< HTML file; default: in the folder of `what`
  /// Georeferenced image of the site, for missions and results.
  std::optional<std::filesystem::path> background;
  std::vector<config::KeyOverride> overrides;  ///< key overrides for a mission file
};

/// Writes HTML reports of a results folder, cloud or mission scene and opens them in the browser.
/// Prints their paths.
int view(const ViewOptions& options, const Console& console);

}  // namespace skycap::missions::cli
