#include "missions/online/live/live_survey.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/record_log.h"
#include "geometry/parallel.h"
#include "geometry/points/usable_scan.h"
#include "missions/online/live/kept_scan.h"
#include "missions/online/live/live_journal.h"
#include "missions/online/live/live_status.h"
#include "missions/session/constrained_planner.h"
#include "missions/support/journal_text.h"

namespace skycap::missions::online {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* scans_name = "scans";

/// Returns whether the first record of a journal is from a version with the same format.
bool has_current_format(const std::string& identity) {
  const auto json = nlohmann::json::parse(identity, nullptr, false);
  return json.is_object() && json.contains("format") && json["format"] == support::journal_format;
}

fs::path made_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder / scans_name, failure);
  if (!failure) return folder;
  throw Error(ErrorKind::bad_file, folder.string() + ": cannot create the folder (" +
                                       failure.message() + "); use a folder that you can write to");
}

/// Computes the id of a scan. `sha256` is the checksum of the stored scan.
std::string make_id(const std::string& sha256, const Eigen::Isometry3d& world_from_sensor,
                    const std::optional<PoseCovariance>& covariance) {
  std::string text = sha256 + pose_json(world_from_sensor).dump();
  if (covariance) text += nlohmann::ordered_json(covariance->triangle()).dump();
  return compute_checksum(text);
}

bool is_same(const ProposalRecord& a, const ProposalRecord& b) {
  return to_journal_line(a) == to_journal_line(b);
}

}  // namespace

struct LiveSurvey::Impl {
  Impl(const session::SurveyOptions& survey_options, const LiveOptions& live_options,
       const support::Identity& identity, const fs::path& source, const LiveStart& begin,
       unsigned threads)
      : options(survey_options),
        live(live_options),
        folder(made_folder(source)),
        first_view(begin.view),
        run{.seed = identity.seed, .threads = threads, .sphere = begin.sphere},
        log(folder / live_journal_name) {
    const std::string text = support::identity_text(
        identity, {{"format", support::journal_format}, {"surface", "live"}});
    // Without a scan there is nothing to resume, and the mission may have been corrected.
    if (log.records().size() == 1 && log.records().front() != text &&
        has_current_format(log.records().front())) {
      log.clear();
    }
    if (log.records().empty()) {
      log.append(text);
    } else {
      support::require_same_survey(log.file().string(), log.records().front(), text,
                                   "use another folder");
    }
    events = parse_events(log.records(), log.file().string());
    replay();
  }

  void begin() {
    if (live.checks_poses || live.registers) {
      poses.emplace(options.planner.resolution_radius, live.registers);
    }
    remembered = 0;
    numbers.clear();
    recorded_scans.clear();
    set_aside = 0;
    visibility.emplace(options.planner.scene_box, options.planner.camera);
    guide = std::make_unique<session::ConstrainedPlanner>(options, first_view, run);
    survey::SurveyCallbacks callbacks = guide->callbacks();
    if (callbacks.can_reach) {
      callbacks.can_reach = [this, can_reach = std::move(callbacks.can_reach)](
                                const Vector3d&, const geometry::View& to) {
        return can_reach(departure, to);
      };
      callbacks.can_reach = reach.remembering(std::move(callbacks.can_reach), guide->flight());
    }
    steps = std::make_unique<survey::SurveyStepper>(guide->planner(), guide->limits(), callbacks);
    proposal = {.number = 0, .view = first_view, .path = {}, .end = {}, .pose = {}};
    if (guide->flight() != nullptr) proposal.path = guide->flight()->path();
  }

  ScanNumber next_number(bool is_en_route) const {
    if (!is_en_route) return {steps->views().size()};
    return {steps->views().size(), steps->passed()};
  }

  /// Returns the start of the path after a scan. This is the proposed view if the sensor is within
  /// the position and tracking errors that the clearance includes, otherwise the sensor's position.
  Vector3d departure_after(const geometry::Scan& scan) const {
    const Vector3d source = scan.sensor_position();
    const double errors = options.flight.position_error + options.flight.tracking_error;
    const bool is_there = proposal.view && (proposal.view->position - source).norm() <= errors;
    return is_there ? proposal.view->position : source;
  }

  void replay() {
    begin();
    for (LiveEvent& event : events) {
      if (event.is_rejected) continue;
      const std::optional<ProposalRecord> known = event.proposal;
      if (!happen(event, event.scan ? kept(*event.scan) : geometry::Scan{})) {
        catch_up();
        continue;
      }
      if (event.is_en_route()) continue;
      if (!known) {  // The program was killed before the proposal was recorded.
        write_down(to_journal_line(*event.proposal));
      } else if (!is_same(*known, *event.proposal)) {
        throw Error(
            ErrorKind::bad_file,
            log.file().string() + ": proposal " + std::to_string(proposal.number) +
                " differs from the recorded one; use the program version that started the survey");
      }
    }
  }

  geometry::Scan kept(const ScanRecord& record) const {
    geometry::Scan scan = read_kept_scan(folder / record.file, record.sha256);
    scan.world_from_sensor = record.world_from_sensor;
    try {
      geometry::require_usable(scan, options.flight.capture.camera);
    } catch (const Error& failure) {
      throw Error(ErrorKind::bad_file,
                  (folder / record.file).string() + ": cannot be used: " + failure.what());
    }
    return as_used(std::move(scan), record);
  }

  static geometry::Scan as_used(geometry::Scan scan, const ScanRecord& record) {
    if (!record.pose || !record.pose->correction) return scan;
    return corrected(std::move(scan), *record.pose->correction);
  }

  std::optional<PoseFinding> check_pose(const geometry::Scan& scan,
                                        const std::optional<PoseCovariance>& covariance) {
    if (!poses) return std::nullopt;
    PoseFinding finding = poses->find(
        scan, covariance.value_or(PoseCovariance::of(live.pose_sigma, live.pose_sigma_angle)));
    if (!live.checks_poses) finding.is_wrong = false;
    return finding;
  }

  /// Rejects a scan. The proposed view remains, but the sensor position is unknown.
  void leave_aside(LiveEvent& event) {
    numbers.emplace(event.scan->id, next_number(event.is_en_route()));
    ++set_aside;
    ++proposal.number;
    proposal.path = {};
    proposal.pose = event.scan->pose;
    if (!event.is_en_route()) event.proposal = ProposalRecord{proposal.view, proposal.end, {}};
  }

  /// Adds an en-route scan. The proposed view and the path to it remain.
  void pass(const LiveEvent& event, const geometry::Scan& scan) {
    numbers.emplace(event.scan->id, next_number(true));
    recorded_scans.push_back(
        {static_cast<std::uint32_t>(steps->views().size()), scan.sensor_position()});
    steps->pass(scan);
    visibility->add(scan);
    remember(scan);
    departure = scan.sensor_position();
    ++proposal.number;
    proposal.path = reach.record().path;
    proposal.pose = event.scan->pose;
  }

  void remember(const geometry::Scan& scan) {
    if (!poses) return;
    const std::span kept(guide->planner().cloud().positions);
    poses->remember(scan, kept.subspan(remembered));
    remembered = kept.size();
  }

  /// Processes an event and fills in the proposal after it. Returns false for a scan that the
  /// planner rejects as unusable. `reason` then contains the reason and `unwritten` the pending
  /// record, and the planner must be reset.
  bool happen(LiveEvent& event, const geometry::Scan& scan) {
    if (event.scan && event.scan->pose && event.scan->pose->is_wrong) {
      leave_aside(event);
      return true;
    }
    if (event.is_en_route()) {
      pass(event, scan);
      return true;
    }
    reach.begin(event.proposal ? std::optional(event.proposal->reach) : std::nullopt);
    if (event.scan) departure = departure_after(scan);
    std::optional<geometry::View> view;
    try {
      view = event.scan ? steps->add_scan(scan) : steps->reject();
    } catch (const Error& failure) {
      if (!event.scan || event.proposal) throw;
      event.is_rejected = true;
      reason = failure.what();
      unwritten = rejection_text(reason);
      return false;
    }
    if (event.scan) {
      const std::size_t number = steps->views().size() - 1;
      numbers.emplace(event.scan->id, ScanNumber{number});
      recorded_scans.push_back({static_cast<std::uint32_t>(number), scan.sensor_position()});
      visibility->add(scan);
      remember(scan);
    }
    propose(event, view);
    event.proposal = ProposalRecord{proposal.view, proposal.end, reach.record()};
    return true;
  }

  void propose(const LiveEvent& event, const std::optional<geometry::View>& view) {
    const bool is_lost = !event.scan && proposal.has_pose_warning();
    std::optional<PoseFinding> pose = is_lost ? proposal.pose : std::nullopt;
    if (event.scan) pose = event.scan->pose;
    proposal = {.number = proposal.number + 1, .view = view, .path = {}, .end = {}, .pose = pose};
    if (!view) proposal.end = steps->stop_reason();
    if (view && guide->flight() != nullptr && !is_lost) proposal.path = reach.record().path;
  }

  /// Records that cannot be written now are written before any other record.
  void write_down(const std::string& text) {
    unwritten = text;
    catch_up();
  }

  void catch_up() {
    if (!unwritten) return;
    log.append(*unwritten);
    unwritten.reset();
  }

  /// Stores a scan and processes it. Returns false if its id is known.
  bool bring(const geometry::Scan& scan, const std::string& requested_id,
             const std::optional<PoseCovariance>& covariance, bool is_en_route) {
    const std::string bytes = kept_scan(scan), sha256 = compute_checksum(bytes);
    const std::string id =
        requested_id.empty() ? make_id(sha256, scan.world_from_sensor, covariance) : requested_id;
    if (numbers.contains(id)) return false;
    require_expected_scan(is_en_route);
    catch_up();
    const ScanRecord record{.id = id,
                            .file = fmt::format("{}/{:06}.ply", scans_name, events.size()),
                            .sha256 = sha256,
                            .world_from_sensor = scan.world_from_sensor,
                            .pose = check_pose(scan, covariance),
                            .is_en_route = is_en_route};
    geometry::write_file(folder / record.file, bytes);
    geometry::sync_to_disk(folder / scans_name);
    log.append(to_journal_line(record));
    add_event({.scan = record, .rejection_reason = {}, .proposal = {}}, as_used(scan, record));
    return true;
  }

  void require_expected_scan(bool is_en_route) const {
    const auto reject = [](const std::string& what) { throw Error(ErrorKind::bad_usage, what); };
    if (options.flight.has_vehicle() && proposal.end) {
      reject(
          "the survey is complete, and the path to the pose of this scan is not verified; finish "
          "the survey");
    }
    if (!is_en_route) return;
    if (!options.flight.capture.is_moving) {
      reject("en-route scans require sensor.capture: moving");
    }
    if (steps->views().empty()) {
      reject("en-route scans require a scan from the first view; add it first");
    }
  }

  session::SurveyRecord views_record() const {
    session::SurveyRecord record;
    record.seed = run.seed;
    record.threads = geometry::thread_count(run.threads);
    record.stop_reason = proposal.end.value_or(survey::StopReason::interrupted);
    for (const survey::SurveyedView& view : steps->views()) {
      record.views.push_back({view, std::numeric_limits<double>::quiet_NaN()});
    }
    record.scans = recorded_scans;
    for (session::RecordedScan& scan :
         record.scans) {  // Includes scans on the path to a view that was not taken.
      scan.view = std::min(scan.view, static_cast<std::uint32_t>(record.views.size() - 1));
    }
    return record;
  }

  void add_event(LiveEvent event, const geometry::Scan& scan) {
    events.push_back(std::move(event));
    if (happen(events.back(), scan)) {
      if (events.back().proposal) write_down(to_journal_line(*events.back().proposal));
      return;
    }
    replay();  // The planner may have processed a part of the scan.
    catch_up();
    throw Error(ErrorKind::bad_geometry, reason);
  }

  session::SurveyOptions options;
  LiveOptions live;
  fs::path folder;
  std::optional<geometry::View> first_view;
  survey::PlannerRun run;
  geometry::RecordLog log;
  std::vector<LiveEvent> events;
  std::unique_ptr<session::ConstrainedPlanner> guide;
  std::unique_ptr<survey::SurveyStepper> steps;
  session::ReachabilityCache reach;
  Proposal proposal;
  Vector3d departure = Vector3d::Zero();
  std::map<std::string, ScanNumber> numbers;          ///< Numbers of the scans by id.
  std::vector<session::RecordedScan> recorded_scans;  ///< Accepted scans.
  std::size_t set_aside = 0;
  std::optional<BoxSight> visibility;
  std::optional<PoseCheck> poses;
  std::size_t remembered = 0;  ///< Number of points of the planner's cloud that `poses` contains.
  std::string reason;          ///< Reason for rejecting the last scan.
  std::optional<std::string> unwritten;  ///< Record that could not be written yet.
};

LiveSurvey::LiveSurvey(const session::SurveyOptions& options, const LiveOptions& live,
                       const support::Identity& identity, const fs::path& folder,
                       const LiveStart& start, unsigned threads)
    : impl_(std::make_unique<Impl>(options, live, identity, folder, start, threads)) {}

LiveSurvey::~LiveSurvey() = default;

const Proposal& LiveSurvey::proposal() const { return impl_->proposal; }

const survey::Planner& LiveSurvey::planner() const { return impl_->guide->planner(); }

const std::vector<survey::SurveyedView>& LiveSurvey::views() const { return impl_->steps->views(); }

std::size_t LiveSurvey::set_aside() const { return impl_->set_aside; }

std::size_t LiveSurvey::en_route() const { return impl_->steps->passed(); }

std::vector<session::ViewInFlight> LiveSurvey::frames() const {
  const Proposal& next = impl_->proposal;
  const bool is_measured = impl_->options.flight.capture.is_moving && !views().empty();
  if (!is_measured || !next.view || next.path.points.empty()) return {};
  std::vector<session::ViewInFlight> frames =
      impl_->guide->flight()->frames(views().back().view, *next.view);
  frames.erase(frames.begin(),
               frames.begin() + static_cast<std::ptrdiff_t>(std::min(en_route(), frames.size())));
  return frames;
}

std::optional<ScanNumber> LiveSurvey::scan_number(const std::string& id) const {
  const auto found = impl_->numbers.find(id);
  return found == impl_->numbers.end() ? std::nullopt : std::optional(found->second);
}

bool LiveSurvey::add(const geometry::Scan& scan, const std::string& id,
                     const std::optional<PoseCovariance>& covariance) {
  return impl_->bring(scan, id, covariance, false);
}

bool LiveSurvey::add_en_route(const geometry::Scan& scan, const std::string& id,
                              const std::optional<PoseCovariance>& covariance) {
  return impl_->bring(scan, id, covariance, true);
}

void LiveSurvey::reject(const std::string& reason) {
  if (!impl_->proposal.view || views().empty()) {
    throw Error(
        ErrorKind::bad_usage,
        "no view to reject: " + std::string(views().empty() ? "the first view is set by the mission"
                                                            : "the survey is complete"));
  }
  impl_->catch_up();
  impl_->log.append(view_rejection_text(reason));
  impl_->add_event({.scan = {}, .rejection_reason = reason, .proposal = {}}, {});
}

const BoxSight& LiveSurvey::visibility() const { return *impl_->visibility; }

session::SurveyFlight* LiveSurvey::flight() { return impl_->guide->flight(); }

session::SurveyRecord LiveSurvey::so_far() const {
  session::SurveyRecord record = impl_->views_record();
  impl_->guide->fill_record(record);
  return record;
}

session::SurveyRecord LiveSurvey::finish() {
  session::SurveyRecord record = impl_->views_record();
  impl_->guide->finish(record);
  return record;
}

std::string scan_id(const geometry::Scan& scan, const std::optional<PoseCovariance>& covariance) {
  return make_id(compute_checksum(kept_scan(scan)), scan.world_from_sensor, covariance);
}

}  // namespace skycap::missions::online
