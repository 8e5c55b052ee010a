/// One sortie as every writer sees it, and a route file as every reader gives it.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "flight/route/route.h"
#include "flight/space/obstacles.h"

namespace skycap::flight {

/// A point that the vehicle stops at.
struct Waypoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< local frame
  bool is_station = false;                             ///< else a corner of a leg
  double yaw = 0.0;         ///< of a station: from north, clockwise [rad]
  double pitch = 0.0;       ///< of the gimbal at a station [rad]
  double hold = 0.0;        ///< at rest and aimed before the shots, or at a corner [s]
  double hold_after = 0.0;  ///< and after them [s]
  int shots = 0;
  std::uint32_t view_index = 0;
  double clearance = 0.0;  ///< proven for the leg that ends here [m]
  Curve curve;             ///< how to get here from the stop before; empty: straight
  /// How to get here past the stations of a sortie, in place of the curve.
  std::optional<Passage> passage{};

  /// Where the vehicle is on the curve or passage that leads here; null: the way is straight.
  const Curve* way() const {
    if (passage) return &passage->curve;
    return curve.empty() ? nullptr : &curve;
  }
};

struct FlightPlan {
  std::string name;
  Site site;
  Vehicle vehicle;
  Conditions conditions;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<Waypoint> waypoints;  ///< from above the pad, through the stations, and back there
  std::vector<Prism> no_fly;
  std::optional<Prism> fence;
  double clearance = 0.0;          ///< that the legs are certified at [m]
  std::optional<Returns> returns;  ///< of the whole mission that the sortie is a part of
  std::vector<std::shared_ptr<const PriorObstacle>> priors{};  ///< in the way of the climb, too
  std::vector<Waypoint> passed{};  ///< stations that are not stopped at, one for each passed view

  /// Throws Error{bad_config} if there are none.
  const Returns& certified_returns() const;
};

/// Where the plan's vehicle may land beside the pad when it is called home.
std::vector<Eigen::Vector3d> rally_points(const FlightPlan& plan);

/// Whether a plan's legs go round their corners, and past stations, where the route has a proven
/// curve for that.
enum class Corners { stopped_in, flown_round };

/// The plan of sortie `index` of a route. Throws what Site::validate() throws.
FlightPlan flight_plan(const Route& route, std::size_t index, const std::string& name,
                       const Site& site, const Obstacles& rules = {},
                       Corners corners = Corners::stopped_in);

/// No-fly volumes as formats without heights can hold them: footprints that no leg crosses, and no
/// return. Those that one passes over or under are left out, by name.
struct FlatNoFly {
  std::vector<Prism> written;
  std::vector<std::string> left_out;
};
FlatNoFly flat_no_fly(const FlightPlan& plan);

/// When the plan's vehicle is where, stop by stop [s], counted from the pad.
struct StopTime {
  double arrival;    ///< settled in place
  double aimed;      ///< heading and gimbal are right, too
  double shot;       ///< the hold is over
  double departure;  ///< and the hold after the shots
};
std::vector<StopTime> stop_times(const FlightPlan& plan);

/// From leaving the pad until the motors stop there [s].
double flight_time(const FlightPlan& plan);

// ---- what readers give -----------------------------------------------------------------------

enum class HeightDatum { ellipsoid, mean_sea_level, takeoff };

inline constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

struct FilePoint {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height = 0.0;  ///< above the point's datum [m]
  double yaw_deg = not_given;
  double pitch_deg = not_given;
  double hold = 0.0;         ///< in all [s]
  double hold_before = 0.0;  ///< before the first shot, where the format says [s]
  int shots = 0;
  double speed = not_given;  ///< towards it, where the format says [m/s]
  double curve = 0.0;        ///< how far from it the vehicle may turn [m]
  HeightDatum datum = HeightDatum::ellipsoid;
};

/// The places a file makes a vehicle fly through, in order.
struct RouteFile {
  std::vector<FilePoint> points;
  std::optional<double> return_height;  ///< above take-off, where the format says it [m]
};

/// The file's points in the local frame; `pad` is where heights above take-off count from. Throws
/// Error{bad_config} if one counts from mean sea level and the site's undulation is unknown.
std::vector<Eigen::Vector3d> local_points(const RouteFile& file, const Site& site,
                                          const Eigen::Vector3d& pad);

}  // namespace skycap::flight
