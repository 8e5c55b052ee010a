#include "missions/simulation/survey_journal.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/json.h"
#include "geometry/pose/world.h"
#include "missions/support/journal_text.h"
#include "missions/support/json_text.h"
#include "missions/support/sha256.h"

namespace skycap::missions::simulation {
namespace {

using Eigen::Vector3d;
using support::to_json;
using support::to_vector;
using Json = nlohmann::ordered_json;

/// Identifies the mesh by its samples, because the file of a model may change.
std::string compute_checksum(const evaluation::SurveyScene& scene) {
  return support::sha256(std::as_bytes(std::span<const Eigen::Vector3f>(scene.samples().points)));
}

}  // namespace

SurveyJournal::SurveyJournal(std::filesystem::path file, const support::Identity& run,
                             const evaluation::SurveyScene& scene, bool resumes)
    : file_(std::move(file)),
      identity_(support::identity_text(
          run, {{"format", support::journal_format}, {"surface", compute_checksum(scene)}})) {
  if (!resumes || !std::filesystem::exists(file_)) return;
  log_.emplace(file_);
  if (!log_->records().empty()) read_known(log_->records());
}

void SurveyJournal::read_known(const std::vector<std::string>& records) {
  support::require_same_survey(file_.string(), records.front(), identity_,
                               "start again without --resume");
  try {
    for (const std::string& record : std::span(records).subspan(1)) {
      known_.push_back(parse(record));
    }
  } catch (const Json::exception& failure) {
    fail("line " + std::to_string(known_.size() + 2) + " is damaged: " + failure.what());
  }
}

std::string SurveyJournal::to_journal_line(const ViewRecord& record) {
  return support::journal_line({{"position", to_json(record.view.position)},
                                {"direction", to_json(record.view.direction)},
                                {"returns", record.returns},
                                {"points", record.points},
                                {"next", session::reach_json(record.reach)}});
}

SurveyJournal::ViewRecord SurveyJournal::parse(const std::string& text) const {
  const Json json = geometry::parse_json<Json>(text);
  ViewRecord record{.view = {to_vector(json.at("position")), to_vector(json.at("direction"))},
                    .returns = json.at("returns").get<std::size_t>(),
                    .points = json.at("points").get<std::size_t>(),
                    .reach = session::parse_reach(json.at("next"))};
  const bool is_in_world =
      geometry::is_valid_position(record.view.position) &&
      std::ranges::all_of(record.reach.path.points, [](const Vector3d& position) {
        return geometry::is_valid_position(position);
      });
  if (!is_in_world) {
    fail("line " + std::to_string(known_.size() + 2) +
         " contains a position outside the coordinate limits");
  }
  return record;
}

void SurveyJournal::attach(survey::SurveyCallbacks& callbacks, session::SurveyFlight* flight,
                           const survey::Planner& planner) {
  callbacks.sense = [this, sense = std::move(callbacks.sense)](const geometry::View& view,
                                                               geometry::Scan buffer) {
    begin_view(view);
    return sense(view, std::move(buffer));
  };
  if (callbacks.can_reach) {
    callbacks.can_reach = reach_.remembering(std::move(callbacks.can_reach), flight);
  }
  callbacks.report = [this, &planner, report = std::move(callbacks.report)](
                         const survey::SurveyedView& view, const geometry::Scan& scan) {
    end_view(view);
    if (!is_known()) write_preview(planner.cloud().positions);
    if (report) report(view, scan);
  };
}

void SurveyJournal::begin_view(const geometry::View& view) {
  reach_.begin(is_known() ? std::optional(known_[at_].reach) : std::nullopt);
  current_ = {.view = view};
  if (!is_known()) return;
  const geometry::View& known = known_[at_].view;
  if (view.position == known.position && view.direction == known.direction) return;
  fail("does not match: view " + std::to_string(at_) +
       " was taken from a different pose; start again without --resume");
}

void SurveyJournal::end_view(const survey::SurveyedView& view) {
  current_.returns = view.returns;
  current_.points = view.points;
  current_.reach = reach_.record();
  if (!is_known()) {
    if (!log_) {
      std::filesystem::remove(file_);
      log_.emplace(file_);
    }
    if (at_ == 0 && log_->records().empty()) log_->append(identity_);
    log_->append(to_journal_line(current_));
    known_.push_back(current_);
  } else if (to_journal_line(current_) != to_journal_line(known_[at_])) {
    fail("does not match: view " + std::to_string(at_) +
         " has different points; start again without --resume");
  }
  ++at_;
}

void SurveyJournal::write_preview(std::span<const Eigen::Vector3f> cloud) {
  const bool is_new = !preview_;
  if (is_new) {
    preview_.emplace(std::filesystem::path(file_).replace_filename(preview_name));
  }
  const std::size_t old_stride = preview_stride_;
  while (cloud.size() > preview_stride_ * max_preview_points) preview_stride_ *= 2;
  if (is_new || preview_stride_ != old_stride) {
    preview_->clear();
    preview_->append(Json{{"stride", preview_stride_}}.dump());
    previewed_ = 0;
  }
  Json positions = Json::array();
  const std::size_t first = (previewed_ + preview_stride_ - 1) / preview_stride_ * preview_stride_;
  for (std::size_t i = first; i < cloud.size(); i += preview_stride_) {
    for (const float coordinate : cloud[i]) {
      positions.push_back(std::lround(1000.0 * static_cast<double>(coordinate)));
    }
  }
  preview_->append(positions.dump());
  previewed_ = cloud.size();
}

void SurveyJournal::fail(const std::string& what) const {
  throw Error(ErrorKind::bad_file, file_.string() + ": " + what);
}

}  // namespace skycap::missions::simulation
