#include "missions/session/reach_record.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "missions/support/json_text.h"

namespace skycap::missions::session {

using support::json_of;
using support::vector_of;
using Json = nlohmann::ordered_json;

Json reach_json(const ReachRecord& record) {
  Json json{{"refused", record.refused},
            {"reached", record.is_reached},
            {"unreached", record.unreached},
            {"clearance", record.way.clearance},
            {"way", Json::array()}};
  for (const Eigen::Vector3d& point : record.way.points) json["way"].push_back(json_of(point));
  return json;
}

ReachRecord parse_reach(const Json& json) {
  ReachRecord record;
  record.refused = json.at("refused").get<std::size_t>();
  record.is_reached = json.at("reached").get<bool>();
  record.unreached = json.at("unreached").get<std::size_t>();
  record.way.clearance = json.at("clearance").get<double>();
  for (const Json& point : json.at("way")) record.way.points.push_back(vector_of(point));
  return record;
}

void ReachMemory::begin(std::optional<ReachRecord> known) {
  known_ = std::move(known);
  record_ = {};
}

ReachMemory::CanReach ReachMemory::remembering(CanReach can_reach, SurveyFlight* flight) {
  return [this, flight, can_reach = std::move(can_reach)](const Eigen::Vector3d& from,
                                                          const geometry::View& to) {
    if (known_) return known_answer(flight);
    record_.is_reached = can_reach(from, to);
    if (!record_.is_reached) ++record_.refused;
    if (flight == nullptr) return record_.is_reached;
    record_.unreached = flight->refused();
    if (record_.is_reached) record_.way = flight->way();
    return record_.is_reached;
  };
}

bool ReachMemory::known_answer(SurveyFlight* flight) {
  if (flight != nullptr) {
    record_.way = known_->way;
    record_.unreached = known_->unreached;
    flight->take_way(known_->way, known_->unreached);
  }
  record_.is_reached = known_->is_reached && record_.refused == known_->refused;
  if (!record_.is_reached) ++record_.refused;
  return record_.is_reached;
}

}  // namespace skycap::missions::session
