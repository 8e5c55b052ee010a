/// Route planning: verified legs, times, energy and sorties for given views. Also checks routes
/// from other sources.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/motion/fly_through.h"
#include "flight/motion/motion.h"
#include "flight/motion/photo_speed.h"
#include "flight/motion/smoothing.h"
#include "flight/motion/vehicle.h"
#include "flight/paths/path.h"
#include "flight/route/landing_surface.h"
#include "flight/rtl/min_return_altitude.h"
#include "geometry/pose/pose.h"

namespace skycap::flight {

/// Waypoint with its view and actions. The vehicle position is assumed to equal the camera
/// position.
struct CapturePoint {
  geometry::View view;
  double hold = 0.5;             ///< Rest time with the camera aimed, before the capture [s].
  int captures = 1;              ///< Number of images or scans. 0 for a waypoint without capture.
  std::uint32_t view_index = 0;  ///< Index of the view in the survey.
  double hold_after = 0.5;       ///< Rest time after the capture, for shutter and readout [s].
  /// Path that the survey flew to this waypoint from the previous one, or from above the pad. Empty
  /// if it was not flown.
  std::vector<Eigen::Vector3d> approach_path{};
  /// The vehicle passes without a stop, except at the ends of sorties. Such a route is continuous:
  /// a sortie resumes at the last capture point of the previous one.
  bool is_passed = false;
  /// Planned duration of the straight leg from the previous capture point [s]. 0: that of a leg
  /// from rest to rest.
  double leg_time = 0.0;
};

/// Returns the viewing direction of an aim (unit vector).
Eigen::Vector3d compute_direction(const Aim& aim);
/// Returns the heading of a view, clockwise from true north, in [0, 2 pi) [rad]. 0 for vertical
/// views.
double compute_yaw(const geometry::View& view);
/// Returns the pitch of a view [rad]: 0 at the horizon, -pi/2 straight down.
double compute_pitch(const geometry::View& view);
/// Returns true if the gimbal can look in the direction of the view. A tolerance covers the
/// rounding of directions at the gimbal limits.
bool can_aim(const Vehicle& vehicle, const geometry::View& view);

/// Terms of the clearance [m].
struct ClearanceBudget {
  double vehicle_radius = 0.5;
  double position_error = 0.1;  ///< Typical: 0.05 with RTK, 1.5 to 3 without.
  double tracking_error = 0.3;  ///< Maximum deviation from a leg flown with stops.
  double map_error = 0.1;       ///< Obstacle position error from noise and registration.
  double margin = 1.0;

  double total() const {
    return vehicle_radius + position_error + tracking_error + map_error + margin;
  }
  /// Throws Error{bad_config} naming the first term that is negative or not finite.
  void validate() const;
};

/// Requirements on the returns that an autopilot flies automatically.
struct ReturnOptions {
  std::vector<AutopilotType> autopilots;  ///< Autopilots whose returns must be verified.
  double max_height = 0.0;  ///< Maximum height z for the search of a return altitude [m].
  std::vector<Eigen::Vector3d> rally{};  ///< Alternative landing points on the ground.
  double braking = 0.0;                  ///< See RtlProfile::braking [m].
};

struct RouteOptions {
  ClearanceBudget clearance;
  Conditions conditions;
  PathOptions path;
  Eigen::Vector3d takeoff = Eigen::Vector3d::Zero();  ///< Take-off point (pad).
  double takeoff_climb = 5.0;  ///< Vertical climb from the pad before the first leg [m].
  std::vector<LandingSurface> landing_surfaces;  ///< Ground of pad and rally points, where known.
  PadLimits ground_limits;                       ///< Limits for that ground.
  bool order_is_free = false;                    ///< The planner may reorder the waypoints.
  FlightStyle style = FlightStyle::stop;         ///< Leg style in file formats that support curves.
  PassRules passing;                             ///< in the style that passes views
  std::optional<PhotoShutter> photo;             ///< of a mission with a photo camera
  /// Options of verified returns from every point of the route. Empty: the pilot must check
  /// returns.
  std::optional<ReturnOptions> returns;

  void validate() const;  ///< Throws Error{bad_config} naming the first value outside its interval.
};

/// Returns the law of returns to assume while a route is planned. `top` is the maximum waypoint
/// height z [m]. `options.returns` must be set.
///
/// The level flight is at the maximum return altitude, but not below `top`. An obstacle that blocks
/// it also blocks lower altitudes, except for overhangs.
RtlProfile planning_rtl_profile(const RouteOptions& options, double top);

/// Minimum stop at a corner [s]. Without a stop, autopilots cut corners, whereas verification
/// covers straight legs.
inline constexpr double corner_hold = 0.1;

/// Verified polyline between two positions, flown with a stop at every point.
struct Leg {
  std::vector<Eigen::Vector3d> points;
  double length = 0.0;
  /// Duration with stops in corners and simultaneous yaw and gimbal rotation [s].
  double duration = 0.0;
  double energy = 0.0;     ///< Electrical energy [J].
  double clearance = 0.0;  ///< Verified lower bound over the whole leg [m], see LegVerification.
  double emergency = 0.0;  ///< Emergency energy [J], see SplitProblem::Cost.
  /// Curved alternative, at least as fast and with no more energy. The values above and the sorties
  /// refer to stops, which every autopilot supports.
  std::optional<SmoothLeg> smooth;
};

/// Flight with one battery: from the pad through waypoints [first, last] of the route and back.
struct Sortie {
  std::uint32_t first = 0, last = 0;
  Leg out;                   ///< Leg from above the pad to the first waypoint.
  Leg back;                  ///< Leg from the last waypoint to above the pad.
  double duration = 0.0;     ///< Duration from take-off to landing [s].
  double energy = 0.0;       ///< Electrical energy [J].
  double energy_left = 0.0;  ///< Energy above the reserve at landing [J].
  double length = 0.0;       ///< Length including climb and descent at the pad [m].
  double clearance = 0.0;    ///< Verified lower bound over all legs [m].
  /// Fly-through alternative without stops at views, faster and with no more energy.
  std::optional<FlyThrough> fly_through;
  double passing_time = 0.0;  ///< Duration of `fly_through` from take-off to landing [s].
};

/// Waypoint that is excluded from the route, with the reason.
struct Unreached {
  CapturePoint capture_point;
  std::string reason;
};

struct Route {
  Vehicle vehicle;
  RouteOptions options;
  std::vector<CapturePoint> capture_points;  ///< Waypoints in flight order.
  std::vector<Leg> legs;                     ///< legs[i] leads from waypoint i to waypoint i + 1.
  std::vector<Sortie> sorties;
  /// Waypoints without a verified path, or beyond the battery range.
  std::vector<Unreached> unreached;
  double clearance = 0.0;  ///< Clearance at which every leg is verified [m].
  /// Minimum verified bound of all legs [m], limited to the search cap.
  double min_clearance = 0.0;
  double length = 0.0;              ///< Length of all sorties [m].
  double capture_leg_length = 0.0;  ///< Length of the legs between waypoints [m].
  /// Sum of the straight distances between consecutive waypoints [m].
  double straight_length = 0.0;
  double duration = 0.0;        ///< Duration of all sorties without battery changes [s].
  double energy = 0.0;          ///< Electrical energy of all sorties [J].
  double duration_bound = 0.0;  ///< Lower bound for every split of this order into sorties [s].
  /// Lower bound for every tour of straight lines, if the order is free [m].
  double order_bound = 0.0;
  /// Length of the chosen tour of straight lines, if the order is free [m].
  double order_length = 0.0;
  /// Verified returns, if requested and if the route has a sortie.
  std::optional<Returns> returns;
};

/// Maximum surplus of reported clearances above the required one [m]. A higher value costs
/// computing time.
inline constexpr double reported_surplus = 10.0;

/// Plans the flight through `capture_points`. Waypoints that keep the given order reuse the paths
/// of the survey. Other waypoints use the shortest path found. A waypoint without a verified path
/// is listed in Route::unreached, and the route continues from the previous one. The sources of
/// paths are PathFinder, find_path_by_sampling() and the paths of the survey. Every leg is verified
/// again in `space`.
///
/// `space` determines the free space. The climb from the pad is verified in `pad_space`, which
/// should equal `space` without the ground. If it is nullptr, the pilot must check the climb. With
/// `options.returns`, every point of the legs has a verified return. Waypoints without a return are
/// listed as unreached, too.
///
/// Throws if a validation fails. Throws Error{bad_config} if the position above the pad is not
/// free, or if no return altitude is verified for the whole route.
Route plan_route(std::vector<CapturePoint> capture_points, const Vehicle& vehicle,
                 const FreeSpace& space, const FreeSpace* pad_space, const RouteOptions& options);

/// Leg that violates the clearance.
struct Violation {
  std::size_t leg;  ///< The leg from point `leg` to point `leg + 1`.
  Closest closest;
  std::string obstacle;  ///< Name of the closest obstacle.
};

/// Proof for a leg, and the name of its closest obstacle.
struct LegCertificate {
  LegVerification verification;
  std::string obstacle;
};

/// Returns the proof of each leg of a polyline at `clearance` [m]. The bound on the clearance is
/// searched up to `cap` [m], see verify(). The result is shorter if a stop is requested. A single
/// point counts as a leg of zero length. Throws Error{bad_geometry} if a point is not finite.
std::vector<LegCertificate> verify_route(const std::vector<Eigen::Vector3d>& points,
                                         const FreeSpace& space, double clearance, double cap,
                                         const std::stop_token& stop = {});

/// Returns all legs of a polyline that cannot be verified at `clearance` [m]. Arguments and errors
/// are those of verify_route().
std::vector<Violation> check_route(const std::vector<Eigen::Vector3d>& points,
                                   const FreeSpace& space, double clearance);

/// Returns one line for the user with leg, closest position and distance.
std::string describe(const Violation& violation);

/// Returns the total duration of all sorties, with fly-through capture where the route has it [s].
double min_duration(const Route& route);

/// Returns the capture poses in flight order: at the waypoints, or on the curve for fly-through
/// capture.
std::vector<geometry::View> photo_views(const Route& route);

/// Returns all points of a sortie, including its waypoints, from above the pad and back.
std::vector<Eigen::Vector3d> sortie_points(const Route& route, const Sortie& sortie);

}  // namespace skycap::flight
