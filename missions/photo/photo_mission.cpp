#include "missions/photo/photo_mission.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "flight/export/flight_plan.h"
#include "flight/motion/motion.h"
#include "flight/route/tour.h"
#include "geometry/error.h"
#include "missions/config/mission_document.h"
#include "missions/wizard/takeoff_point.h"

namespace skycap::missions::photo {
namespace {

using Eigen::Vector3d;
using geometry::View;

/// Returns the time from one photo to the next, including the stop [s].
double time_between(const flight::Motion& motion, double rest, const View& from, const View& to) {
  const double yaw =
      std::remainder(flight::compute_yaw(to) - flight::compute_yaw(from), 2.0 * std::numbers::pi);
  const double pitch = flight::compute_pitch(to) - flight::compute_pitch(from);
  return motion.aimed_time(motion.leg_time(to.position - from.position), yaw, pitch) + rest;
}

PhotoTour compute_tour(const flight::FlightOptions& options, const std::vector<View>& views) {
  PhotoTour tour;
  if (views.size() < 2) return tour;
  const flight::Tour found = flight::plan_tour(
      static_cast<std::uint32_t>(views.size()),
      [&](auto a, auto b) { return (views[a].position - views[b].position).norm(); });
  tour.length = found.cost;
  if (!options.has_vehicle()) return tour;
  const flight::Motion motion(options.required_vehicle(),
                              options.route(Vector3d::Zero()).conditions);
  const double rest = options.rest_before() + options.rest_after();
  std::uint32_t last = 0;
  for (const std::uint32_t next : found.order) {
    tour.duration += time_between(motion, rest, views[last], views[next]);
    last = next;
  }
  tour.duration += time_between(motion, rest, views[last], views[0]);
  return tour;
}

/// Returns the completeness over the duration of tours through the first photos, at up to 12
/// numbers of photos.
std::vector<TimeCurvePoint> make_time_curve(const flight::FlightOptions& options,
                                            const survey::photo::PhotoPlanResult& result) {
  constexpr std::size_t max_points = 12;
  std::vector<TimeCurvePoint> curve;
  const std::size_t photos = std::min(result.views.size(), result.curve.size());
  const std::size_t points = std::min(max_points, photos);
  for (std::size_t i = 1; i <= points; ++i) {
    const std::size_t count = i * photos / points;
    const std::vector<View> first(result.views.begin(),
                                  result.views.begin() + static_cast<std::ptrdiff_t>(count));
    curve.push_back({count, result.curve[count - 1].completeness, compute_tour(options, first)});
  }
  return curve;
}

/// Space for photos, without the positions that no route reaches.
survey::photo::FreePosition less_unreached(const PhotoAirspace& airspace,
                                           const std::vector<Vector3d>& unreached, double near) {
  return [&airspace, unreached, near](const Vector3d& position) {
    return std::ranges::none_of(
               unreached, [&](const Vector3d& at) { return (at - position).norm() < near; }) &&
           airspace.is_free(position);
  };
}

std::string name_of_photo(std::size_t number) { return fmt::format("photo_{:04}", number + 1); }

/// Returns a photo with its figures from the plan.
survey::photo::PlannedPhoto make_photo(const survey::photo::PhotoPlanResult& result,
                                       std::size_t view, std::size_t number) {
  survey::photo::PlannedPhoto photo;
  photo.name = name_of_photo(number);
  photo.view = result.views[view];
  photo.yaw = flight::compute_yaw(photo.view);
  photo.pitch = flight::compute_pitch(photo.view);
  photo.gsd = result.gsd[view];
  photo.observed = result.observed[view];
  return photo;
}

/// Returns the photos of a route in flight order, with their times.
std::vector<survey::photo::PlannedPhoto> flown_photos(const config::MissionSetup& setup,
                                                      const PhotoMission& mission) {
  const flight::FlightOptions& options = setup.flight();
  const flight::Route& route = mission.flight->route;
  std::vector<survey::photo::PlannedPhoto> photos;
  for (std::size_t sortie = 0; sortie < route.sorties.size(); ++sortie) {
    const flight::FlightPlan plan = flight_plan(route, sortie, setup.name, options.site);
    const std::vector<flight::StopTime> times = stop_times(plan);
    for (std::size_t i = 0; i < plan.waypoints.size(); ++i) {
      const flight::Waypoint& waypoint = plan.waypoints[i];
      if (!waypoint.is_capture_point || waypoint.captures == 0) continue;
      photos.push_back(make_photo(mission.result, waypoint.view_index, photos.size()));
      photos.back().time = times[i].capture;
      photos.back().sortie = static_cast<std::uint32_t>(sortie);
    }
  }
  return photos;
}

/// Returns the photos of a plan without a vehicle, along a short tour.
std::vector<survey::photo::PlannedPhoto> toured_photos(
    const survey::photo::PhotoPlanResult& result) {
  std::vector<std::uint32_t> order;
  if (result.views.size() > 1) {
    order = flight::plan_tour(static_cast<std::uint32_t>(result.views.size()), [&](auto a, auto b) {
              return (result.views[a].position - result.views[b].position).norm();
            }).order;
  }
  if (!result.views.empty()) order.insert(order.begin(), 0);
  std::vector<survey::photo::PlannedPhoto> photos;
  for (const std::uint32_t view : order) photos.push_back(make_photo(result, view, photos.size()));
  return photos;
}

/// Returns result.matching_pairs with indices of plan.photos instead of result.views.
std::vector<survey::photo::PhotoPair> pairs_in_flight_order(const PhotoMission& mission) {
  const std::vector<View>& views = mission.result.views;
  std::vector<std::optional<std::uint32_t>> photo_of_view(views.size());
  for (std::uint32_t i = 0; i < mission.plan.photos.size(); ++i) {
    const View& own = mission.plan.photos[i].view;
    const auto view = std::ranges::find_if(views, [&](const View& other) {
      return other.position == own.position && other.direction == own.direction;
    });
    if (view != views.end()) photo_of_view[static_cast<std::size_t>(view - views.begin())] = i;
  }
  std::vector<survey::photo::PhotoPair> pairs;
  for (survey::photo::PhotoPair pair : mission.result.matching_pairs) {
    const auto first = photo_of_view[pair.first], second = photo_of_view[pair.second];
    if (!first || !second) continue;
    pair.first = std::min(*first, *second);
    pair.second = std::max(*first, *second);
    pairs.push_back(pair);
  }
  return pairs;
}

void plan_route(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                const std::stop_token& stop, PhotoMission& mission) {
  const flight::FlightOptions& options = setup.flight();
  const std::vector<View>& views = mission.result.views;
  if (views.empty()) return;
  mission.flight.emplace();
  mission.flight->image_motion = options.image_motion_bounds();
  mission.pad = wizard::choose_takeoff(options, views);
  const std::vector<package::Polyline> paths(views.size());
  mission.flight->route =
      package::plan_flight(options, airspace.measured(), mission.pad, views, paths, {}, stop);
}

/// Returns the maximum number of photos, most useful first, in a tour within the available time.
std::size_t photos_within(const flight::FlightOptions& options, const std::vector<View>& views,
                          double seconds) {
  std::size_t enough = views.size() + 1, fits = 0;
  while (enough - fits > 1) {
    const std::size_t middle = fits + (enough - fits) / 2;
    const std::vector<View> first(views.begin(),
                                  views.begin() + static_cast<std::ptrdiff_t>(middle));
    (compute_tour(options, first).duration <= seconds ? fits : enough) = middle;
  }
  return fits;
}

/// Returns the plan, with fewer photos if limits.max_minutes requires it.
survey::photo::PhotoPlanResult plan_within_limits(const config::MissionSetup& setup,
                                                  survey::photo::PhotoPlanOptions options,
                                                  const survey::photo::PhotoSite& site,
                                                  const survey::photo::PhotoPlanRun& run) {
  survey::photo::PhotoPlanResult result = survey::photo::plan_photos(options, site, run);
  const std::optional<double> max_time = setup.survey().limits.max_time;
  if (!max_time || !setup.flight().has_vehicle() || options.flown_pattern) return result;
  const std::size_t photos = photos_within(setup.flight(), result.views, *max_time);
  if (photos >= result.views.size()) return result;
  options.max_photos = std::max<std::size_t>(photos, 1);
  return survey::photo::plan_photos(options, site, run);
}

/// Warns of a target in the air or under the ground, which indicates a wrong vertical datum.
void warn_about_height(const survey::photo::PhotoSite& site, PhotoMission& mission) {
  constexpr double much = 10.0;
  const Eigen::AlignedBox3d box = geometry::bounding_box(site.target);
  const double above = box.min().z() - site.foot;
  if (above < much && box.max().z() > site.foot) return;
  mission.warnings.push_back(
      fmt::format("the base of the target is {:.1f} m {} the ground; check the keys vertical and "
                  "offset of the prior data",
                  std::abs(above), above > 0.0 ? "above" : "below"));
}

void add_warnings(const config::MissionSetup& setup, PhotoMission& mission) {
  const config::MissionDocument& document = *setup.document;
  if (document.flight.free_space == config::FreeSpaceRule::assumed &&
      setup.flight().has_vehicle()) {
    mission.warnings.emplace_back(assumed_space_warning);
  }
  for (const std::string& warning : mission.result.warnings) mission.warnings.push_back(warning);
  if (!mission.flight) return;
  if (!setup.flight().takeoff) {
    mission.warnings.push_back(fmt::format(
        "flight.takeoff is not set: the plan uses the take-off point ({:g}, {:g}, {:g}), chosen so "
        "that the photos have verified returns. Inspect it and set flight.takeoff",
        mission.pad.x(), mission.pad.y(), mission.pad.z()));
  }
  const auto& unreached = mission.flight->route.unreached;
  if (!unreached.empty()) {
    mission.warnings.push_back(
        fmt::format("{} of {} photos are not part of the flight but are included in the figures; "
                    "reason for the first: {}",
                    unreached.size(), mission.result.views.size(), unreached.front().reason));
  }
  if (const auto limit = setup.survey().limits.max_time;
      limit && mission.flight->route.duration > *limit) {
    mission.warnings.push_back(
        fmt::format("the flight takes {:.1f} min, more than limits.max_minutes ({:.1f} min), which "
                    "limits only the tour between photos; lower photo.max_photos",
                    mission.flight->route.duration / 60.0, *limit / 60.0));
  }
  if (document.photo.poses == survey::photo::PosesGiven::known &&
      setup.flight().position_error > 0.3) {
    mission.warnings.push_back(
        fmt::format("the photo positions have an error of up to {:.1f} m (flight.position_error); "
                    "use RTK or PPK, "
                    "or set photo.poses: unknown and photo.min_partners: 4",
                    setup.flight().position_error));
  }
}

}  // namespace

PhotoMission plan_photo_mission(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                                const std::stop_token& stop,
                                const std::function<void(const std::string&)>& report) {
  const config::PhotoSetup photo = config::photo_setup(*setup.document);
  survey::photo::PhotoSite site = photo_site(setup, airspace);
  const survey::photo::PhotoPlanRun run{setup.run.seed, setup.run.threads, stop, report};
  const double near = 0.05 * setup.survey().planner.view_distance;
  constexpr int max_rounds = 3;

  PhotoMission mission;
  std::vector<Vector3d> unreached;
  for (int round = 1; round <= max_rounds; ++round) {
    site.space.is_free = less_unreached(airspace, unreached, near);
    mission.result = plan_within_limits(setup, photo.options, site, run);
    if (!setup.flight().has_vehicle()) break;
    report("verifying the route");
    plan_route(setup, airspace, stop, mission);
    if (!mission.flight || mission.flight->route.unreached.empty()) break;
    for (const flight::Unreached& missed : mission.flight->route.unreached) {
      unreached.push_back(missed.capture_point.view.position);
    }
  }
  if (mission.flight && mission.flight->route.capture_points.empty()) {
    throw Error(ErrorKind::bad_config, "no photo can be part of the flight; photo 1: " +
                                           mission.flight->route.unreached.front().reason);
  }
  report("comparing patterns");
  mission.tour = compute_tour(setup.flight(), mission.result.views);
  mission.time_curve = make_time_curve(setup.flight(), mission.result);
  for (const survey::photo::PatternResult& pattern : mission.result.patterns) {
    mission.patterns.push_back({compute_tour(setup.flight(), pattern.views),
                                compute_tour(setup.flight(), pattern.pruned_views)});
  }
  mission.plan.camera = photo.options.camera;
  mission.plan.gsd = photo.options.gsd;
  mission.plan.view_distance = mission.result.view_distance;
  mission.plan.photos =
      mission.flight ? flown_photos(setup, mission) : toured_photos(mission.result);
  mission.pairs = pairs_in_flight_order(mission);
  add_warnings(setup, mission);
  warn_about_height(site, mission);
  return mission;
}

}  // namespace skycap::missions::photo
