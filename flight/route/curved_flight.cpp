#include "flight/route/curved_flight.h"

#include <optional>
#include <utility>
#include <vector>

#include "flight/motion/fly_through.h"
#include "flight/motion/smoothing.h"
#include "flight/rtl/return_paths.h"

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
        smooth_leg(route_.legs[i], &route_.capture_points[i], &route_.capture_points[i + 1]);
      }
      smooth_leg(sortie.back, nullptr, nullptr);
    }
  }

  void pass_views() {
    for (Sortie& sortie : route_.sorties) {
      std::vector<Vector3d> points = sortie.out.points;
      std::vector<FlyThroughView> views;
      for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
        const geometry::View& view = route_.capture_points[i].view;
        views.push_back({points.size() - 1, {compute_yaw(view), compute_pitch(view)}});
        const Leg& leg = i < sortie.last ? route_.legs[i] : sortie.back;
        points.insert(points.end(), leg.points.begin() + 1, leg.points.end());
      }
      pass_views(sortie, points, views);
    }
  }

 private:
  double top_clearance() const { return route_.clearance + reported_surplus; }

  bool has_return_path(const Curve& curve) const {
    return !route_.returns || has_returns(space_, curve, route_.returns->rtl_profile,
                                          return_clearance(route_.clearance));
  }

  void smooth_leg(Leg& leg, const CapturePoint* from, const CapturePoint* to) {
    std::optional<SmoothLeg> curve = smooth(leg.points, space_, route_.clearance, top_clearance(),
                                            motion_, route_.options.style);
    if (!curve || !has_return_path(curve->curve)) return;
    const double arrival_time = curve->duration + motion_.vehicle().mode.settle_time;
    const double aimed = costs_.aimed_time(arrival_time, from, to);
    if (aimed > leg.duration) return;
    if (curve->energy + motion_.hover_energy(aimed - curve->duration) > leg.energy) return;
    leg.smooth = std::move(curve);
  }

  void pass_views(Sortie& sortie, const std::vector<Vector3d>& points,
                  const std::vector<FlyThroughView>& views) {
    auto fly_through = pass_through(points, views, space_, route_.clearance, top_clearance(),
                                    motion_, route_.options.passing,
                                    [&](const Curve& segment) { return has_return_path(segment); });
    if (!fly_through || !has_return_path(fly_through->curve)) return;
    const LegCost ends = in_turn(costs_.takeoff_cost(route_.options.takeoff_climb),
                                 costs_.landing_cost(route_.options.takeoff_climb));
    const double settle_time = motion_.vehicle().mode.settle_time;
    const double time = ends.time + fly_through->duration + settle_time;
    const double energy = ends.energy + fly_through->energy + motion_.hover_energy(settle_time);
    if (time >= sortie.duration || energy > sortie.energy) return;
    sortie.passing_time = time;
    sortie.fly_through = std::move(fly_through);
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

double min_duration(const Route& route) {
  double duration = route.duration;
  for (const Sortie& sortie : route.sorties) {
    if (sortie.fly_through) duration -= sortie.duration - sortie.passing_time;
  }
  return duration;
}

std::vector<geometry::View> photo_views(const Route& route) {
  std::vector<geometry::View> views;
  for (const Sortie& sortie : route.sorties) {
    for (std::uint32_t i = sortie.first; i <= sortie.last; ++i) {
      views.push_back(route.capture_points[i].view);
      if (!sortie.fly_through) continue;
      views.back().position = sortie.fly_through->views[i - sortie.first].position;
    }
  }
  return views;
}

}  // namespace skycap::flight
