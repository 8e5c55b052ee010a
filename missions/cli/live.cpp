// Commands of live surveys: next, finish, serve and fly.
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/command_options.h"
#include "missions/cli/commands.h"
#include "missions/cli/live_scene.h"
#include "missions/cli/write_page.h"
#include "missions/config/mission_document.h"
#include "missions/config/resolve.h"
#include "missions/online/guided/fly_survey.h"
#include "missions/online/guided/network_port.h"
#include "missions/online/guided/sensors.h"
#include "missions/online/guided/simulated_autopilot.h"
#include "missions/online/live/answer.h"
#include "missions/online/live/live_status.h"
#include "missions/online/live/scan_input.h"
#include "missions/online/live/server.h"
#include "missions/online/recordings/recording.h"
#include "missions/package/flight_report.h"
#include "missions/package/package.h"
#include "missions/package/pilot_text.h"
#include "missions/report/survey_report.h"

namespace skycap::missions::cli {
namespace {

constexpr int exit_complete = 10, exit_nowhere_to_go = 11, exit_wrong_pose = 12;

int to_exit_code(const online::Proposal& proposal) {
  if (proposal.has_pose_warning()) return exit_wrong_pose;
  if (!proposal.end) return 0;
  return *proposal.end == survey::StopReason::nowhere_to_go ? exit_nowhere_to_go : exit_complete;
}

/// Reads a mission for a command of live surveys. Throws Error{bad_config} for photo missions.
template <typename Options>
config::MissionSetup read_live(const Options& options, const Console& console) {
  config::MissionSetup setup = read_shown(config::read_live_mission, options, console);
  if (setup.document->is_inspection()) {
    setup.document->reject("inspection.range",
                           "inspections are planned before the flight, not live; use skycap plan");
  }
  if (setup.document->is_photo()) {
    setup.document->reject("sensor.photo_camera",
                           "photos are planned before the flight, not live; use skycap plan");
  }
  return setup;
}

Eigen::Isometry3d make_pose(const NextOptions& options) {
  if (options.pose.empty() == !options.pose_file) {
    throw Error(ErrorKind::bad_usage,
                "--scan requires either --pose \"x y z qx qy qz qw\" or --pose-file FILE");
  }
  if (!options.pose_file) return online::parse_pose_text(options.pose, "--pose");
  constexpr std::size_t largest = 1 << 16;
  return online::parse_pose_text(geometry::read_file(*options.pose_file, largest),
                                 options.pose_file->string());
}

std::optional<online::PoseCovariance> read_covariance(const NextOptions& options) {
  if (!options.pose_sigma.empty() && !options.pose_covariance.empty()) {
    throw Error(ErrorKind::bad_usage,
                "--pose-sigma conflicts with --pose-covariance; remove one of them");
  }
  if (!options.pose_sigma.empty()) {
    return online::parse_pose_sigma(options.pose_sigma, "--pose-sigma");
  }
  if (options.pose_covariance.empty()) return std::nullopt;
  return online::parse_pose_covariance(options.pose_covariance, "--pose-covariance");
}

online::ScanInput make_scan_input(const NextOptions& options, const std::filesystem::path& file,
                                  const Eigen::Isometry3d& world_from_sensor) {
  online::ScanInput input{.file = file,
                          .world_from_sensor = world_from_sensor,
                          .is_in_world = options.is_in_world,
                          .intrinsics = {},
                          .depth_unit = options.depth_unit};
  if (!options.intrinsics.empty()) input.intrinsics = online::parse_intrinsics(options.intrinsics);
  return input;
}

/// Returns a description of the rejected parts of a scan.
std::string left_out_text(const online::ScanFound& found) {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(found.without_return, "no-return pixels");
  add(found.out_of_view, "points ignored (outside the camera's view)");
  add(found.hidden, "points ignored (hidden by other points in the same pixel)");
  add(found.left_out.flying, "flying pixels removed");
  add(found.left_out.isolated, "isolated returns removed");
  return text;
}

void add_scan(const NextOptions& options, const std::string& name, const online::ScanFound& found,
              const std::string& id, const flight::FlightOptions& flight,
              online::LiveSurvey& survey, const Console& console) {
  online::require_usable(found.scan, flight);
  const std::optional<online::PoseCovariance> covariance = read_covariance(options);
  const bool is_new = options.is_en_route ? survey.add_en_route(found.scan, id, covariance)
                                          : survey.add(found.scan, id, covariance);
  if (options.is_quiet) return;
  const bool is_aside = is_new && survey.proposal().has_pose_warning();
  console.err << fmt::format("{}: {} points{}{}{}\n", name, found.scan.points.size(),
                             is_new ? "" : "; already known, ignored",
                             is_aside ? "; rejected: pose inconsistent with the map" : "",
                             left_out_text(found))
              << std::flush;
}

/// Adds the frames of a recording that are not yet in the survey, in order.
void add_recording(const NextOptions& options, const flight::FlightOptions& flight,
                   const online::LiveOptions& live, online::LiveSurvey& survey,
                   const Console& console) {
  const online::RecordingChoice choice{
      .rawlog = {.sensor = options.sensor, .poses = options.poses},
      .count = options.until,
      .image = make_scan_input(options, {}, Eigen::Isometry3d::Identity())};
  ProgressLine progress(console, options.is_quiet);
  progress.show(options.dataset->string() + ": reading poses");
  const auto recording = online::open_recording(
      *options.dataset, choice, flight.capture, live,
      [&](const std::string& note) { warn(console, note); }, progress.progress_callback());
  progress.clear();
  if (const std::string source = recording->pose_source(); !source.empty() && !options.is_quiet) {
    console.err << options.dataset->string() << ": poses from " << source << "\n";
  }
  while (!console.stop.stop_requested()) {
    const std::optional<online::Frame> frame = recording->next();
    if (!frame) return;
    if (survey.scan_number(frame->id)) continue;
    add_scan(options, frame->name, frame->scan(), frame->id, flight, survey, console);
  }
}

/// Writes the HTML report of the current state, which browsers reload.
void show_survey(const LiveOptions& options, const config::MissionSetup& setup,
                 const online::LiveSurvey& survey, const Console& console) {
  if (!options.has_report || survey.views().empty()) return;
  const online::Proposal& proposal = survey.proposal();
  try {
    session::SurveyRecord so_far = survey.so_far();
    nlohmann::ordered_json summary = nlohmann::ordered_json::parse(
        package::summary_json(setup, so_far, {so_far.coverage(), {}, {}}));
    if (const auto predicted = survey.visibility().unseen_share())
      summary["unseen_box_surface"] = *predicted;
    geometry::write_file(
        options.survey / package::report_name,
        report::live_page(summary.dump(), setup.survey(), setup.scene(), std::move(so_far),
                          {proposal.view, proposal.path.points}));
  } catch (const Error& error) {  // report errors must not end a survey
    warn(console, "no report: " + std::string(error.what()));
  }
}

struct Finished {
  std::string text;  ///< message for the user
  bool has_route = true;
};

Finished write_package(const LiveOptions& options, const config::MissionSetup& setup,
                       online::LiveSurvey& survey, const Console& console) {
  geometry::OutputFolder folder(options.survey);
  const session::SurveyRecord record = survey.finish();
  const package::CoverageFigures unknown{record.coverage(), {}, {}};
  const std::optional<package::SurveyMission> flight =
      package::stage_package(setup, record, unknown, setup.run.threads, folder, console.stop);
  write_page(package::summary_name, options.has_report, folder, console);
  folder.commit();
  std::string text =
      fmt::format("{}: {} after {} scans, {} points\n", setup.name,
                  session::to_string(record.stop_reason), record.views.size(), record.cloud.size());
  if (const auto predicted = survey.visibility().unseen_share()) {
    text += fmt::format(
        "  region    {:.0f}% of the surface of planner.scene_box has not been observed\n",
        100.0 * *predicted);
  }
  if (flight) text += package::flight_text(*flight);
  text += "  results   " + options.survey.string() + "\n";
  if (flight) text += package::pilot_text(setup.flight(), *flight);
  return {text, !flight || flight->failure.empty()};
}

void add_live_options(CLI::App& command, LiveOptions& options, KeyOptions& keys) {
  command
      .add_option("mission", options.mission, "Mission file (docs/howto/use-your-own-sensor.md)")
      ->required();
  command.add_option("--survey", options.survey, "Folder of the survey")->required();
  command.add_flag("!--no-report", options.has_report, "Do not write the HTML report");
  command.add_option("--seed", keys.seed, "Random seed; overrides the mission file");
  command.add_option("--threads", keys.threads, "Number of threads (0: all processors)");
  add_set_option(command, keys);
}

void add_next(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("next", "Add a scan from a real sensor and print the next view");
  const auto options = std::make_shared<NextOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  add_live_options(*command, *options, *keys);
  command->add_option(
      "--scan", options->scan,
      "Point cloud (.ply, .pcd, .las, .laz, .e57, .xyz) or depth image (16-bit .png)");
  command->add_option(
      "--pose", options->pose,
      "Pose of the sensor's optical frame: \"x y z qx qy qz qw\" or a row-major matrix");
  command->add_option("--pose-file", options->pose_file, "File with the pose");
  command->add_option(
      "--pose-sigma", options->pose_sigma,
      "Standard deviations of the pose: \"metres degrees\" (default: live.pose_sigma "
      "and live.pose_sigma_deg)");
  command->add_option(
      "--pose-covariance", options->pose_covariance,
      "Covariance of the pose, instead of --pose-sigma: 36 numbers, row by row, of x y z rx ry rz "
      "in the mission frame [m, rad], or the 21 numbers of its upper triangle");
  command->add_option(
      "--intrinsics", options->intrinsics,
      "Camera intrinsics of a depth image: \"fx fy cx cy\" or \"fx fy cx cy k1 k2 p1 "
      "p2 k3\" (default: the mission's camera)");
  command
      ->add_option("--depth-unit", options->depth_unit,
                   "Depth of one step of a 16-bit image, in metres (default: 0.001)")
      ->check(number_between(1e-6, 1.0));
  command->add_flag("--world", options->is_in_world, "The cloud is already in the mission frame");
  command->add_flag("--en-route", options->is_en_route,
                    "The scan was taken en route to the proposed view");
  command->add_option("--id", options->id,
                      "Identifier of the scan. A scan with a known identifier is not added again");
  command->add_option(
      "--dataset", options->dataset,
      "Recording whose frames are added one by one: a TUM RGB-D folder (depth.txt, "
      "groundtruth.txt), a 7-Scenes folder (frame-NNNNNN.depth.png, .pose.txt), or an MRPT rawlog");
  command->add_option("--sensor", options->sensor,
                      "Sensor label, for a rawlog with several sensors");
  command->add_option("--poses", options->poses,
                      "TUM trajectory of the optical frame, instead of the rawlog's poses");
  command
      ->add_option("--max-frames", options->until,
                   "Maximum number of frames to read from the recording")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--refuse", options->rejection_reason,
                      "Reject the proposed view for this reason and request another view");
  command->add_flag("--json", options->is_json, "Print the result as JSON");
  command->add_flag("--quiet", options->is_quiet, "Print the result and errors only");
  run_with_keys(*command, options, keys, next, console, action);
}

void add_serve(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("serve", "Run a live-survey server on a Unix or TCP socket");
  const auto options = std::make_shared<ServeOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  add_live_options(*command, *options, *keys);
  command->add_option("--socket", options->socket,
                      "Path of a Unix socket, accessible only to the current user");
  command->add_option("--port", options->port, "TCP port on this machine; 0: any free port");
  command->add_flag("--quiet", options->is_quiet, "Print the address and errors only");
  run_with_keys(*command, options, keys, serve, console, action);
}

void add_finish(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand("finish", "End a live survey and write its mission files");
  const auto options = std::make_shared<LiveOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  add_live_options(*command, *options, *keys);
  run_with_keys(*command, options, keys, finish, console, action);
}

}  // namespace

int next(const NextOptions& options, const Console& console) {
  if (options.scan.has_value() + options.dataset.has_value() +
          options.rejection_reason.has_value() >
      1) {
    throw Error(ErrorKind::bad_usage,
                "--scan, --dataset and --refuse are mutually exclusive; use one");
  }
  if (options.is_en_route && !options.scan) {
    throw Error(ErrorKind::bad_usage, "--en-route requires --scan");
  }
  const config::MissionSetup setup = read_live(options, console);
  const auto survey = open_survey(setup, options.mission.parent_path(), options.survey);
  if (options.scan) {
    const online::ScanInput input = make_scan_input(options, *options.scan, make_pose(options));
    const online::ScanFound found = online::read_scan(input, setup.flight().capture, setup.live);
    add_scan(options, options.scan->string(), found, options.id, setup.flight(), *survey, console);
  }
  if (options.dataset) add_recording(options, setup.flight(), setup.live, *survey, console);
  if (options.rejection_reason) survey->reject(*options.rejection_reason);
  if (options.scan || options.dataset || options.rejection_reason)
    show_survey(options, setup, *survey, console);
  console.out << (options.is_json ? online::answer_json(*survey, setup.flight())
                                  : online::answer_text(*survey))
              << "\n"
              << std::flush;
  return to_exit_code(survey->proposal());
}

int finish(const LiveOptions& options, const Console& console) {
  const config::MissionSetup setup = read_live(options, console);
  const auto survey = open_survey(setup, options.mission.parent_path(), options.survey);
  if (survey->views().empty()) {
    throw Error(
        ErrorKind::bad_usage,
        options.survey.string() + ": contains no scans yet; add scans with skycap next --scan");
  }
  const Finished finished = write_package(options, setup, *survey, console);
  console.out << finished.text << std::flush;
  return finished.has_route ? 0 : 1;
}

int serve(const ServeOptions& options, const Console& console) {
  if (options.socket.has_value() == options.port.has_value()) {
    throw Error(ErrorKind::bad_usage, "serve requires either --socket PATH or --port NUMBER");
  }
  const config::MissionSetup setup = read_live(options, console);
  const auto survey = open_survey(setup, options.mission.parent_path(), options.survey);
  int exit_code = 1;
  const auto finish_survey = [&] {
    Finished finished = write_package(options, setup, *survey, console);
    exit_code = finished.has_route ? 0 : 1;
    return std::move(finished.text);
  };
  online::LiveStatus status(options.survey, setup.flight());
  const auto update = [&] {
    if (!survey->views().empty()) status.set_vehicle(survey->views().back().view, {});
    status.set_survey(*survey);
  };
  update();
  online::Session session(
      setup.name, setup.flight(), setup.live, *survey, finish_survey,
      [&] {
        update();
        show_survey(options, setup, *survey, console);
      },
      [&] { return status.is_held(); });
  const PendingResultsGuard results(console);
  online::Server server({.socket = options.socket.value_or(""), .port = options.port});
  console.out << server.address() << "\n" << std::flush;
  const auto note = [&](const std::string& text) {
    status.set_action(text);
    if (!options.is_quiet) console.err << printable_line(text) << "\n" << std::flush;
  };
  server.run(session, note, console.stop);
  return exit_code;
}

namespace {

/// Options of a survey flown with an autopilot.
struct FlyOptions : LiveOptions {
  std::string connect;               ///< "simulated", or an address for online::parse_address()
  std::string sensor = "simulated";  ///< "simulated", or the path of a folder that receives scans
  std::string on_failure = "hold";   ///< "hold" or "return"
  std::string intrinsics;            ///< camera intrinsics of depth images
  double depth_unit = 0.001;         ///< unit of depth values in images [m]
  bool is_quiet = false;
};

online::Sensor make_sensor(const FlyOptions& options,
                           const evaluation::SimulationOptions& simulation,
                           const online::LiveOptions& live, const session::RunOptions& run,
                           const Console& console) {
  if (options.sensor == "simulated") {
    return simulated_sensor(simulation, options.mission.parent_path(), run);
  }
  online::ScanInput input;
  input.depth_unit = options.depth_unit;
  if (!options.intrinsics.empty()) input.intrinsics = online::parse_intrinsics(options.intrinsics);
  return online::folder_sensor(simulation.survey.flight, live, options.sensor, std::move(input),
                               online::FlightOptions{}.sensing_limit, console.stop);
}

/// Flies a live survey. Returns exit code 0 if the survey is complete, the vehicle has landed and
/// the package has a route.
int fly_live(const FlyOptions& options, const Console& console) {
  const bool is_simulated = options.connect == "simulated";
  std::optional<online::NetworkAddress> address;
  if (!is_simulated) address = online::parse_address(options.connect);
  const config::MissionSetup setup = read_live(options, console);
  online::require_flyable(setup.flight());
  online::Sensor sensor = make_sensor(options, setup.simulation, setup.live, setup.run, console);
  const auto survey = open_survey(setup, options.mission.parent_path(), options.survey);
  std::unique_ptr<flight::mavlink::Port> port;
  if (is_simulated) {
    port = online::make_simulated_port(setup.flight(), survey->flight()->pad());
  } else {
    port = std::make_unique<online::NetworkPort>(*address);
    if (!address->is_loopback()) {
      warn(console, "MAVLink is not authenticated: anyone who can reach " + options.connect +
                        " can send commands to this vehicle");
    }
    if (!options.is_quiet) {
      console.err << printable_line(options.connect + ": waiting for an autopilot") << "\n"
                  << std::flush;
    }
  }
  const PendingResultsGuard results(console);
  online::FlightOptions flight;
  flight.returns_on_failure = options.on_failure == "return";
  online::LiveStatus status(options.survey, setup.flight());
  status.set_survey(*survey);
  flight.show = [&] {
    status.set_survey(*survey);
    show_survey(options, setup, *survey, console);
  };
  flight.observer.is_held = [&] {
    const bool is_held = status.is_held();
    // The period of a flight, so that simulated time is not faster than reality during a hold.
    if (is_held && is_simulated) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return is_held;
  };
  flight.observer.track = [&](const geometry::View& view, std::optional<double> battery) {
    status.set_vehicle(view, battery);
  };
  flight.note = [&](const std::string& text) {
    status.set_action(text);
    if (!options.is_quiet) console.err << printable_line(text) << "\n" << std::flush;
  };
  if (is_simulated) flight.launch = online::run_at_once;
  const online::FlightEnd end = online::fly_survey(
      setup.flight(), *survey, *port, std::move(sensor), std::move(flight), console.stop);
  if (end.failure) {
    console.err << "skycap: flight ended: " << printable_line(end.failure->what)
                << (end.has_landed ? "; landed at the take-off point" : "")
                << "; repeat the command to resume the survey in "
                << printable_line(options.survey.string()) << "\n"
                << std::flush;
    return 1;
  }
  const Finished finished = write_package(options, setup, *survey, console);
  console.out << finished.text << std::flush;
  return finished.has_route ? 0 : 1;
}

void add_fly(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("fly", "Fly a live survey on ArduCopter over MAVLink (experimental)");
  const auto options = std::make_shared<FlyOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  add_live_options(*command, *options, *keys);
  command
      ->add_option("--connect", options->connect,
                   "Autopilot: simulated (built in, for trials), udp:127.0.0.1:14550 to listen, "
                   "udpout:HOST:PORT or tcp:HOST:PORT to connect")
      ->required();
  command->add_option(
      "--sensor", options->sensor,
      "Scan source: simulated (default; the mission requires a scene), or a folder to "
      "which another program writes scans");
  command
      ->add_option("--on-failure", options->on_failure,
                   "Action on failure. hold (default): hold position until a pilot takes control. "
                   "return: return along the verified path where possible")
      ->check(CLI::IsMember({"hold", "return"}));
  command->add_option(
      "--intrinsics", options->intrinsics,
      "Camera intrinsics of depth images, in the format of skycap next --intrinsics");
  command
      ->add_option("--depth-unit", options->depth_unit,
                   "Depth of one step of 16-bit images, in metres (default: 0.001)")
      ->check(number_between(1e-6, 1.0));
  command->add_flag("--quiet", options->is_quiet, "Print results and errors only");
  run_with_keys(*command, options, keys, fly_live, console, action);
}

}  // namespace

void add_live(CLI::App& app, const Console& console, Action& action) {
  add_next(app, console, action);
  add_serve(app, console, action);
  add_finish(app, console, action);
  add_fly(app, console, action);
}

}  // namespace skycap::missions::cli
