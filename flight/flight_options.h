/// What a mission asks of its flight, complete: the vehicle, the clearance and its terms, what is
/// in the way, and how legs are flown. From it follow the options of every part of this library.
///
/// Nothing in it depends on the take-off point that is only known when a survey begins, or on what
/// the survey measures: those are arguments.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "flight/fleet/fleet_goal.h"
#include "flight/fleet/separation.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/motion/flight_style.h"
#include "flight/motion/picture_bounds.h"
#include "flight/motion/vehicle.h"
#include "flight/route/pad_ground.h"
#include "flight/route/route.h"
#include "flight/space/measured_space.h"
#include "flight/space/obstacles.h"
#include "geometry/angle.h"
#include "geometry/place/camera.h"
#include "geometry/place/platform.h"

namespace skycap::flight {

/// In which order the exported mission visits the survey's views.
enum class VisitOrder { shortest, survey };

/// Which views the exported mission takes.
enum class MissionViews {
  survey,  ///< the survey's
  anew,    ///< chosen by the surface that the survey measured
};

/// The sensor as far as the flight depends on it.
struct CaptureOptions {
  geometry::CameraConfig camera;
  double view_distance = 1.0;                   ///< from how far surfaces are looked at [m]
  bool is_scanner = false;                      ///< a laser scanner, for which `camera` stands
  std::optional<geometry::ScannerMount> mount;  ///< of a scanner that is flown
  /// How its scans prove space free; nothing: they do not, since lines prove nothing between them.
  std::optional<SweepRays> rays;
  geometry::Shutter shutter{.exposure = 0.01, .readout = 0.0};
  double settle = 0.0;        ///< at rest before a picture [s]
  bool is_moving = false;     ///< measures on the ways between views, too
  double frame_period = 1.0;  ///< between the scans that are taken on the way [s]

  /// Whether a laser scanner measures all the way, so that nothing is waited for at views.
  bool scans_in_flight() const { return mount && is_moving; }
};

/// Where the vehicle may fly, and what is in its way whatever is measured.
struct AirspaceOptions {
  Eigen::Vector3d base = Eigen::Vector3d::Zero();  ///< the foot of the scene
  double ground_height = 0.0;                      ///< z below which everything is solid
  std::vector<Eigen::Vector2d> geofence;           ///< to stay inside of; empty: none
  std::vector<Prism> no_fly;                       ///< to stay outside of
  std::optional<double> highest_height;            ///< greatest z
  std::vector<std::shared_ptr<const PriorObstacle>> priors;
  /// z of the ground at a place as legs keep off it, known or taken to be there; empty: the base's.
  std::function<double(const Eigen::Vector2d&)> ground;
  /// z of the highest ground there, where terrain is known; empty: there is no terrain.
  std::function<std::optional<double>(const Eigen::Vector2d&)> terrain;
};

/// Several vehicles that share the mission; the first of them flies the survey.
struct FleetOptions {
  std::vector<std::string> names;     ///< as FlightOptions::vehicle_name; none, or several
  std::vector<Vehicle> vehicles;      ///< what they name
  std::vector<Eigen::Vector3d> pads;  ///< one for each, or none given
  FleetGoal goal = FleetGoal::makespan;
  double separation = 10.0;        ///< kept between vehicles, by plan
  double timing_tolerance = 10.0;  ///< by which each may be early or late [s]

  /// What is asked of any two of its flights.
  SeparationRule rule() const { return {.distance = separation, .tolerance = timing_tolerance}; }
};

struct FlightOptions {
  std::string vehicle_name = "none";  ///< a preset, or the path of a description
  std::optional<Vehicle> vehicle;     ///< nothing: the sensor is taken to reach every view
  /// The presets whose autopilots stand in where a file is written for another one than the
  /// vehicle's own.
  std::vector<Vehicle> stand_ins;

  double clearance = 2.0;  ///< that every leg is proven at; the errors below are part of it [m]
  double position_error = 0.1;
  double tracking_error = 0.3;
  double map_error = 0.1;

  Eigen::AlignedBox3d unknown_box;  ///< where space must be measured to be free; may be empty
  bool has_own_box = false;         ///< unknown_box is given; else it is the box around the scene
  std::vector<Eigen::AlignedBox3d> unknown_beside;  ///< further boxes where it must
  double free_without_return = 0.0;
  AirspaceOptions airspace;

  std::optional<Eigen::Vector3d> takeoff;  ///< the pad
  std::optional<double> takeoff_climb;     ///< else 5 m, or a metre more than the clearance
  std::vector<Eigen::Vector3d> rally;      ///< other places to land when called home, on the ground
  std::optional<double> pad_slope;         ///< of pad and rally points, as the pilot found it [rad]
  double steepest_pad = 10.0 * geometry::radians_per_degree;  ///< at which it may stand [rad]

  double cruise_speed = 4.0;
  double hold = 0.5;          ///< at a view, before the capture [s]
  double hold_after = 0.5;    ///< and after it [s]
  double wind_speed = 0.0;    ///< [m/s]
  double wind_from = 0.0;     ///< where it blows from, clockwise from north [rad]
  double temperature = 15.0;  ///< of the battery [degrees Celsius]
  double reserve = 0.25;      ///< share of the battery left at landing
  MissionViews views = MissionViews::survey;
  VisitOrder order = VisitOrder::shortest;
  FlightStyle style = FlightStyle::stop;  ///< of files that can hold curves
  CaptureOptions capture;
  FleetOptions fleet;

  Site site;               ///< the origin of the frame; at 0 N 0 E if the mission has no place
  bool has_place = false;  ///< whether the mission says where on the Earth it is

  bool is_flown() const { return vehicle.has_value(); }
  /// What flies the mission, which must be one that is flown.
  const Vehicle& flown() const { return vehicle.value(); }

  /// The vehicle as that autopilot flies it: unchanged if it is its own, else with the stand-in's
  /// mission mode, and codes if they are DJI's. Size, energy and gimbal stay the vehicle's.
  Vehicle flown_by(Vehicle own, Dialect dialect) const;

  /// Whether several vehicles share the mission.
  bool is_fleet() const { return fleet.names.size() > 1; }

  /// The fleet's pads: those given, or a row from the first one along the nearest side of the
  /// unknown box, on the ground, a metre more than the separation apart, to either side in turn.
  std::vector<Eigen::Vector3d> fleet_pads(const Eigen::Vector3d& first) const;

  /// The flight of one of the fleet's vehicles, alone, from its pad, with its stations in the order
  /// given. Speed, map error and sensor stay those of the first vehicle.
  FlightOptions of_vehicle(std::size_t number, const Eigen::Vector3d& pad) const;

  /// The flight of some of the fleet's vehicles, one at least, with their pads.
  FlightOptions with_vehicles(const std::vector<std::size_t>& kept,
                              const std::vector<Eigen::Vector3d>& pads) const;

  /// The clearance's terms: the margin is what errors and vehicle leave of it.
  ClearanceBudget budget() const;

  /// Whether a survey may begin there: outside of the boxes and off what prior data knows, with
  /// room to spare; or with nothing flown.
  bool is_in_known_airspace(const Eigen::Vector3d& place) const;

  /// Measured space before anything is measured.
  MeasuredSpaceConfig measured_space() const;

  /// What holds whatever is measured: the ground, no-fly volumes, the geofence.
  Obstacles rules() const;

  /// z of the ground at a place: with terrain as legs keep off it, known or taken to be there; else
  /// the scene's.
  double ground_at(const Eigen::Vector2d& place) const;

  /// The pad: as given, or on the ground beside the unknown box, as near to the first view as can
  /// be.
  Eigen::Vector3d pad(const Eigen::Vector3d& first_view) const;

  /// How far the vehicle climbs from the pad before its first leg.
  double climb() const;

  /// The greatest z at which a height of return is looked for, of a vehicle whose pad is at
  /// `pad_z`: over the unknown box, no-fly volumes and `obstacles_top`, under the greatest height
  /// that the site allows.
  double highest_return(double pad_z, double obstacles_top) const;

  RouteOptions route(const Eigen::Vector3d& pad) const;

  /// Rest at a view, before the capture and after it [s]: what the flight asks for, and no less
  /// than the sensor needs.
  double rest_before() const;
  double rest_after() const;

  /// How sharp its pictures are at the view distance; nothing for a laser scanner.
  std::optional<PictureBounds> picture_bounds() const;

  /// What the mission's route files must agree with. Where the pad is not given, heights above it
  /// count from the foot of the scene. The views are not known.
  FlightFacts facts() const;

  /// How far from a pad's middle the vehicle's feet may come down.
  double pad_radius() const;

  /// Where the vehicle lands: the pad, then the rally points.
  std::vector<Eigen::Vector3d> landings(const Eigen::Vector3d& pad) const;

  /// The ground of each of these that it is known of: what `measured` holds for the place, else as
  /// pad_slope declares it, else by the terrain.
  std::vector<PadGround> grounds(const Eigen::Vector3d& pad,
                                 std::span<const PadGround> measured) const;

  /// What these must be.
  PadLimits ground_limits() const;
};

/// The autopilots that the vehicle's files are written for: a DJI vehicle's .plan and .waypoints
/// are for others.
std::vector<Dialect> dialects_of(const Vehicle& vehicle);

}  // namespace skycap::flight
