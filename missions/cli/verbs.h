/// The verbs of the program. Each takes its options, writes to the console, and returns the exit
/// code: 0 done, 1 the answer is "no". Bad input is thrown as Error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "missions/cli/console.h"
#include "missions/config/mission_reader.h"

namespace skycap::missions::cli {

/// Of work in numbered items that engines for many jobs may run.
struct TaskOptions {
  std::optional<std::string> index;   ///< of one task, see batch::task_index()
  std::size_t chunk = 0;              ///< items of a task; zero: one, or as the engine likes it
  bool collects = false;              ///< works on none, and makes the results of what is complete
  std::optional<std::string> engine;  ///< that runs all tasks

  bool is_given() const { return index || engine || collects || chunk > 0; }
};

struct PlanOptions {
  std::filesystem::path mission;
  std::optional<std::filesystem::path> out;  ///< default: results/NAME
  std::vector<config::KeyOverride> overrides;
  std::size_t trials = 0;  ///< zero: one survey, with a mission package
  bool resumes = false;  ///< goes on with an interrupted survey, if there is one; trials always do
  bool has_report = true;  ///< the page beside the other results, too
  bool is_quiet = false;
  bool is_verbose = false;
};

/// Surveys a mission's scene in simulation and writes the mission package, or the trials' files.
/// Exit code 1 if the survey was interrupted, could not go anywhere from its first view, or leaves
/// no route.
int plan(const PlanOptions& options, const Console& console);

/// Of which live survey.
struct LiveOptions {
  std::filesystem::path mission;
  std::filesystem::path survey;  ///< its folder
  bool has_report = true;        ///< the page, too
  std::vector<config::KeyOverride> overrides;
};

struct NextOptions : LiveOptions {
  std::optional<std::filesystem::path> scan;       ///< to be taken in first
  std::string pose;                                ///< of the scan's sensor; either this
  std::optional<std::filesystem::path> pose_file;  ///< or this
  std::string pose_sigma;                          ///< of the pose; either this
  std::string pose_covariance;                     ///< or this; default: the mission's
  std::string lens;                                ///< of a depth image
  double depth_unit = 0.001;                       ///< of a depth image [m]
  bool is_in_world = false;                        ///< the points of a cloud
  bool is_on_way = false;                          ///< the scan is, to the view
  std::string id;                                  ///< of the scan; default: its digest
  std::optional<std::filesystem::path> dataset;    ///< a recording to be taken in, in its place
  std::string sensor;                              ///< label in a rawlog
  std::optional<std::filesystem::path> poses;      ///< of a rawlog's sensor; default: its own
  std::size_t until = 1'000'000;                   ///< so many of its frames
  std::optional<std::string> refusal;              ///< why the proposed view is not wanted
  bool is_json = false;
  bool is_quiet = false;
};

/// Says where a live survey is to measure next. Exit code 0: there; 10: nowhere, it is over; 11:
/// every view that is wanted was refused; 12: the last scan was set aside, its pose is wrong.
int next(const NextOptions& options, const Console& console);

/// Writes the mission package of a live survey into its folder; exit code 1 if it has no route. The
/// survey may go on afterwards.
int finish(const LiveOptions& options, const Console& console);

struct ServeOptions : LiveOptions {
  std::optional<std::filesystem::path> socket;  ///< a Unix socket; either this
  std::optional<std::uint16_t> port;            ///< or this, of 127.0.0.1
  bool is_quiet = false;
};

/// Serves a live survey on a socket until a client finishes it; prints the address. Exit code 1 if
/// it was interrupted before, or has no route.
int serve(const ServeOptions& options, const Console& console);

struct BenchmarkOptions {
  std::vector<std::filesystem::path> missions;
  std::vector<std::string> planners = {"all"};  ///< of contestants(), or "all"
  /// Of sim::model_families(), or "all": each in the missions' scenes' place, a new one drawn with
  /// each trial's seed. None: the missions' own.
  std::vector<std::string> scenes;
  std::size_t trials = 10;                   ///< of each planner on each mission
  std::optional<std::filesystem::path> out;  ///< default: results/benchmark
  std::vector<config::KeyOverride> overrides;
  unsigned threads = 0;    ///< zero: all processors; a survey has one
  bool has_report = true;  ///< the page beside the other results, too
  bool is_quiet = false;
};

/// Compares planners on missions, as the paper does: surveys from the same starts, Tables 1 and 2,
/// curves. What an earlier run in the same folder has finished is not run again. Exit code 1
/// if it was interrupted.
int benchmark(const BenchmarkOptions& options, const Console& console);

struct CheckOptions {
  std::filesystem::path mission;
  std::optional<std::filesystem::path> route;
  std::optional<double> return_height;  ///< that the vehicle is set to, above take-off
  bool prints_setup = false;            ///< the resolved setup instead of checking the scene
  std::vector<config::KeyOverride> overrides;
};

/// Checks a mission file and its scene; says what follows from it. With a route: proves that each
/// of its legs, and each return from it, keeps the mission's clearance from the scene, the ground
/// and the site's rules; exit code 1, with a list, if one does not.
int check(const CheckOptions& options, const Console& console);

struct ExportOptions {
  std::filesystem::path package;             ///< folder that plan() wrote
  std::vector<std::string> formats;          ///< flight::formats() by name
  std::optional<std::filesystem::path> out;  ///< folder; default: the package
  std::optional<std::size_t> lost;  ///< vehicle of the fleet whose stations the rest share, from 1
  std::optional<double> after;      ///< when it was lost, by the timetable [s]
  std::vector<config::KeyOverride> overrides;
};

/// Plans a flight through the views of a finished survey and writes it in other formats, or for
/// another vehicle. Exit code 1 if no view can be visited.
int export_package(const ExportOptions& options, const Console& console);

struct FlyTestVerbOptions {
  std::filesystem::path package;               ///< folder that plan() wrote
  std::optional<std::filesystem::path> out;    ///< folder; default: the package
  std::optional<std::filesystem::path> truth;  ///< mission file whose scene is judged against, too
  std::size_t flights = 100;
  std::size_t returns = 1000;            ///< from anywhere; one more from each second of the flight
  std::optional<double> wind_speed;      ///< the strongest; default: the mission's, at least 5 m/s
  std::optional<double> position_error;  ///< the greatest; default: the mission's
  std::optional<double> return_height;   ///< that the vehicle is set to, above take-off
  std::vector<config::KeyOverride> overrides;
  bool is_quiet = false;
};

/// Flies every route file of a package many times in the simulator, in wind and with failsafes.
/// Writes fly_test.json. Exit code 1 if a flight came nearer to anything than the clearance less
/// the errors that it allows for, if its battery would not have lasted, or if it was interrupted.
int fly_test(const FlyTestVerbOptions& options, const Console& console);

struct CalibrateOptions {
  std::filesystem::path log;                 ///< ArduPilot's .bin, or .csv
  std::string vehicle;                       ///< preset that the one that flew is like
  std::optional<std::filesystem::path> out;  ///< default: LOG.yaml, without the log's own ending
  std::optional<double> mass;                ///< flown, in place of the preset's [kg]
  std::optional<double> battery_wh;          ///< in place of the preset's
  double air_density = 1.225;                ///< of that day [kg/m^3]
};

/// Fits a vehicle's power and minutes to a log of its flight and writes it as a vehicle file.
int calibrate(const CalibrateOptions& options, const Console& console);

struct ScanVerbOptions {
  std::filesystem::path mission;
  std::optional<std::filesystem::path> route;  ///< in place of the mission's
  std::optional<std::filesystem::path> out;    ///< default: results/NAME/scan
  std::optional<std::string> sensor;           ///< in place of the mission's
  /// Of a laser scanner's points; of a camera's images only "rawlog" counts, beside the PNG files.
  std::vector<std::string> formats = {"las"};
  bool with_truth = false;  ///< also where the surfaces really were
  bool resumes = false;     ///< goes on with an interrupted scan, if there is one
  bool has_report = true;   ///< the page beside the other results, too
  std::size_t pieces = 0;   ///< of the flight, each measured by itself; zero: all at once
  TaskOptions task;         ///< whose items are pieces
  std::vector<config::KeyOverride> overrides;
  bool is_quiet = false;
};

/// Flies a route in the simulator and records what the sensor measures on the way. Exit code 1 if
/// the flight was interrupted, or if a piece of it is missing.
int scan(const ScanVerbOptions& options, const Console& console);

struct EvaluateOptions {
  std::filesystem::path cloud;     ///< either this
  std::filesystem::path mesh;      ///< or this: a surface, by points spread over it
  std::string model;               ///< builtin:NAME, model:NAME, a mesh, or a mission file
  std::optional<double> distance;  ///< r_d; a mission file says its own
  std::size_t samples = 100'000;
  std::size_t pieces = 0;                    ///< of a cloud, each judged by itself; zero: all
  std::optional<std::filesystem::path> out;  ///< where pieces and what is made of them go
  TaskOptions task;                          ///< whose items are pieces
  unsigned threads = 0;                      ///< zero: all processors
  bool is_json = false;
  bool is_quiet = false;
};

/// Says how much of a model a cloud or a mesh covers, and how accurate it is. Exit code 1 if a
/// piece is missing.
int evaluate(const EvaluateOptions& options, const Console& console);

struct ReconstructOptions {
  std::filesystem::path cloud;
  std::optional<std::filesystem::path> out;  ///< default: CLOUD_mesh.ply beside the cloud
  int depth = 0;
  double spacing = 0.0;
  double least_density = 0.2;
  unsigned threads = 0;
};

/// Writes the surface of a cloud as a mesh (reconstruction.h).
int reconstruct_cloud(const ReconstructOptions& options, const Console& console);

struct ModelOptions {
  std::string name;  ///< of a builtin or obtainable model, or a mission file
  std::optional<std::filesystem::path> out;
  std::optional<std::filesystem::path> render;
  std::optional<std::string> detail;  ///< in place of scene.detail
};

/// Obtains a model if it is not on the machine, and writes or renders it.
int model(const ModelOptions& options, const Console& console);

struct ReportOptions {
  std::filesystem::path folder;              ///< of results
  std::optional<std::filesystem::path> out;  ///< of a folder with one page; default: in the folder
  std::size_t points = 0;                    ///< shown at most; zero: the report's default
};

/// Writes the pages that show a folder of results, as the verbs that left them do.
int report_results(const ReportOptions& options, const Console& console);

struct ViewOptions {
  std::filesystem::path what;                  ///< folder of results, cloud, or mission file
  std::optional<std::filesystem::path> out;    ///< the page; default: beside what is shown
  std::vector<config::KeyOverride> overrides;  ///< of a mission
};

/// Writes the pages of a folder, a cloud or a mission's scene and opens them in the browser; says
/// where they are.
int view(const ViewOptions& options, const Console& console);

}  // namespace skycap::missions::cli
