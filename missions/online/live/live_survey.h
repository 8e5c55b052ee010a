/// Survey with scans from an external source, stored in a folder. After a program crash, the survey
/// resumes at the last acknowledged scan.
///
/// The folder contains `live.journal` and `scans/`. The journal is a record log
/// (geometry::RecordLog): the identity of the survey, then each scan, each refusal and the proposal
/// after it. `scans/` contains the scans as input to the planner. Opening the folder replays all
/// scans, and the proposals must be bit-identical. Paths are not planned again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/points/scan.h"
#include "geometry/pose/pose.h"
#include "missions/online/live/box_sight.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/pose_check.h"
#include "missions/session/survey_options.h"
#include "missions/session/survey_record.h"
#include "missions/session/view_in_flight.h"
#include "missions/support/identity.h"
#include "survey/planners/planner_options.h"
#include "survey/survey_loop.h"

namespace skycap::missions::online {

/// Next action of a live survey.
struct Proposal {
  std::size_t number = 0;  ///< Number of scans and refusals so far.
  /// View of the next scan. Empty if the survey is complete or if the first scan may be taken from
  /// any view.
  std::optional<geometry::View> view;
  /// For surveys with a vehicle: path to the view, verified collision-free in free space, with its
  /// clearance [m].
  session::ExecutedLeg path;
  /// Reason why the survey has no next view. Empty before the first scan.
  std::optional<survey::StopReason> end;
  /// Pose check of the previous scan, if it was checked. After a rejected scan, it remains until a
  /// scan is accepted. During that time the sensor position is unknown and `path` is empty.
  std::optional<PoseFinding> pose;

  bool has_pose_warning() const { return pose && pose->is_wrong; }
};

/// Number of views used before a scan. For en-route scans, also the number of scans already taken
/// on that path.
struct ScanNumber {
  std::size_t view = 0;
  std::optional<std::size_t> en_route{};
  bool operator==(const ScanNumber&) const = default;
};

/// Initial conditions of a live survey.
struct LiveStart {
  /// View proposed for the first scan. If empty, the first scan may be taken from any view.
  /// Required for surveys with a vehicle.
  std::optional<geometry::View> view;
  /// View sphere for volumetric planners without one in their settings.
  std::optional<survey::ViewSphere> sphere;
};

class LiveSurvey {
 public:
  /// Opens the survey in `folder` or creates a new one, with `threads` threads (0: all processors).
  /// Throws Error{bad_file} naming the file if the survey's identity differs from `identity`, or if
  /// the folder is damaged or in use by another program. Also throws all errors of
  /// ConstrainedPlanner.
  LiveSurvey(const session::SurveyOptions& options, const LiveOptions& live,
             const support::Identity& identity, const std::filesystem::path& folder,
             const LiveStart& start, unsigned threads);
  ~LiveSurvey();

  const Proposal& proposal() const;

  /// Returns the planner with its current state.
  const survey::Planner& planner() const;

  const std::vector<survey::SurveyedView>& views() const;

  std::size_t set_aside() const;  ///< Returns the number of scans rejected because of their poses.

  /// Returns the number of scans accepted since the last view, on the path to the proposed view.
  std::size_t en_route() const;

  /// Returns the remaining en-route scans of the current path if the survey takes them
  /// (CaptureOptions). Times count from the departure from the last view [s]. Returns an empty list
  /// if no path is verified.
  std::vector<session::ViewInFlight> frames() const;

  /// Returns the number of the scan with this id, if it exists.
  std::optional<ScanNumber> scan_number(const std::string& id) const;

  /// Stores a scan, checks its pose (LiveOptions), and plans with it or rejects it. Returns false
  /// if a scan with this id exists; the scan is then acknowledged and ignored. An empty `id` stands
  /// for scan_id(). The default covariance is that of LiveOptions. Throws Error{bad_geometry} if
  /// the scan is unusable for the planner, and Error{bad_file} if it cannot be stored. The survey
  /// is then unchanged.
  bool add(const geometry::Scan& scan, const std::string& id,
           const std::optional<PoseCovariance>& covariance = {});

  /// Adds an en-route scan like add(). The proposed view remains. Throws Error{bad_usage} before
  /// the first view, after the end of the survey, and if the survey takes no en-route scans.
  bool add_en_route(const geometry::Scan& scan, const std::string& id,
                    const std::optional<PoseCovariance>& covariance = {});

  /// Rejects the proposed view and plans another one. Throws Error{bad_usage} if no view is
  /// proposed.
  void reject(const std::string& reason);

  /// Returns the part of the region of interest that the scans used have observed.
  const BoxSight& visibility() const;

  /// Returns the path planner of the vehicle, or null for surveys without a vehicle.
  session::SurveyFlight* flight();

  /// Returns the current record for display, without the flight. The record is marked as
  /// interrupted while a view is proposed.
  session::SurveyRecord so_far() const;

  /// Returns the current record for a package, marked as interrupted while a view is proposed. The
  /// folder remains unchanged. Afterwards, this object may only be destroyed.
  session::SurveyRecord finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the default id of a scan: a checksum of pose, points, pixels and pose covariance.
/// Including the covariance allows a rejected scan to be sent again with a larger one. add()
/// computes the same id more efficiently from the stored file's checksum.
std::string scan_id(const geometry::Scan& scan,
                    const std::optional<PoseCovariance>& covariance = {});

}  // namespace skycap::missions::online
