// The verbs of live surveys: next and finish, one call at a time, serve, and fly.
#include <memory>
#include <string>
#include <utility>

#include <CLI/App.hpp>
#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/live_scene.h"
#include "missions/cli/verb_options.h"
#include "missions/cli/verbs.h"
#include "missions/cli/write_page.h"
#include "missions/config/resolve.h"
#include "missions/online/guided/fly_survey.h"
#include "missions/online/guided/network_port.h"
#include "missions/online/guided/sensors.h"
#include "missions/online/live/answer.h"
#include "missions/online/live/scan_input.h"
#include "missions/online/live/server.h"
#include "missions/online/recordings/recording.h"
#include "missions/package/flight_report.h"
#include "missions/package/package.h"
#include "missions/report/survey_report.h"

namespace skycap::missions::cli {
namespace {

constexpr int exit_complete = 10, exit_nowhere_to_go = 11, exit_wrong_pose = 12;

int exit_code_of(const online::Proposal& proposal) {
  if (proposal.warns_of_pose()) return exit_wrong_pose;
  if (!proposal.end) return 0;
  return *proposal.end == survey::StopReason::nowhere_to_go ? exit_nowhere_to_go : exit_complete;
}

Eigen::Isometry3d pose_of(const NextOptions& options) {
  if (options.pose.empty() == !options.pose_file) {
    throw Error(ErrorKind::bad_usage,
                "--scan needs either --pose \"x y z qx qy qz qw\" or --pose-file FILE");
  }
  if (!options.pose_file) return online::parse_pose_text(options.pose, "--pose");
  constexpr std::size_t largest = 1 << 16;
  return online::parse_pose_text(geometry::read_file(*options.pose_file, largest),
                                 options.pose_file->string());
}

std::optional<online::PoseCovariance> covariance_of(const NextOptions& options) {
  if (!options.pose_sigma.empty() && !options.pose_covariance.empty()) {
    throw Error(ErrorKind::bad_usage,
                "--pose-sigma and --pose-covariance do not go together; give one");
  }
  if (!options.pose_sigma.empty()) {
    return online::parse_pose_sigma(options.pose_sigma, "--pose-sigma");
  }
  if (options.pose_covariance.empty()) return std::nullopt;
  return online::parse_pose_covariance(options.pose_covariance, "--pose-covariance");
}

online::ScanInput input_of(const NextOptions& options, const std::filesystem::path& file,
                           const Eigen::Isometry3d& world_from_sensor) {
  online::ScanInput input{.file = file,
                          .world_from_sensor = world_from_sensor,
                          .is_in_world = options.is_in_world,
                          .lens = {},
                          .depth_unit = options.depth_unit};
  if (!options.lens.empty()) input.lens = online::parse_lens(options.lens);
  return input;
}

/// What of a scan was not taken in.
std::string left_out_text(const online::ScanFound& found) {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(found.without_return, "pixels without a return");
  add(found.out_of_view, "out of the camera's view left out");
  add(found.hidden, "behind others in their pixels left out");
  add(found.left_out.flying, "flying pixels left out");
  add(found.left_out.isolated, "isolated returns left out");
  return text;
}

void add_scan(const NextOptions& options, const std::string& name, const online::ScanFound& found,
              const std::string& id, const flight::FlightOptions& flight,
              online::LiveSurvey& survey, const Console& console) {
  online::require_usable(found.scan, flight);
  const std::optional<online::PoseCovariance> covariance = covariance_of(options);
  const bool is_new = options.is_on_way ? survey.add_on_way(found.scan, id, covariance)
                                        : survey.add(found.scan, id, covariance);
  if (options.is_quiet) return;
  const bool is_aside = is_new && survey.proposal().warns_of_pose();
  console.err << fmt::format("{}: {} points{}{}{}\n", name, found.scan.points.size(),
                             is_new ? "" : "; known already, ignored",
                             is_aside ? "; set aside, its pose is wrong" : "", left_out_text(found))
              << std::flush;
}

/// The frames of a recording that the survey does not have yet, one after another.
void add_recording(const NextOptions& options, const flight::FlightOptions& flight,
                   const online::LiveOptions& live, online::LiveSurvey& survey,
                   const Console& console) {
  const online::RecordingChoice choice{
      .rawlog = {.sensor = options.sensor, .poses = options.poses},
      .count = options.until,
      .image = input_of(options, {}, Eigen::Isometry3d::Identity())};
  ProgressLine progress(console, options.is_quiet);
  progress.show(options.dataset->string() + ": looking for poses");
  const auto recording = online::open_recording(
      *options.dataset, choice, flight.capture, live,
      [&](const std::string& note) { warn(console, note); }, progress.teller());
  progress.clear();
  if (const std::string source = recording->pose_source(); !source.empty() && !options.is_quiet) {
    console.err << options.dataset->string() << ": poses are from " << source << "\n";
  }
  while (!console.stop.stop_requested()) {
    const std::optional<online::Frame> frame = recording->next();
    if (!frame) return;
    if (survey.number_of(frame->id)) continue;
    add_scan(options, frame->name, frame->scan(), frame->id, flight, survey, console);
  }
}

/// Shows the survey so far in the folder's page, which a browser reads again.
void show_survey(const LiveOptions& options, const config::MissionSetup& setup,
                 const online::LiveSurvey& survey, const Console& console) {
  if (!options.has_report || survey.views().empty()) return;
  const online::Proposal& proposal = survey.proposal();
  try {
    session::SurveyRecord so_far = survey.so_far();
    const std::string summary = package::summary_json(setup, so_far, {so_far.coverage(), {}, {}});
    geometry::write_file(
        options.survey / package::report_name,
        report::live_page(summary, setup.survey(), setup.scene(), std::move(so_far),
                          {proposal.view, proposal.way.points}));
  } catch (const Error& error) {  // a page shall not cost a survey
    warn(console, "no report: " + std::string(error.what()));
  }
}

struct Finished {
  std::string text;  ///< for the user
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
                  session::name_of(record.stop_reason), record.views.size(), record.cloud.size());
  if (flight) text += package::flight_text(*flight);
  return {text + "  results   " + options.survey.string() + "\n",
          !flight || flight->failure.empty()};
}

void add_live_options(CLI::App& verb, LiveOptions& options, KeyOptions& keys) {
  verb.add_option("mission", options.mission, "Mission file (docs/howto/use-your-own-sensor.md)")
      ->required();
  verb.add_option("--survey", options.survey, "The survey's folder")->required();
  verb.add_flag("!--no-report", options.has_report, "Leave out the page");
  verb.add_option("--seed", keys.seed, "Seed, in place of the mission's");
  verb.add_option("--threads", keys.threads, "Threads, 0 for all processors");
  add_set_option(verb, keys);
}

void add_next(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb =
      app.add_subcommand("next", "Take in a scan of a real sensor and say where to measure next");
  const auto options = std::make_shared<NextOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  add_live_options(*verb, *options, *keys);
  verb->add_option("--scan", options->scan,
                   "Cloud (.ply, .pcd, .las, .laz, .e57, .xyz) or depth image (16-bit .png)");
  verb->add_option("--pose", options->pose,
                   "Of the sensor's optical frame: \"x y z qx qy qz qw\", or a matrix by rows");
  verb->add_option("--pose-file", options->pose_file, "A file that holds the pose");
  verb->add_option("--pose-sigma", options->pose_sigma,
                   "How far off the pose may be, one standard deviation: \"metres degrees\"; "
                   "default: live.pose_sigma and live.pose_sigma_deg");
  verb->add_option("--pose-covariance", options->pose_covariance,
                   "Of the pose, in its place: the 36 numbers of a covariance of x y z rx ry rz in "
                   "the mission's frame [m, rad] by rows, or the 21 of its upper triangle");
  verb->add_option("--lens", options->lens,
                   "Of a depth image: \"fx fy cx cy\" or \"fx fy cx cy k1 k2 p1 p2 k3\"; default: "
                   "the mission's camera");
  verb->add_option("--depth-unit", options->depth_unit,
                   "What a step of a depth image stands for [m]; default 0.001")
      ->check(number_between(1e-6, 1.0));
  verb->add_flag("--world", options->is_in_world, "The cloud is in the mission's frame already");
  verb->add_flag("--on-way", options->is_on_way,
                 "The scan is from the way to the view that was asked for, not from there");
  verb->add_option("--id", options->id, "Of the scan; one that is known is not taken in again");
  verb->add_option("--dataset", options->dataset,
                   "A recording, whose frames are taken in one by one: a folder of TUM RGB-D "
                   "(depth.txt, groundtruth.txt) or 7-Scenes (frame-NNNNNN.depth.png, .pose.txt), "
                   "or a rawlog of MRPT");
  verb->add_option("--sensor", options->sensor, "Of a rawlog with several: the one's label");
  verb->add_option("--poses", options->poses,
                   "Of a rawlog's sensor, in place of its own: a TUM trajectory of the optical "
                   "frame");
  verb->add_option("--until", options->until, "Only so many frames of the recording")
      ->check(CLI::Range(1, 1'000'000));
  verb->add_option("--refuse", options->refusal, "Another view in place of the last, and why");
  verb->add_flag("--json", options->is_json, "Print JSON");
  verb->add_flag("--quiet", options->is_quiet, "Print nothing but the answer and errors");
  run_with_keys(*verb, options, keys, next, console, action);
}

void add_serve(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "serve", "Serve a live survey on a socket (docs/reference/live-protocol.md)");
  const auto options = std::make_shared<ServeOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  add_live_options(*verb, *options, *keys);
  verb->add_option("--socket", options->socket, "A Unix socket, which only you may open");
  verb->add_option("--port", options->port, "Of this machine alone; 0 for any that is free");
  verb->add_flag("--quiet", options->is_quiet, "Print nothing but the address and errors");
  run_with_keys(*verb, options, keys, serve, console, action);
}

void add_finish(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand("finish", "Write the mission package of a live survey");
  const auto options = std::make_shared<LiveOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  add_live_options(*verb, *options, *keys);
  run_with_keys(*verb, options, keys, finish, console, action);
}

}  // namespace

int next(const NextOptions& options, const Console& console) {
  if (options.scan.has_value() + options.dataset.has_value() + options.refusal.has_value() > 1) {
    throw Error(ErrorKind::bad_usage,
                "--scan, --dataset and --refuse do not go together; give one");
  }
  if (options.is_on_way && !options.scan) {
    throw Error(ErrorKind::bad_usage, "--on-way goes with --scan; give the scan, or leave it out");
  }
  const config::MissionSetup setup = read_shown(config::read_live_mission, options, console);
  const auto survey = open_survey(setup, options.mission.parent_path(), options.survey);
  if (options.scan) {
    const online::ScanInput input = input_of(options, *options.scan, pose_of(options));
    const online::ScanFound found = online::read_scan(input, setup.flight().capture, setup.live);
    add_scan(options, options.scan->string(), found, options.id, setup.flight(), *survey, console);
  }
  if (options.dataset) add_recording(options, setup.flight(), setup.live, *survey, console);
  if (options.refusal) survey->refuse(*options.refusal);
  if (options.scan || options.dataset || options.refusal)
    show_survey(options, setup, *survey, console);
  console.out << (options.is_json ? online::answer_json(*survey, setup.flight())
                                  : online::answer_text(*survey))
              << "\n"
              << std::flush;
  return exit_code_of(survey->proposal());
}

int finish(const LiveOptions& options, const Console& console) {
  const config::MissionSetup setup = read_shown(config::read_live_mission, options, console);
  const auto survey = open_survey(setup, options.mission.parent_path(), options.survey);
  if (survey->views().empty()) {
    throw Error(ErrorKind::bad_usage,
                options.survey.string() + ": has no scan yet; add some with skycap next --scan");
  }
  const Finished finished = write_package(options, setup, *survey, console);
  console.out << finished.text << std::flush;
  return finished.has_route ? 0 : 1;
}

int serve(const ServeOptions& options, const Console& console) {
  if (options.socket.has_value() == options.port.has_value()) {
    throw Error(ErrorKind::bad_usage, "serve needs either --socket PATH or --port NUMBER");
  }
  const config::MissionSetup setup = read_shown(config::read_live_mission, options, console);
  const auto survey = open_survey(setup, options.mission.parent_path(), options.survey);
  int exit_code = 1;
  const auto finish_survey = [&] {
    Finished finished = write_package(options, setup, *survey, console);
    exit_code = finished.has_route ? 0 : 1;
    return std::move(finished.text);
  };
  online::Session session(setup.name, setup.flight(), setup.live, *survey, finish_survey,
                          [&] { show_survey(options, setup, *survey, console); });
  const HoldsResults results(console);
  online::Server server({.socket = options.socket.value_or(""), .port = options.port});
  console.out << server.address() << "\n" << std::flush;
  const auto note = [&](const std::string& text) {
    if (!options.is_quiet) console.err << printable_line(text) << "\n" << std::flush;
  };
  server.run(session, note, console.stop);
  return exit_code;
}

namespace {

/// A survey that is flown on an autopilot.
struct FlyOptions : LiveOptions {
  std::string connect;               ///< online::parse_address()
  std::string sensor = "simulated";  ///< or a folder that scans come to
  std::string on_failure = "hold";   ///< or return
  std::string lens;                  ///< of depth images
  double depth_unit = 0.001;         ///< of depth images [m]
  bool is_quiet = false;
};

online::Sensor sensor_of(const FlyOptions& options, const evaluation::SimulationOptions& simulation,
                         const online::LiveOptions& live, const session::RunOptions& run,
                         const Console& console) {
  if (options.sensor == "simulated") {
    return simulated_sensor(simulation, options.mission.parent_path(), run);
  }
  online::ScanInput input;
  input.depth_unit = options.depth_unit;
  if (!options.lens.empty()) input.lens = online::parse_lens(options.lens);
  return online::folder_sensor(simulation.survey.flight, live, options.sensor, std::move(input),
                               online::FlightOptions{}.sensing_limit, console.stop);
}

/// Exit code 0: the survey is over, the vehicle has landed, and the package has a route.
int fly_live(const FlyOptions& options, const Console& console) {
  const online::NetworkAddress address = online::parse_address(options.connect);
  const config::MissionSetup setup = read_shown(config::read_live_mission, options, console);
  online::require_flyable(setup.flight());
  online::Sensor sensor = sensor_of(options, setup.simulation, setup.live, setup.run, console);
  const auto survey = open_survey(setup, options.mission.parent_path(), options.survey);
  online::NetworkPort port(address);
  if (!address.is_of_this_machine()) {
    warn(console,
         "MAVLink has no lock: who can reach " + options.connect + " can take part in this flight");
  }
  const HoldsResults results(console);
  online::FlightOptions flight;
  flight.returns_on_failure = options.on_failure == "return";
  flight.show = [&] { show_survey(options, setup, *survey, console); };
  flight.note = [&](const std::string& text) {
    if (!options.is_quiet) console.err << printable_line(text) << "\n" << std::flush;
  };
  const online::FlightEnd end = online::fly_survey(setup.flight(), *survey, port, std::move(sensor),
                                                   std::move(flight), console.stop);
  if (end.trouble) {
    console.err << "skycap: the flight ended: " << printable_line(end.trouble->what)
                << (end.has_landed ? "; landed on the pad" : "") << "; the survey in "
                << printable_line(options.survey.string()) << " goes on when it is flown again\n"
                << std::flush;
    return 1;
  }
  const Finished finished = write_package(options, setup, *survey, console);
  console.out << finished.text << std::flush;
  return finished.has_route ? 0 : 1;
}

void add_fly(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand("fly",
                                      "Fly a live survey on an autopilot, one proven leg after "
                                      "another (docs/howto/fly-live-on-arducopter.md)");
  const auto options = std::make_shared<FlyOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  add_live_options(*verb, *options, *keys);
  verb->add_option("--connect", options->connect,
                   "Where the autopilot's MAVLink comes to, udp:127.0.0.1:14550, or where it waits "
                   "for us, udpout:HOST:PORT or tcp:HOST:PORT")
      ->required();
  verb->add_option("--sensor", options->sensor,
                   "simulated (default; the mission has a scene then), or a folder that another "
                   "program writes the scans to");
  verb->add_option("--on-failure", options->on_failure,
                   "hold (default) until a pilot takes control, or return by the proven way where "
                   "that can be flown")
      ->check(CLI::IsMember({"hold", "return"}));
  verb->add_option("--lens", options->lens, "Of depth images, as for next");
  verb->add_option("--depth-unit", options->depth_unit, "Of depth images [m]; default 0.001")
      ->check(number_between(1e-6, 1.0));
  verb->add_flag("--quiet", options->is_quiet, "Print nothing but results and errors");
  run_with_keys(*verb, options, keys, fly_live, console, action);
}

}  // namespace

void add_live(CLI::App& app, const Console& console, Action& action) {
  add_next(app, console, action);
  add_serve(app, console, action);
  add_finish(app, console, action);
  add_fly(app, console, action);
}

}  // namespace skycap::missions::cli
