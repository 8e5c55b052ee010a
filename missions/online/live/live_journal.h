/// The records of a live survey's journal. For its source.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "geometry/place/pose.h"
#include "missions/online/live/pose_check.h"
#include "missions/session/reach_record.h"
#include "survey/survey_loop.h"

namespace skycap::missions::online {

/// A scan that was acknowledged.
struct ScanRecord {
  std::string id;
  std::string file;                                                     ///< in the survey's folder
  std::string sha256;                                                   ///< of the file
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();  ///< as given
  std::optional<PoseFinding> pose;  ///< what was found of it, if poses are checked
  bool is_on_way = false;           ///< to the view that is proposed, which stands
};

/// What was proposed after a scan or a refusal.
struct ProposalRecord {
  std::optional<geometry::View> view;
  std::optional<survey::StopReason> end;
  session::ReachRecord reach;
};

/// Something that happened to the survey, and what followed if the program lived to say so. Nothing
/// follows a scan on the way.
struct LiveEvent {
  std::optional<ScanRecord> scan;  ///< or a refusal
  std::string refusal;             ///< its reason
  bool is_rejected = false;        ///< a scan that the planner cannot work with: it does not count
  std::optional<ProposalRecord> proposal;

  bool is_on_way() const { return scan && scan->is_on_way; }
};

std::string text_of(const ScanRecord& scan);
std::string refusal_text(const std::string& reason);
std::string rejection_text(const std::string& reason);
std::string text_of(const ProposalRecord& proposal);

/// The events of a journal without its first record. Throws Error{bad_file} naming `file` and the
/// line if a record is none of the above.
std::vector<LiveEvent> events_of(const std::vector<std::string>& records, const std::string& file);

/// What was found of a pose, as answers and journals have it. In the journal `correction` is whole.
nlohmann::ordered_json finding_json(const PoseFinding& finding);

/// A pose as twelve numbers, row after row of [rotation | position], and back. Throws
/// Error{bad_file} unless it is at a place and turns without stretching, within a hundredth: such a
/// one is made a rotation.
nlohmann::ordered_json pose_json(const Eigen::Isometry3d& pose);
Eigen::Isometry3d parse_pose(const std::vector<double>& numbers, const std::string& what);

}  // namespace skycap::missions::online
