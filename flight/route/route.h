/// From views to a route that can be flown: certified legs, times, energy, sorties. And the check
/// of a route that somebody else made.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "flight/motion/passage.h"
#include "flight/motion/smoothing.h"
#include "flight/motion/vehicle.h"
#include "flight/paths/path.h"
#include "flight/route/pad_ground.h"
#include "flight/space/clearance.h"
#include "flight/way_home/least_return.h"
#include "geometry/place/pose.h"

namespace skycap::flight {

/// A view and what to do there. The vehicle's position is taken to be the camera's.
struct Station {
  geometry::View view;
  double hold = 0.5;             ///< at rest and aimed before the capture [s]
  int shots = 1;                 ///< images or scans to take; none at a mere waypoint
  std::uint32_t view_index = 0;  ///< which of the survey's views it is
  double hold_after = 0.5;       ///< at rest after the capture, for shutter and readout [s]
  /// How the survey came here from the station given before, or from above the pad; empty if
  /// nobody flew it.
  std::vector<Eigen::Vector3d> way{};
};

/// The direction (unit) of a camera that looks so.
Eigen::Vector3d direction_of(const Aim& aim);
/// Heading of a view, clockwise from true north, in [0, 2 pi). Straight up or down: north.
double yaw_of(const geometry::View& view);
/// Pitch of a view, 0 at the horizon, -pi/2 straight down.
double pitch_of(const geometry::View& view);
/// Whether the vehicle's gimbal can look that way, but for the rounding of directions that are
/// meant to be at its limits.
bool can_look(const Vehicle& vehicle, const geometry::View& view);

/// What the clearance has to cover, term by term [m].
struct ClearanceBudget {
  double vehicle_radius = 0.5;
  double position_error = 0.1;  ///< 0.05 with RTK, 1.5 to 3 without
  double tracking_error = 0.3;  ///< how far the vehicle strays from a leg with stops
  double map_error = 0.1;       ///< of the obstacles: noise, registration
  double margin = 1.0;

  double total() const {
    return vehicle_radius + position_error + tracking_error + map_error + margin;
  }
  /// Throws Error{bad_config} naming the first term that is negative or not finite.
  void validate() const;
};

/// What is asked of the ways home that an autopilot flies by itself.
struct ReturnOptions {
  std::vector<Dialect> dialects;         ///< whose ways home are to be proven
  double highest = 0.0;                  ///< z up to which a height of return is looked for
  std::vector<Eigen::Vector3d> rally{};  ///< where they may land beside the pad, on the ground
};

struct RouteOptions {
  ClearanceBudget clearance;
  Conditions conditions;
  PathOptions path;
  Eigen::Vector3d takeoff = Eigen::Vector3d::Zero();  ///< the pad
  double takeoff_climb = 5.0;             ///< straight up from the pad before the first leg [m]
  std::vector<PadGround> grounds;         ///< of pad and rally points, where they are known
  PadLimits ground_limits;                ///< what they may be
  bool order_is_free = false;             ///< stations may be visited in a better order than given
  FlightStyle style = FlightStyle::stop;  ///< of files that can hold curves
  PassRules passing;                      ///< in the style that passes views
  /// From every point of the route there is a proven way home; without: the pilot answers for that.
  std::optional<ReturnOptions> returns;

  void validate() const;  ///< throws Error{bad_config} naming the first value that is out of place
};

/// How vehicles come home from a route that is being planned, whose stations are up to `top` high
/// (z): at the greatest height that may be chosen, above most of what is in the way, so that what
/// is left in the way is so at other heights too, but for overhangs; and at the stations' own,
/// which no height of return is below. `options.returns` is asked for.
ReturnLaw planning_law(const RouteOptions& options, double top);

/// The shortest stop at a corner [s]: without a stop autopilots cut corners, and the certificate is
/// about straight legs.
inline constexpr double corner_hold = 0.1;

/// A certified polyline between two places, flown with a stop at every point.
struct Leg {
  std::vector<Eigen::Vector3d> points;
  double length = 0.0;
  double duration = 0.0;   ///< with stops in corners, and yaw and gimbal turning meanwhile [s]
  double energy = 0.0;     ///< [J]
  double clearance = 0.0;  ///< proven lower bound over the whole leg, see LegProof
  double emergency = 0.0;  ///< see SplitProblem::Cost [J]
  /// Another way to fly it, at least as fast and for no more energy. The figures above and the
  /// sorties are about stops, which any autopilot can be told to make.
  std::optional<SmoothLeg> smooth;
};

/// One battery: from the pad, through stations [first, last] of the route, and back.
struct Sortie {
  std::uint32_t first = 0, last = 0;
  Leg out;                   ///< from above the pad to the first station
  Leg back;                  ///< from the last station to above the pad
  double duration = 0.0;     ///< from take-off to landing [s]
  double energy = 0.0;       ///< [J]
  double energy_left = 0.0;  ///< above the reserve, at landing [J]
  double length = 0.0;       ///< climb and descent at the pad included
  double clearance = 0.0;    ///< proven lower bound of all its legs
  /// Another way to fly it, faster and for no more energy: past its views instead of stopping.
  std::optional<Passage> passage;
  double passing_time = 0.0;  ///< with that, from take-off to landing [s]
};

/// A station that is not in the route, and why.
struct Unreached {
  Station station;
  std::string reason;
};

struct Route {
  Vehicle vehicle;
  RouteOptions options;
  std::vector<Station> stations;  ///< in the order flown
  std::vector<Leg> legs;          ///< legs[i] leads from station i to station i + 1
  std::vector<Sortie> sorties;
  std::vector<Unreached> unreached;  ///< not safely reachable, or beyond what a battery allows
  double clearance = 0.0;            ///< that every leg is certified at [m]
  double min_clearance = 0.0;    ///< least proven bound of all legs [m]; the cap if none is nearer
  double length = 0.0;           ///< of all sorties [m]
  double station_length = 0.0;   ///< of the legs between stations alone [m]
  double straight_length = 0.0;  ///< straight lines between the same stations [m]
  double duration = 0.0;         ///< of all sorties, batteries changed in no time [s]
  double energy = 0.0;           ///< [J]
  double duration_bound = 0.0;   ///< no split of this order into sorties is faster [s]
  double order_bound = 0.0;      ///< of a free order: no tour of straight lines is shorter [m]
  double order_length = 0.0;     ///< of a free order: straight lines in the order chosen [m]
  std::optional<Returns> returns;  ///< if they were asked for and there is a route
};

/// Clearances are reported up to this much above what was asked for: proving more costs time.
inline constexpr double reported_surplus = 10.0;

/// Plans the flight. Stations that keep the order given keep the ways that the survey flew between
/// them; others get the shortest found. A station that cannot be reached safely, neither by
/// PathFinder nor by find_path_by_sampling() nor along the ways of the survey, is listed, not flown
/// to; the route goes on from the one before it. Every leg is proven anew in `space`.
/// `space` decides what is free; the climb from the pad is proven against `pad_space`, which should
/// be the same without the ground (nullptr: the pilot answers for it). With `options.returns`, legs
/// lead where every point has a proven way home, and stations that have none are listed too. Throws
/// what the validations throw, and Error{bad_config} if the place above the pad is not free or if
/// no height of return is safe for the whole route.
Route plan_route(std::vector<Station> stations, const Vehicle& vehicle, const FreeSpace& space,
                 const FreeSpace* pad_space, const RouteOptions& options);

/// A leg that comes too near to something.
struct Violation {
  std::size_t leg;  ///< from point `leg` to point `leg + 1`
  Closest closest;
  std::string obstacle;  ///< its name
};

/// What is proven of a leg, and the name of what it comes nearest to.
struct LegCertificate {
  LegProof proof;
  std::string obstacle;
};

/// The proof of each leg of a polyline at `clearance`, whose bound is looked for up to `cap` (see
/// prove()); fewer if a stop is requested. A single point is a leg of no length. Throws
/// Error{bad_geometry} if a point is not finite.
std::vector<LegCertificate> certify_route(const std::vector<Eigen::Vector3d>& points,
                                          const FreeSpace& space, double clearance, double cap,
                                          const std::stop_token& stop = {});

/// All legs of a polyline that cannot be proven free at `clearance`; empty when it is safe.
/// Otherwise as certify_route().
std::vector<Violation> check_route(const std::vector<Eigen::Vector3d>& points,
                                   const FreeSpace& space, double clearance);

/// One line for the user: leg, closest place, distance.
std::string describe(const Violation& violation);

/// Of all sorties, flown past their views where the route can be flown so [s].
double least_duration(const Route& route);

/// Where the pictures of a route are taken, in their order: at its stations, or in passing.
std::vector<geometry::View> picture_views(const Route& route);

/// All points of a sortie, from above the pad and back there, stations included.
std::vector<Eigen::Vector3d> sortie_points(const Route& route, const Sortie& sortie);

}  // namespace skycap::flight
