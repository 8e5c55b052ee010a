#include "missions/online/live/live_journal.h"

#include <cmath>
#include <filesystem>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/json.h"
#include "geometry/pose/world.h"
#include "missions/session/survey_record.h"
#include "missions/support/journal_text.h"
#include "missions/support/json_text.h"

namespace skycap::missions::online {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const std::optional<geometry::View>& view) {
  if (!view) return {};
  return {{"position", support::to_json(view->position)},
          {"direction", support::to_json(view->direction)}};
}

PoseFinding parse_finding(const Json& json) {
  PoseFinding finding{.matches = json.at("matches").get<std::size_t>(),
                      .error = json.at("error_m").get<double>(),
                      .shift = json.at("shift_m").get<double>(),
                      .turn = json.at("turn").get<double>(),
                      .seen_through = json.at("seen_through").get<double>(),
                      .unobservable = json.at("unobservable").get<int>(),
                      .is_checked = json.at("checked").get<bool>(),
                      .is_wrong = json.at("rejected").get<bool>(),
                      .correction = {}};
  if (json.contains("correction")) {
    finding.correction =
        parse_pose(json["correction"].get<std::vector<double>>(), "its correction");
  }
  return finding;
}

/// Returns the complete finding, with the rotation in radians.
Json journal_json(const PoseFinding& finding) {
  Json json = finding_json(finding);
  json["turn"] = finding.turn;
  if (finding.correction) json["correction"] = pose_json(*finding.correction);
  return json;
}

ScanRecord parse_scan(const Json& json) {
  ScanRecord scan{
      .id = json.at("id").get<std::string>(),
      .file = json.at("file").get<std::string>(),
      .sha256 = json.at("sha256").get<std::string>(),
      .world_from_sensor = parse_pose(json.at("pose").get<std::vector<double>>(), "its pose"),
      .pose = {},
      .is_en_route = json.value("en_route", false)};
  if (json.contains("found")) scan.pose = parse_finding(json["found"]);
  const std::filesystem::path file = scan.file;
  if (file.is_absolute() || file.lexically_normal().string().starts_with("..")) {
    throw Error(ErrorKind::bad_file, "its scan file is outside the survey folder");
  }
  return scan;
}

ProposalRecord parse_proposal(const Json& json) {
  ProposalRecord proposal;
  if (const Json& view = json.at("view"); !view.is_null()) {
    proposal.view = {support::to_vector(view.at("position")),
                     support::to_vector(view.at("direction"))};
  }
  if (const Json& end = json.at("end"); !end.is_null()) {
    proposal.end = session::stop_reason_named(end.get<std::string>());
  }
  proposal.reach = session::parse_reach(json.at("reach"));
  return proposal;
}

void add_record(const Json& json, std::vector<LiveEvent>& events) {
  const bool follows = !events.empty() && !events.back().proposal && !events.back().is_rejected &&
                       !events.back().is_en_route();
  if (json.contains("scan") && !follows) {
    events.push_back({.scan = parse_scan(json["scan"])});
  } else if (json.contains("refusal") && !follows) {
    events.push_back({.rejection_reason = json["refusal"].get<std::string>()});
  } else if (json.contains("rejected") && follows) {
    events.back().is_rejected = true;
  } else if (json.contains("proposal") && follows) {
    events.back().proposal = parse_proposal(json["proposal"]);
  } else {
    throw Error(ErrorKind::bad_file,
                "unexpected kind; expected a scan, refusal, proposal or rejection");
  }
}

}  // namespace

std::string to_journal_line(const ScanRecord& scan) {
  Json json{{"id", scan.id},
            {"file", scan.file},
            {"sha256", scan.sha256},
            {"pose", pose_json(scan.world_from_sensor)}};
  if (scan.pose) json["found"] = journal_json(*scan.pose);
  if (scan.is_en_route) json["en_route"] = true;
  return support::journal_line({{"scan", std::move(json)}});
}

std::string view_rejection_text(const std::string& reason) {
  return support::journal_line({{"refusal", reason}});
}

std::string rejection_text(const std::string& reason) {
  return support::journal_line({{"rejected", reason}});
}

std::string to_journal_line(const ProposalRecord& proposal) {
  return support::journal_line(
      {{"proposal",
        {{"view", to_json(proposal.view)},
         {"end", proposal.end ? Json(session::to_string(*proposal.end)) : Json()},
         {"reach", session::reach_json(proposal.reach)}}}});
}

std::vector<LiveEvent> parse_events(const std::vector<std::string>& records,
                                    const std::string& file) {
  std::vector<LiveEvent> events;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const auto fail = [&](const std::string& what) {
      throw Error(ErrorKind::bad_file,
                  std::string(file).append(": line ").append(std::to_string(i + 1)) +
                      " cannot be used: " + what);
    };
    try {
      add_record(geometry::parse_json<Json>(records[i]), events);
    } catch (const Json::exception& failure) {
      fail(failure.what());
    } catch (const Error& failure) {
      fail(failure.what());
    }
  }
  return events;
}

Json finding_json(const PoseFinding& finding) {
  return {{"rejected", finding.is_wrong},
          {"corrected", finding.correction.has_value()},
          {"checked", finding.is_checked},
          {"matches", finding.matches},
          {"error_m", finding.error},
          {"shift_m", finding.shift},
          {"turn_deg", finding.turn / geometry::radians_per_degree},
          {"unobservable", finding.unobservable},
          {"seen_through", finding.seen_through}};
}

Json pose_json(const Eigen::Isometry3d& pose) {
  Json numbers = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) numbers.push_back(pose(row, column));
  }
  return numbers;
}

Eigen::Isometry3d parse_pose(const std::vector<double>& numbers, const std::string& what) {
  const auto reject = [&](const std::string& reason) {
    throw Error(ErrorKind::bad_file, what + " " + reason);
  };
  if (numbers.size() != 12) reject("must have twelve numbers: the rows of [rotation | position]");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 12; ++i) pose(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)];
  const Eigen::Matrix3d turn = pose.linear();
  const double stretch = (turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm();
  constexpr double rounding = 1e-9, sloppiness = 1e-2;
  if (!(stretch < sloppiness && turn.determinant() > 0.0)) {
    reject("must be a rotation without scale or reflection");
  }
  // Trackers let rotations drift. Rotations written by Skycap remain bit-identical.
  if (stretch > rounding) {
    pose.linear() = Eigen::Quaterniond(turn).normalized().toRotationMatrix();
  }
  geometry::require_valid_position(pose.translation(), what);
  return pose;
}

}  // namespace skycap::missions::online
