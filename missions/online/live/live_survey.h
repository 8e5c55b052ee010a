/// A survey whose scans come from outside, one at a time, and which lives in a folder: whatever
/// happens to the program, the next one goes on where the last scan was acknowledged.
///
/// The folder holds `live.journal`, a log of records (geometry::RecordLog): first which survey it
/// is, then each scan, each refusal, and what was proposed after each; and `scans/`, the scans as
/// the planner took them in. Opening the folder plans all of them again; proposals must come out
/// the same to the last bit. Ways are not looked for again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/pose_check.h"
#include "missions/session/survey_options.h"
#include "missions/session/survey_record.h"
#include "missions/session/view_in_flight.h"
#include "missions/support/identity.h"
#include "survey/planners/planner_options.h"
#include "survey/survey_loop.h"

namespace skycap::missions::online {

/// What to do next.
struct Proposal {
  std::size_t number = 0;  ///< what happened so far: scans and refusals
  /// Where to take the next scan. Nothing: the survey is over, or the first scan may be from
  /// anywhere.
  std::optional<geometry::View> view;
  /// With a vehicle: the way there, proven through measured free space, and its clearance [m].
  session::FlownLeg way;
  /// Why there is no view; nothing before the first scan.
  std::optional<survey::StopReason> end;
  /// What was found of the pose of the scan before, if it was looked at. One that was set aside
  /// stays here until a scan is used: nobody knows where the sensor is, and no way is given.
  std::optional<PoseFinding> pose;

  bool warns_of_pose() const { return pose && pose->is_wrong; }
};

/// How many views were used before a scan and, of one from the way to the next view, how many scans
/// on that way.
struct ScanNumber {
  std::size_t view = 0;
  std::optional<std::size_t> on_way{};
  bool operator==(const ScanNumber&) const = default;
};

/// Where a live survey begins.
struct LiveStart {
  /// Proposed for the first scan; nothing: that may be from anywhere. A survey with a vehicle needs
  /// it.
  std::optional<geometry::View> view;
  std::optional<survey::ViewSphere> sphere;  ///< of volumetric planners whose settings give none
};

class LiveSurvey {
 public:
  /// Opens the folder of a survey, or begins one in it, on so many threads (zero: all processors).
  /// Throws Error{bad_file} naming the file if the folder is of another survey than `identity`,
  /// which says what differs, is damaged, or in use by another program; and what MissionPlanner
  /// throws.
  LiveSurvey(const session::SurveyOptions& options, const LiveOptions& live,
             const support::Identity& identity, const std::filesystem::path& folder,
             const LiveStart& start, unsigned threads);
  ~LiveSurvey();

  const Proposal& proposal() const;

  /// What the planner holds at present.
  const survey::Planner& planner() const;

  const std::vector<survey::SurveyedView>& views() const;

  std::size_t set_aside() const;  ///< scans whose poses were wrong

  /// Scans used since the last view, on the way to the one that is proposed.
  std::size_t on_way() const;

  /// What is still to be scanned on that way, if the survey measures there (CaptureOptions), with
  /// times since the vehicle left the last view. Empty where no way is proven.
  std::vector<session::ViewInFlight> frames() const;

  /// The number that a scan was taken in under, if there is one with this id.
  std::optional<ScanNumber> number_of(const std::string& id) const;

  /// Brings a scan to the disk, looks at its pose (LiveOptions), and plans, or sets it aside.
  /// One whose id is known is acknowledged and ignored: false. An empty id is scan_id()'s. Without
  /// a covariance it is that of LiveOptions. Throws Error{bad_geometry} for a scan that the planner
  /// cannot work with, and Error{bad_file} if the disk takes no more; then nothing has changed.
  bool add(const geometry::Scan& scan, const std::string& id,
           const std::optional<PoseCovariance>& covariance = {});

  /// The same with a scan from the way to the proposed view, which stands. Throws Error{bad_usage}
  /// where no such scan is wanted: before the first view, when the survey is over, and unless the
  /// survey measures on the way.
  bool add_on_way(const geometry::Scan& scan, const std::string& id,
                  const std::optional<PoseCovariance>& covariance = {});

  /// Asks for another view in place of the proposed one. Throws Error{bad_usage} if there is none.
  void refuse(const std::string& reason);

  /// What knows the ways of the vehicle; null without one.
  session::SurveyFlight* flight();

  /// The survey so far, to be looked at: interrupted, if a view is still proposed; without its
  /// flight.
  session::SurveyRecord so_far() const;

  /// The survey so far, for a package: interrupted, if a view is still proposed. The folder stays
  /// as it is; this object may only be destroyed afterwards.
  session::SurveyRecord finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The id of a scan that has none: a digest of pose, points and pixels, and of the pose's
/// covariance: one that was set aside may come again with a larger one. add() needs it, too, and
/// has it for less.
std::string scan_id(const geometry::Scan& scan,
                    const std::optional<PoseCovariance>& covariance = {});

}  // namespace skycap::missions::online
