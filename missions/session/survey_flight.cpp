#include "missions/session/survey_flight.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "flight/route/leg_planner.h"
#include "flight/route/route.h"
#include "flight/space/clearance.h"
#include "flight/space/interruptible_space.h"
#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/parallel.h"
#include "geometry/place/camera.h"
#include "geometry/place/platform.h"
#include "missions/session/way_frames.h"
#include "missions/support/number_text.h"
#include "survey/planner.h"

namespace skycap::missions::session {

using Eigen::Vector3d;

double FlownSurvey::length() const {
  double sum = 0.0;
  for (const FlownLeg& leg : legs) sum += flight::length(leg.points);
  return sum;
}

double FlownSurvey::min_clearance() const {
  return std::ranges::min_element(legs, {}, &FlownLeg::clearance)->clearance;
}

struct SurveyFlight::Impl {
  Impl(const flight::FlightOptions& options, unsigned thread_count)
      : vehicle(options.flown()),
        camera(options.capture.camera),
        measured(std::make_shared<flight::MeasuredSpace>(options.measured_space())),
        rules(options.rules()),
        known({measured.get(), &rules}),
        space(known),
        legs(space, options.budget().total(), options.route(Vector3d::Zero()).path),
        motion(options),
        mount(options.capture.mount),
        rays(options.capture.rays),
        is_crowded(!options.unknown_beside.empty()),
        frame_period(options.capture.frame_period),
        threads(thread_count) {}

  void take_in_sweep(const geometry::Scan& scan) {
    if (rays) {
      measured->insert(scan, *rays, threads);
    } else {
      measured->insert_points(scan, threads);
    }
  }

  /// Returns the pose of the vehicle at a view. Without a scanner mount, it equals the view.
  geometry::View carrier(const geometry::View& view) const {
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
  WayMotion motion;
  std::optional<geometry::ScannerMount> mount;  ///< Set for scanners.
  /// Rays of the scanner's scans if they verify free space.
  std::optional<flight::SweepRays> rays;
  /// Next to neighbouring buildings, most positions near the target are not free. Unsuccessful path
  /// searches would take long.
  bool is_crowded;
  double frame_period;
  unsigned threads;
  FlownLeg leg;  ///< Next leg for fly().
  Vector3d above_pad = Vector3d::Zero();
  std::vector<flight::PadScan> pads;
  FlownSurvey survey;
};

SurveyFlight::SurveyFlight(const flight::FlightOptions& options, const geometry::View& first_view,
                           unsigned threads)
    : impl_(std::make_unique<Impl>(options, threads)) {
  impl_->survey.pad = options.pad(first_view.position);
  const Vector3d home = impl_->survey.pad + Vector3d(0.0, 0.0, options.climb());
  impl_->above_pad = home;
  if (impl_->mount) {
    impl_->legs.require_returns(planning_law(options.route(impl_->survey.pad), home.z()), home);
  }
  const auto refuse = [&](const std::string& place, const Vector3d& at, const std::string& cure) {
    const double clearance = impl_->legs.clearance();
    const flight::Closest closest = impl_->space.closest({at, at}, clearance + 1e-3);
    const std::string why = closest.distance < clearance
                                ? "is " + support::short_text(closest.distance) + " m from " +
                                      impl_->space.name(closest)
                                : "cannot be reached through free space";
    throw Error(ErrorKind::bad_config,
                place + " at (" + support::short_text(at.x()) + ", " + support::short_text(at.y()) +
                    ", " + support::short_text(at.z()) + ") " + why + ", with a clearance of " +
                    support::short_text(clearance) + " m; " + cure);
  };
  if (!impl_->space.is_free({home, home}, impl_->legs.clearance())) {
    refuse("the point above the take-off point", home,
           "move flight.takeoff, raise flight.takeoff_climb, or shrink flight.unknown_box");
  }
  flight::check_grounds(options.grounds(impl_->survey.pad, {}), options.ground_limits());
  for (const Vector3d& place : options.landings(impl_->survey.pad)) {
    impl_->pads.emplace_back(place, options.pad_radius());
  }
  if (!can_reach(home, first_view)) {
    refuse("the first view", first_view.position,
           "set another start.position (or seed), within the gimbal's limits and outside "
           "flight.unknown_box");
  }
}

SurveyFlight::~SurveyFlight() = default;

bool SurveyFlight::may_be_at(const Vector3d& place) const try {
  if (impl_->is_crowded && !impl_->space.is_free({place, place}, impl_->legs.clearance())) {
    return false;
  }
  return !impl_->legs.returns() || impl_->legs.returns()->why_none(place).empty();
} catch (const Interrupted&) {
  throw survey::Interrupted();
}

bool SurveyFlight::can_reach(const Vector3d& from, const geometry::View& to) try {
  if (flight::can_look(impl_->vehicle, impl_->carrier(to))) {
    if (auto leg = impl_->legs.leg(from, to.position)) {
      impl_->leg = {std::move(leg->points), leg->clearance};
      return true;
    }
  }
  ++impl_->survey.refused;
  return false;
} catch (const Interrupted&) {
  throw survey::Interrupted();
}

void SurveyFlight::stop_on(std::stop_token stop) { impl_->space.stop_on(std::move(stop)); }

const FlownLeg& SurveyFlight::way() const { return impl_->leg; }

std::vector<ViewInFlight> SurveyFlight::frames(const geometry::View& from,
                                               const geometry::View& to) const {
  std::vector<ViewInFlight> frames = impl_->motion.frames(impl_->leg, impl_->carrier(from),
                                                          impl_->carrier(to), impl_->frame_period);
  if (!impl_->mount) return frames;
  for (ViewInFlight& frame : frames) frame.view = geometry::scanner_view(*impl_->mount, frame.view);
  return frames;
}

double SurveyFlight::time(const geometry::View& from, const geometry::View& to) const {
  return impl_->motion.time(impl_->leg, impl_->carrier(from), impl_->carrier(to)) +
         impl_->motion.rest();
}

std::optional<FlownLeg> SurveyFlight::find_way(const Vector3d& from, const Vector3d& to) {
  auto leg = impl_->legs.verified(impl_->legs.path(from, to).points);
  if (!leg) return std::nullopt;
  return FlownLeg{std::move(leg->points), leg->clearance};
}

const Vector3d& SurveyFlight::pad() const { return impl_->survey.pad; }

const Vector3d& SurveyFlight::above_pad() const { return impl_->above_pad; }

std::size_t SurveyFlight::refused() const { return impl_->survey.refused; }

void SurveyFlight::take_way(FlownLeg way, std::size_t refused) {
  impl_->leg = std::move(way);
  impl_->survey.refused = refused;
}

void SurveyFlight::fly() { impl_->survey.legs.push_back(std::move(impl_->leg)); }

void SurveyFlight::take_in(const geometry::Scan& scan) {
  geometry::parallel_for(2, impl_->threads, [&](std::size_t part) {
    if (part == 0) {
      if (impl_->mount) {
        impl_->take_in_sweep(scan);
      } else {
        impl_->measured->insert(scan, impl_->camera, impl_->threads);
      }
    } else {
      for (flight::PadScan& pad : impl_->pads) pad.take_in(scan.points);
    }
  });
  impl_->legs.forget();
}

FlownSurvey SurveyFlight::finish(const std::vector<geometry::View>& views) {
  // Removes the path to a discarded scan after planning was interrupted.
  if (impl_->survey.legs.size() > views.size()) impl_->survey.legs.resize(views.size());
  std::vector<geometry::View> carriers;
  carriers.reserve(views.size());
  for (const geometry::View& view : views) carriers.push_back(impl_->carrier(view));
  impl_->survey.times = impl_->motion.survey_times(impl_->survey.legs, carriers);
  impl_->survey.measured = std::move(impl_->measured);
  for (const flight::PadScan& pad : impl_->pads) {
    if (const auto ground = pad.ground()) impl_->survey.grounds.push_back(*ground);
  }
  return std::move(impl_->survey);
}

}  // namespace skycap::missions::session
