/// Records of a live survey's journal, for its implementation only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "geometry/pose/pose.h"
#include "missions/online/live/pose_check.h"
#include "missions/session/reach_record.h"
#include "survey/survey_loop.h"

namespace skycap::missions::online {

/// Record of an acknowledged scan.
struct ScanRecord {
  std::string id;
  std::string file;    ///< Path relative to the survey's folder.
  std::string sha256;  ///< SHA-256 checksum of the file.
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();  ///< Pose as received.
  std::optional<PoseFinding> pose;  ///< Result of the pose check, if pose checks are enabled.
  bool is_en_route =
      false;  ///< True for an en-route scan, which leaves the proposed view unchanged.
};

/// Proposal after a scan or a refusal.
struct ProposalRecord {
  std::optional<geometry::View> view;
  std::optional<survey::StopReason> end;
  session::ReachRecord reach;
};

/// Scan or refusal and the proposal that followed. The proposal is missing for en-route scans, and
/// if the program ended before it was recorded.
struct LiveEvent {
  std::optional<ScanRecord> scan;  ///< Acknowledged scan; empty for a refusal.
  std::string rejection_reason;    ///< Reason for the refusal.
  bool is_rejected = false;  ///< The planner rejected the scan as unusable; it does not count.
  std::optional<ProposalRecord> proposal;

  bool is_en_route() const { return scan && scan->is_en_route; }
};

std::string to_journal_line(const ScanRecord& scan);
std::string view_rejection_text(const std::string& reason);
std::string rejection_text(const std::string& reason);
std::string to_journal_line(const ProposalRecord& proposal);

/// Parses all records of a journal except the first. Throws Error{bad_file} naming `file` and the
/// line of a record of unknown type.
std::vector<LiveEvent> parse_events(const std::vector<std::string>& records,
                                    const std::string& file);

/// Returns the result of a pose check as in answers and journals. Journals store the full
/// `correction`.
nlohmann::ordered_json finding_json(const PoseFinding& finding);

/// Converts a pose to twelve numbers, the rows of [rotation | position], and back. parse_pose()
/// orthonormalises matrices that differ from a rotation by less than 0.01. It throws
/// Error{bad_file} for larger differences and for invalid positions.
nlohmann::ordered_json pose_json(const Eigen::Isometry3d& pose);
Eigen::Isometry3d parse_pose(const std::vector<double>& numbers, const std::string& what);

}  // namespace skycap::missions::online
