#include "missions/run/survey_journal.h"

#include <span>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/json.h"
#include "missions/derived/survey_settings.h"
#include "missions/scene/sha256.h"
#include "missions/version.h"

namespace skycap::missions::run {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

Json json_of(const Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// One line; names that are not UTF-8 are shown with a replacement character.
std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Everything that a survey follows from.
Json identity_of(const file::Mission& mission, const scene::SurveyScene& scene) {
  Json identity{{"version", version}, {"seed", mission.seed}};
  // The surface's samples stand for the mesh that was found under the model's name.
  identity["surface"] =
      scene::sha256(std::as_bytes(std::span<const Eigen::Vector3f>(scene.samples().points)));
  for (const auto& [key, value] : derived::survey_settings(mission)) identity[key] = value;
  return identity;
}

bool is_same(const geometry::View& a, const geometry::View& b) {
  return a.position == b.position && a.direction == b.direction;
}

}  // namespace

SurveyJournal::SurveyJournal(std::filesystem::path file, const file::Mission& mission,
                             const scene::SurveyScene& scene, bool resumes)
    : file_(std::move(file)), identity_(line_of(identity_of(mission, scene))) {
  if (!resumes || !std::filesystem::exists(file_)) return;
  log_.emplace(file_);
  if (!log_->records().empty()) read_known(log_->records());
}

void SurveyJournal::read_known(const std::vector<std::string>& records) {
  try {
    const Json found = geometry::parse_json<Json>(records.front()), ours = Json::parse(identity_);
    if (!found.is_object()) fail("does not begin as a survey's journal");
    for (const auto& [key, value] : ours.items()) {
      const Json other = found.value(key, Json("-"));
      if (other == value) continue;
      fail("is of another survey: " + key + " was " + other.dump() + " and is " + value.dump() +
           "; begin anew without --resume, or take that back");
    }
    for (const std::string& record : std::span(records).subspan(1)) {
      known_.push_back(parse(record));
    }
  } catch (const Json::exception& failure) {
    fail(std::string("line ") + std::to_string(known_.size() + 2) +
         " is not as plan writes it: " + failure.what());
  }
}

std::string SurveyJournal::text_of(const ViewRecord& record) {
  Json json{{"position", json_of(record.view.position)},
            {"direction", json_of(record.view.direction)},
            {"returns", record.returns},
            {"points", record.points},
            {"refused", record.refused},
            {"reached", record.is_reached},
            {"unreached", record.unreached},
            {"clearance", record.way.clearance},
            {"way", Json::array()}};
  for (const Vector3d& point : record.way.points) json["way"].push_back(json_of(point));
  return line_of(json);
}

SurveyJournal::ViewRecord SurveyJournal::parse(const std::string& text) {
  const Json json = geometry::parse_json<Json>(text);
  ViewRecord record;
  record.view = {vector_of(json.at("position")), vector_of(json.at("direction"))};
  record.returns = json.at("returns").get<std::size_t>();
  record.points = json.at("points").get<std::size_t>();
  record.refused = json.at("refused").get<std::size_t>();
  record.is_reached = json.at("reached").get<bool>();
  record.unreached = json.at("unreached").get<std::size_t>();
  record.way.clearance = json.at("clearance").get<double>();
  for (const Json& point : json.at("way")) record.way.points.push_back(vector_of(point));
  return record;
}

void SurveyJournal::attach(survey::SurveyPorts& ports, SurveyFlight* flight) {
  ports.sense = [this, sense = std::move(ports.sense)](const geometry::View& view,
                                                       geometry::Scan recycled) {
    begin_view(view);
    return sense(view, std::move(recycled));
  };
  if (ports.can_reach) {
    ports.can_reach = [this, flight, can_reach = std::move(ports.can_reach)](
                          const Vector3d& from, const geometry::View& to) {
      if (is_known()) return known_answer(flight);
      current_.is_reached = can_reach(from, to);
      if (!current_.is_reached) ++current_.refused;
      return current_.is_reached;
    };
  }
  ports.report = [this, flight, report = std::move(ports.report)](const survey::SurveyedView& view,
                                                                  const geometry::Scan& scan) {
    end_view(view, flight);
    if (report) report(view, scan);
  };
}

void SurveyJournal::begin_view(const geometry::View& view) {
  current_ = {};
  current_.view = view;
  if (is_known() && !is_same(view, known_[at_].view)) {
    fail("says that view " + std::to_string(at_) +
         " was taken elsewhere; begin anew without --resume");
  }
}

bool SurveyJournal::known_answer(SurveyFlight* flight) {
  const ViewRecord& record = known_[at_];
  if (current_.refused < record.refused) {
    ++current_.refused;
    return false;
  }
  current_.is_reached = record.is_reached;
  if (flight != nullptr && record.is_reached) flight->take_way(record.way, record.unreached);
  return record.is_reached;
}

void SurveyJournal::end_view(const survey::SurveyedView& view, const SurveyFlight* flight) {
  current_.returns = view.returns;
  current_.points = view.points;
  if (is_known()) {
    const ViewRecord& record = known_[at_++];
    if (current_.returns == record.returns && current_.points == record.points &&
        current_.refused == record.refused && current_.is_reached == record.is_reached) {
      return;
    }
    fail("says that view " + std::to_string(at_ - 1) +
         " gave something else; begin anew without --resume");
  }
  if (flight != nullptr) {
    current_.unreached = flight->refused();
    if (current_.is_reached) current_.way = flight->way();
  }
  if (!log_) {
    std::filesystem::remove(file_);
    log_.emplace(file_);
  }
  if (at_ == 0 && log_->records().empty()) log_->append(identity_);
  log_->append(text_of(current_));
  known_.push_back(current_);
  ++at_;
}

void SurveyJournal::fail(const std::string& what) const {
  throw Error(ErrorKind::bad_file, file_.string() + ": " + what);
}

}  // namespace skycap::missions::run
