#include "missions/package/route_json.h"

#include <cstdint>

#include <nlohmann/json.hpp>

#include "missions/support/json_text.h"

namespace skycap::missions::package {
namespace {

using support::json_of;
using Json = nlohmann::ordered_json;

Json json_of(const flight::Leg& leg, const Json& from, const Json& to) {
  return {{"from", from},
          {"to", to},
          {"clearance_m", leg.clearance},
          {"duration_s", leg.duration},
          {"energy_wh", leg.energy / 3600.0},
          {"points", json_of(leg.points)}};
}

/// Returns the fly-through data of a sortie, or null for other sorties.
Json passage_json(const flight::Route& route, const flight::Sortie& sortie) {
  if (!sortie.passage) return {};
  const flight::Passage& passage = *sortie.passage;
  Json views = Json::array();
  for (std::size_t i = 0; i < passage.views.size(); ++i) {
    const flight::PassedView& view = passage.views[i];
    const double speed = flight::state_at(passage.curve, view.moment).velocity.norm();
    views.push_back({{"view", route.stations[sortie.first + i].view_index},
                     {"time_s", view.moment},
                     {"position", json_of(view.position)},
                     {"speed_m_s", speed}});
  }
  return {{"duration_s", sortie.passing_time},
          {"length_m", passage.length + 2.0 * route.options.takeoff_climb},
          {"stops", passage.stops},
          {"clearance_m", passage.clearance},
          {"views", views}};
}

Json legs_of(const flight::Route& route, const flight::Sortie& sortie) {
  const auto view = [&](std::uint32_t station) { return route.stations[station].view_index; };
  Json legs = Json::array({json_of(sortie.out, {}, view(sortie.first))});
  for (std::uint32_t i = sortie.first; i < sortie.last; ++i) {
    legs.push_back(json_of(route.legs[i], view(i), view(i + 1)));
  }
  legs.push_back(json_of(sortie.back, view(sortie.last), {}));
  return legs;
}

}  // namespace

Json sorties_json(const flight::Route& route) {
  Json sorties = Json::array();
  for (const flight::Sortie& sortie : route.sorties) {
    sorties.push_back({{"first_station", sortie.first},
                       {"last_station", sortie.last},
                       {"duration_s", sortie.duration},
                       {"energy_wh", sortie.energy / 3600.0},
                       {"energy_left_wh", sortie.energy_left / 3600.0},
                       {"length_m", sortie.length},
                       {"min_clearance_m", sortie.clearance},
                       {"passage", passage_json(route, sortie)},
                       {"legs", legs_of(route, sortie)}});
  }
  return sorties;
}

Json unreached_json(const std::vector<flight::Unreached>& unreached) {
  Json list = Json::array();
  for (const flight::Unreached& missed : unreached) {
    list.push_back({{"view", missed.station.view_index}, {"reason", missed.reason}});
  }
  return list;
}

Json order_json(const flight::Route& route) {
  Json order = Json::array();
  for (const flight::Station& station : route.stations) order.push_back(station.view_index);
  return order;
}

}  // namespace skycap::missions::package
