/// Input of all writers (one sortie) and output of all readers (a route file).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/obstacles.h"
#include "flight/export/geodesy.h"
#include "flight/motion/photo_speed.h"
#include "flight/route/route.h"

namespace skycap::flight {

/// Photos that are taken without a stop on a straight leg, at even distances: at `spacing`, 2
/// `spacing` and so on from its start, and none at its end.
struct PhotoRun {
  double spacing = 0.0;     ///< [m]
  double speed = 0.0;       ///< that the leg is flown at, at most [m/s]
  std::uint32_t first = 0;  ///< index in FlightPlan::passed
  std::uint32_t count = 0;  ///< of photos
};

/// Point at which the vehicle stops.
struct Waypoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Position in the local frame [m].
  bool is_capture_point = false;                       ///< False: corner of a leg.
  double yaw = 0.0;    ///< Heading with captures, clockwise from north [rad].
  double pitch = 0.0;  ///< Gimbal pitch with captures [rad].
  double hold = 0.0;   ///< Rest time with the camera aimed before the captures, or at a corner [s].
  double hold_after = 0.0;  ///< Rest time after the captures [s].
  int captures = 0;
  std::uint32_t view_index = 0;
  double clearance = 0.0;  ///< Verified clearance of the leg that ends here [m].
  Curve curve;             ///< Curve from the previous stop. Empty: straight leg.
  /// Fly-through alternative to `curve`, past the waypoints of a sortie.
  std::optional<FlyThrough> fly_through{};
  std::optional<PhotoRun> run{};  ///< photos taken on the straight leg that ends here
  bool is_passed = false;         ///< The vehicle passes without a stop and cuts the corner.
  /// Duration of the straight leg that ends here [s]. 0: that of a leg from rest to rest.
  double leg_time = 0.0;

  /// Returns the curve of the leg that ends here, or null for a straight leg.
  const Curve* path_curve() const {
    if (fly_through) return &fly_through->curve;
    return curve.empty() ? nullptr : &curve;
  }
};

struct FlightPlan {
  std::string name;
  Site site;
  Vehicle vehicle;
  Conditions conditions;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<Waypoint> waypoints;  ///< From above the pad through the route's waypoints and back.
  std::vector<Prism> no_fly;
  std::optional<Prism> fence;
  double clearance = 0.0;          ///< Clearance at which the legs are verified [m].
  std::optional<Returns> returns;  ///< Returns of the complete mission that contains the sortie.
  /// Obstacles that apply to the climb, too.
  std::vector<std::shared_ptr<const PriorObstacle>> priors{};  ///< in the way of the climb, too
  std::vector<Waypoint> passed{};  ///< stations that are not stopped at, one for each passed view
  std::optional<PhotoShutter> photo{};  ///< of a mission with a photo camera

  /// Returns the verified returns. Throws Error{bad_config} without returns.
  const Returns& verified_returns() const;
};

/// Returns the acceptance radius (PX4) or damping distance (DJI) of waypoint `index` in route files
/// if the waypoint is passed, otherwise 0 [m].
double turn_radius(const FlightPlan& plan, std::size_t index);

/// Returns the maximum distance from the end of `leg` at which PX4 leaves it [m]. PX4 accepts a
/// waypoint within `radius` horizontally and NAV_MC_ALT_RAD vertically (mission_block.cpp), so that
/// it leaves steep legs earlier than level ones. At least `radius` or the length of the leg, so
/// that a large radius is safe with any NAV_MC_ALT_RAD.
double px4_turn_distance(const Eigen::Vector3d& leg, double radius);

/// Returns the maximum distance from waypoint `index` at which the vehicle leaves the leg before it
/// if the waypoint is passed, otherwise 0 [m].
///
/// ArduPilot 4.1 and later blend two legs from the middle of the first one at the earliest
/// (AP_Math/SCurve.cpp). DJI aircraft turn within the damping distance of the waypoint.
double turn_distance(const FlightPlan& plan, std::size_t index);

/// Returns the speed on the leg that ends at waypoint `index` [m/s]: that of its planned duration,
/// rounded up to 0.1 m/s, or the cruise speed.
double leg_speed(const FlightPlan& plan, std::size_t index);

/// First and last waypoint of a continuous recording: the stops before and after all passed
/// waypoints. Equal if no waypoint is passed.
struct Recording {
  std::size_t first = 0, last = 0;
  bool is_empty() const { return first == last; }
};
Recording recorded_stretch(const FlightPlan& plan);

/// Returns the rally points that the plan's vehicle may use for a return.
std::vector<Eigen::Vector3d> rally_points(const FlightPlan& plan);

/// Treatment of corners and waypoints: with stops, or along the verified curves where the route has
/// them.
enum class Corners { stopped_in, rounded };

/// Returns the plan of sortie `index` of a route. Throws the same errors as Site::validate().
FlightPlan flight_plan(const Route& route, std::size_t index, const std::string& name,
                       const Site& site, const Obstacles& rules = {},
                       Corners corners = Corners::stopped_in);

/// No-fly volumes for formats without heights: footprints that no leg or return crosses. `left_out`
/// lists the names of the other volumes.
struct FlatNoFly {
  std::vector<Prism> written;
  std::vector<std::string> left_out;
};
FlatNoFly flat_no_fly(const FlightPlan& plan);

/// Times at one stop, measured from departure from the pad [s].
struct StopTime {
  double arrival;    ///< Position reached and settled.
  double aimed;      ///< Heading and gimbal aimed, too.
  double capture;    ///< End of the hold before the captures.
  double departure;  ///< End of the hold after the captures.
};
std::vector<StopTime> stop_times(const FlightPlan& plan);

/// How long the leg `path_curve` takes with the photos of a run, from rest to rest [s].
double run_time(const FlightPlan& plan, const PhotoRun& run, const Eigen::Vector3d& path_curve);

/// Returns the time from leaving the pad until the motors stop [s].
double flight_time(const FlightPlan& plan);

// ---- Output of readers ------------------------------------------------------------------------

enum class HeightDatum { ellipsoid, mean_sea_level, takeoff };

inline constexpr double unspecified = std::numeric_limits<double>::quiet_NaN();

struct FilePoint {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height = 0.0;  ///< Height above the point's datum [m].
  double yaw_deg = unspecified;
  double pitch_deg = unspecified;
  double hold = 0.0;         ///< Total hold time [s].
  double hold_before = 0.0;  ///< Hold time before the first capture, if the format has it [s].
  int captures = 0;
  double photo_spacing = 0.0;  ///< of photos without a stop on the leg that begins here [m]
  double speed = unspecified;  ///< Speed towards the point, if the format has it [m/s].
  double curve = 0.0;  ///< Distance from the point at which the vehicle may start to turn [m].
  HeightDatum datum = HeightDatum::ellipsoid;
};

/// Positions of a route file in flight order.
struct RouteFile {
  std::vector<FilePoint> points;
  /// Return altitude above take-off, if the format has it [m].
  std::optional<double> return_height;
};

/// Returns the file's points in the local frame [m]. `pad` is the altitude reference for heights
/// above take-off. Throws Error{bad_config} if a height is AMSL and the site's geoid undulation is
/// unknown.
std::vector<Eigen::Vector3d> local_points(const RouteFile& file, const Site& site,
                                          const Eigen::Vector3d& pad);

}  // namespace skycap::flight
