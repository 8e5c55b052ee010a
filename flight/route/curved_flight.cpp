#include "flight/route/curved_flight.h"

#include <optional>
#include <utility>
#include <vector>

#include "flight/motion/passage.h"
#include "flight/motion/smoothing.h"
#include "flight/way_home/ways_home.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

class Curves {
 public:
  Curves(Route& route, const FreeSpace& space, const Motion& motion, const LegCosts& costs)
      : route_(route), space_(space), motion_(motion), costs_(costs) {}

  void smooth_legs() {
    for (Sortie& sortie : route_.sorties) {
      smooth_leg(sortie.out, nullptr, nullptr);
      for (std::uint32_t i = sortie.first; i < sortie.last; ++i) {
        smooth_leg(route_.legs[i], &route_.stations[i], &route_.stations[i + 1]);
      }
      smooth_leg(sortie.back, nullptr, nullptr);
    }
  }

  void pass_views() {
    for (Sortie& sortie : route_.sorties) {
      std::vector<Vector3d> points = sortie.out.points;
      std::vector<ViewOnWay> views;
      for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
        const geometry::View& view = route_.stations[i].view;
        views.push_back({points.size() - 1, {yaw_of(view), pitch_of(view)}});
        const Leg& leg = i < sortie.last ? route_.legs[i] : sortie.back;
        points.insert(points.end(), leg.points.begin() + 1, leg.points.end());
      }
      pass_views(sortie, points, views);
    }
  }

 private:
  double top_clearance() const { return route_.clearance + reported_surplus; }

  bool has_way_home(const Curve& curve) const {
    return !route_.returns ||
           has_returns(space_, curve, route_.returns->law, return_clearance(route_.clearance));
  }

  void smooth_leg(Leg& leg, const Station* from, const Station* to) {
    std::optional<SmoothLeg> curve = smooth(leg.points, space_, route_.clearance, top_clearance(),
                                            motion_, route_.options.style);
    if (!curve || !has_way_home(curve->curve)) return;
    const double in_place = curve->duration + motion_.vehicle().mode.settle_time;
    const double aimed = costs_.aimed_time(in_place, from, to);
    if (aimed > leg.duration) return;
    if (curve->energy + motion_.hover_energy(aimed - curve->duration) > leg.energy) return;
    leg.smooth = std::move(curve);
  }

  void pass_views(Sortie& sortie, const std::vector<Vector3d>& points,
                  const std::vector<ViewOnWay>& views) {
    auto passage = pass_through(points, views, space_, route_.clearance, top_clearance(), motion_,
                                route_.options.passing,
                                [&](const Curve& piece) { return has_way_home(piece); });
    if (!passage || !has_way_home(passage->curve)) return;
    const LegCost ends = in_turn(costs_.takeoff_cost(route_.options.takeoff_climb),
                                 costs_.landing_cost(route_.options.takeoff_climb));
    const double settle_time = motion_.vehicle().mode.settle_time;
    const double time = ends.time + passage->duration + settle_time;
    const double energy = ends.energy + passage->energy + motion_.hover_energy(settle_time);
    if (time >= sortie.duration || energy > sortie.energy) return;
    sortie.passing_time = time;
    sortie.passage = std::move(passage);
  }

  Route& route_;
  const FreeSpace& space_;
  const Motion& motion_;
  const LegCosts& costs_;
};

}  // namespace

void add_curves(Route& route, const FreeSpace& space, const Motion& motion, const LegCosts& costs) {
  Curves curves(route, space, motion, costs);
  if (route.options.style == FlightStyle::pass) {
    curves.pass_views();
  } else {
    curves.smooth_legs();
  }
}

double least_duration(const Route& route) {
  double duration = route.duration;
  for (const Sortie& sortie : route.sorties) {
    if (sortie.passage) duration -= sortie.duration - sortie.passing_time;
  }
  return duration;
}

std::vector<geometry::View> picture_views(const Route& route) {
  std::vector<geometry::View> views;
  for (const Sortie& sortie : route.sorties) {
    for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
      views.push_back(route.stations[i].view);
      if (!sortie.passage) continue;
      views.back().position = sortie.passage->views[i - sortie.first].position;
    }
  }
  return views;
}

}  // namespace skycap::flight
