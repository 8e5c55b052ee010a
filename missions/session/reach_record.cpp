#include "missions/session/reach_record.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "missions/support/json_text.h"

namespace skycap::missions::session {

using support::to_json;
using support::to_vector;
using Json = nlohmann::ordered_json;

Json reach_json(const ReachRecord& record) {
  Json json{{"refused", record.rejected},
            {"reached", record.is_reached},
            {"unreached", record.unreached},
            {"clearance", record.path.clearance},
            {"way", Json::array()}};
  for (const Eigen::Vector3d& point : record.path.points) json["way"].push_back(to_json(point));
  return json;
}

ReachRecord parse_reach(const Json& json) {
  ReachRecord record;
  record.rejected = json.at("refused").get<std::size_t>();
  record.is_reached = json.at("reached").get<bool>();
  record.unreached = json.at("unreached").get<std::size_t>();
  record.path.clearance = json.at("clearance").get<double>();
  for (const Json& point : json.at("way")) record.path.points.push_back(to_vector(point));
  return record;
}

void ReachabilityCache::begin(std::optional<ReachRecord> known) {
  known_ = std::move(known);
  record_ = {};
}

ReachabilityCache::CanReach ReachabilityCache::remembering(CanReach can_reach,
                                                           SurveyFlight* flight) {
  return [this, flight, can_reach = std::move(can_reach)](const Eigen::Vector3d& from,
                                                          const geometry::View& to) {
    if (known_) return known_answer(flight);
    record_.is_reached = can_reach(from, to);
    if (!record_.is_reached) ++record_.rejected;
    if (flight == nullptr) return record_.is_reached;
    record_.unreached = flight->rejected();
    if (record_.is_reached) record_.path = flight->path();
    return record_.is_reached;
  };
}

bool ReachabilityCache::known_answer(SurveyFlight* flight) {
  if (flight != nullptr) {
    record_.path = known_->path;
    record_.unreached = known_->unreached;
    flight->add_leg(known_->path, known_->unreached);
  }
  record_.is_reached = known_->is_reached && record_.rejected == known_->rejected;
  if (!record_.is_reached) ++record_.rejected;
  return record_.is_reached;
}

}  // namespace skycap::missions::session
