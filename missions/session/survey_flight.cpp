#include "missions/session/survey_flight.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "flight/clearance/clearance.h"
#include "flight/clearance/interruptible_space.h"
#include "flight/route/leg_planner.h"
#include "flight/route/route.h"
#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/parallel.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/platform.h"
#include "missions/session/en_route_frames.h"
#include "missions/support/number_text.h"
#include "survey/planner.h"

namespace skycap::missions::session {

using Eigen::Vector3d;

double FlightRecord::length() const {
  double sum = 0.0;
  for (const ExecutedLeg& leg : legs) sum += flight::length(leg.points);
  return sum;
}

double FlightRecord::min_clearance() const {
  return std::ranges::min_element(legs, {}, &ExecutedLeg::clearance)->clearance;
}

struct SurveyFlight::Impl {
  Impl(const flight::FlightOptions& options, unsigned thread_count)
      : vehicle(options.required_vehicle()),
        camera(options.capture.camera),
        measured(std::make_shared<flight::MeasuredSpace>(options.measured_space())),
        rules(options.rules()),
        known({measured.get(), &rules}),
        space(known),
        legs(space, options.budget().total(), options.route(Vector3d::Zero()).path),
        motion(options),
        mount(options.capture.mount),
        rays(options.capture.rays),
        is_crowded(!options.extra_unknown_boxes.empty()),
        frame_period(options.capture.frame_period),
        threads(thread_count) {}

  void add_sweep(const geometry::Scan& scan) {
    if (rays) {
      measured->insert(scan, *rays, threads);
    } else {
      measured->insert_points(scan, threads);
    }
  }

  /// Returns the pose of the vehicle at a view. Without a scanner mount, it equals the view.
  geometry::View platform(const geometry::View& view) const {
    return mount ? geometry::nose_view(*mount, view) : view;
  }

  flight::Vehicle vehicle;
  geometry::Camera camera;
  std::shared_ptr<flight::MeasuredSpace> measured;
  flight::KnownSpace rules;
  flight::JointSpace known;
  flight::InterruptibleSpace space;
  /// Requires returns if autopilots may return from the paths automatically.
  flight::LegPlanner legs;
  LegMotion motion;
  std::optional<geometry::ScannerMount> mount;  ///< Set for scanners.
  /// Rays of the scanner's scans if they verify free space.
  std::optional<flight::SweepRays> rays;
  /// Next to neighbouring buildings, most positions near the target are not free. Unsuccessful path
  /// searches would take long.
  bool is_crowded;
  double frame_period;
  unsigned threads;
  ExecutedLeg leg;  ///< Next leg for fly().
  Vector3d above_pad = Vector3d::Zero();
  std::vector<flight::PadScan> pads;
  FlightRecord survey;
};

SurveyFlight::SurveyFlight(const flight::FlightOptions& options, const geometry::View& first_view,
                           unsigned threads)
    : impl_(std::make_unique<Impl>(options, threads)) {
  impl_->survey.pad = options.pad(first_view.position);
  const Vector3d home = impl_->survey.pad + Vector3d(0.0, 0.0, options.climb());
  impl_->above_pad = home;
  if (impl_->mount) {
    impl_->legs.require_returns(planning_rtl_profile(options.route(impl_->survey.pad), home.z()),
                                home);
  }
  const auto reject = [&](const std::string& location, const Vector3d& at,
                          const std::string& cure) {
    const double clearance = impl_->legs.clearance();
    const flight::Closest closest = impl_->space.closest({at, at}, clearance + 1e-3);
    const std::string reason = closest.distance < clearance
                                   ? "is " + support::short_text(closest.distance) + " m from " +
                                         impl_->space.name(closest)
                                   : "cannot be reached through free space";
    throw Error(ErrorKind::bad_config, location + " at (" + support::short_text(at.x()) + ", " +
                                           support::short_text(at.y()) + ", " +
                                           support::short_text(at.z()) + ") " + reason +
                                           ", with a clearance of " +
                                           support::short_text(clearance) + " m; " + cure);
  };
  if (!impl_->space.is_free({home, home}, impl_->legs.clearance())) {
    reject("the end of the take-off climb", home,
           "move flight.takeoff, raise flight.takeoff_climb, or shrink flight.unknown_box");
  }
  flight::check_landing_surfaces(options.landing_surfaces(impl_->survey.pad, {}),
                                 options.ground_limits());
  for (const Vector3d& location : options.landings(impl_->survey.pad)) {
    impl_->pads.emplace_back(location, options.pad_radius());
  }
  if (!can_reach(home, first_view)) {
    reject("the first view", first_view.position,
           "set another start.position (or seed) within the gimbal limits and outside "
           "flight.unknown_box");
  }
}

SurveyFlight::~SurveyFlight() = default;

bool SurveyFlight::may_be_at(const Vector3d& location) const try {
  if (impl_->is_crowded && !impl_->space.is_free({location, location}, impl_->legs.clearance())) {
    return false;
  }
  return !impl_->legs.returns() || !impl_->legs.returns()->no_return_reason(location);
} catch (const Interrupted&) {
  throw survey::Interrupted();
}

bool SurveyFlight::can_reach(const Vector3d& from, const geometry::View& to) try {
  if (flight::can_aim(impl_->vehicle, impl_->platform(to))) {
    if (auto leg = impl_->legs.leg(from, to.position)) {
      impl_->leg = {std::move(leg->points), leg->clearance};
      return true;
    }
  }
  ++impl_->survey.rejected;
  return false;
} catch (const Interrupted&) {
  throw survey::Interrupted();
}

void SurveyFlight::stop_on(std::stop_token stop) { impl_->space.stop_on(std::move(stop)); }

const ExecutedLeg& SurveyFlight::path() const { return impl_->leg; }

std::vector<ViewInFlight> SurveyFlight::frames(const geometry::View& from,
                                               const geometry::View& to) const {
  std::vector<ViewInFlight> frames = impl_->motion.frames(impl_->leg, impl_->platform(from),
                                                          impl_->platform(to), impl_->frame_period);
  if (!impl_->mount) return frames;
  for (ViewInFlight& frame : frames) frame.view = geometry::scanner_view(*impl_->mount, frame.view);
  return frames;
}

double SurveyFlight::time(const geometry::View& from, const geometry::View& to) const {
  return impl_->motion.time(impl_->leg, impl_->platform(from), impl_->platform(to)) +
         impl_->motion.rest();
}

std::optional<ExecutedLeg> SurveyFlight::find_path(const Vector3d& from, const Vector3d& to) {
  auto leg = impl_->legs.verified(impl_->legs.path(from, to).points);
  if (!leg) return std::nullopt;
  return ExecutedLeg{std::move(leg->points), leg->clearance};
}

const Vector3d& SurveyFlight::pad() const { return impl_->survey.pad; }

const Vector3d& SurveyFlight::above_pad() const { return impl_->above_pad; }

std::size_t SurveyFlight::rejected() const { return impl_->survey.rejected; }

void SurveyFlight::add_leg(ExecutedLeg path, std::size_t rejected) {
  impl_->leg = std::move(path);
  impl_->survey.rejected = rejected;
}

void SurveyFlight::fly() { impl_->survey.legs.push_back(std::move(impl_->leg)); }

void SurveyFlight::add_scan(const geometry::Scan& scan) {
  geometry::parallel_for(2, impl_->threads, [&](std::size_t part) {
    if (part == 0) {
      if (impl_->mount) {
        impl_->add_sweep(scan);
      } else {
        impl_->measured->insert(scan, impl_->camera, impl_->threads);
      }
    } else {
      for (flight::PadScan& pad : impl_->pads) pad.add_points(scan.points);
    }
  });
  impl_->legs.forget();
}

FlightRecord SurveyFlight::finish(const std::vector<geometry::View>& views) {
  // Removes the path to a discarded scan after planning was interrupted.
  if (impl_->survey.legs.size() > views.size()) impl_->survey.legs.resize(views.size());
  std::vector<geometry::View> platform_views;
  platform_views.reserve(views.size());
  for (const geometry::View& view : views) platform_views.push_back(impl_->platform(view));
  impl_->survey.times = impl_->motion.survey_times(impl_->survey.legs, platform_views);
  impl_->survey.measured = std::move(impl_->measured);
  for (const flight::PadScan& pad : impl_->pads) {
    if (const auto ground = pad.ground()) impl_->survey.landing_surfaces.push_back(*ground);
  }
  return std::move(impl_->survey);
}

}  // namespace skycap::missions::session
