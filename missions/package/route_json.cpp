#include "missions/package/route_json.h"

#include <cstdint>

#include <nlohmann/json.hpp>

#include "missions/support/json_text.h"

namespace skycap::missions::package {
namespace {

using support::to_json;
using Json = nlohmann::ordered_json;

Json to_json(const flight::Leg& leg, const Json& from, const Json& to) {
  return {{"from", from},
          {"to", to},
          {"clearance_m", leg.clearance},
          {"duration_s", leg.duration},
          {"energy_wh", leg.energy / 3600.0},
          {"points", to_json(leg.points)}};
}

/// Returns the fly-through data of a sortie, or null for other sorties.
Json fly_through_json(const flight::Route& route, const flight::Sortie& sortie) {
  if (!sortie.fly_through) return {};
  const flight::FlyThrough& fly_through = *sortie.fly_through;
  Json views = Json::array();
  for (std::size_t i = 0; i < fly_through.views.size(); ++i) {
    const flight::PassedView& view = fly_through.views[i];
    const double speed = flight::state_at(fly_through.curve, view.moment).velocity.norm();
    views.push_back({{"view", route.capture_points[sortie.first + i].view_index},
                     {"time_s", view.moment},
                     {"position", to_json(view.position)},
                     {"speed_m_s", speed}});
  }
  return {{"duration_s", sortie.passing_time},
          {"length_m", fly_through.length + 2.0 * route.options.takeoff_climb},
          {"stops", fly_through.stops},
          {"clearance_m", fly_through.clearance},
          {"views", views}};
}

Json legs_to_json(const flight::Route& route, const flight::Sortie& sortie) {
  const auto view = [&](std::uint32_t capture_point) {
    return route.capture_points[capture_point].view_index;
  };
  Json legs = Json::array({to_json(sortie.out, {}, view(sortie.first))});
  for (std::uint32_t i = sortie.first; i < sortie.last; ++i) {
    legs.push_back(to_json(route.legs[i], view(i), view(i + 1)));
  }
  legs.push_back(to_json(sortie.back, view(sortie.last), {}));
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
                       {"waypoints", sortie_points(route, sortie).size()},
                       {"passage", fly_through_json(route, sortie)},
                       {"legs", legs_to_json(route, sortie)}});
  }
  return sorties;
}

Json unreached_json(const std::vector<flight::Unreached>& unreached) {
  Json list = Json::array();
  for (const flight::Unreached& missed : unreached) {
    list.push_back({{"view", missed.capture_point.view_index}, {"reason", missed.reason}});
  }
  return list;
}

Json order_json(const flight::Route& route) {
  Json order = Json::array();
  for (const flight::CapturePoint& capture_point : route.capture_points)
    order.push_back(capture_point.view_index);
  return order;
}

}  // namespace skycap::missions::package
