/// Complete flight settings of a mission: vehicle, clearance budget, obstacles and leg style. The
/// options of each part of this library are derived from them.
///
/// Nothing here depends on the take-off point of a survey or on its measurements. Functions receive
/// those as arguments.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/measured_space.h"
#include "flight/clearance/obstacles.h"
#include "flight/export/geodesy.h"
#include "flight/fleet/fleet_goal.h"
#include "flight/fleet/separation.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/motion/flight_style.h"
#include "flight/motion/image_motion_bounds.h"
#include "flight/motion/photo_speed.h"
#include "flight/motion/vehicle.h"
#include "flight/route/landing_surface.h"
#include "flight/route/route.h"
#include "geometry/angle.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/platform.h"

namespace skycap::flight {

/// Order in which the exported mission visits the views of the survey.
enum class VisitOrder { shortest, survey };

/// Set of views that the exported mission captures.
enum class MissionViews {
  fastest,    ///< The fastest verified mission that keeps the coverage of the survey's views.
  survey,     ///< The views of the survey.
  replanned,  ///< Views replanned from the surface that the survey measured.
};

/// Sensor properties that the flight depends on.
struct CaptureOptions {
  geometry::CameraConfig camera;
  double view_distance = 1.0;  ///< Planned distance from a view to the surface [m].
  bool is_scanner = false;     ///< The sensor is a laser scanner that `camera` approximates.
  std::optional<geometry::ScannerMount> mount;  ///< Mount of a scanner on the vehicle.
  /// Ray density of en-route scans, which proves space free between rays. Empty if the scans of the
  /// sensor cannot prove space free.
  std::optional<SweepRays> rays;
  geometry::Shutter shutter{.exposure = 0.01, .readout = 0.0};
  std::optional<PhotoShutter> photo;  ///< of a photo camera, which measures no depth
  double settle = 0.0;                ///< Rest time before an exposure [s].
  bool is_moving = false;             ///< The sensor also measures on legs.
  double frame_period = 1.0;          ///< between the scans that are taken on the way [s]

  /// Returns true if a laser scanner measures continuously, so that the vehicle need not hold at
  /// views.
  bool scans_in_flight() const { return mount && is_moving; }
};

/// Limits of the airspace and the obstacles that are known before the survey.
struct AirspaceOptions {
  Eigen::Vector3d base = Eigen::Vector3d::Zero();  ///< Base point of the scene.
  double ground_height = 0.0;                      ///< Height z below which all space is solid [m].
  /// Polygon that the vehicle must not leave. Empty: no geofence.
  std::vector<Eigen::Vector2d> geofence;
  std::vector<Prism> no_fly;         ///< Volumes that the vehicle must not enter.
  std::optional<double> max_height;  ///< Maximum flight height z [m].
  std::vector<std::shared_ptr<const PriorObstacle>> priors;
  /// Returns the ground height z used for leg clearance, known or assumed [m]. If unset, `base.z()`
  /// applies.
  std::function<double(const Eigen::Vector2d&)> ground;
  /// Returns the maximum terrain height z around a position, where known [m]. Unset: no terrain
  /// model.
  std::function<std::optional<double>(const Eigen::Vector2d&)> terrain;
};

/// Vehicles that share the mission. The first vehicle flies the survey.
struct FleetOptions {
  /// Names as in FlightOptions::vehicle_name. Empty, or at least two.
  std::vector<std::string> names;
  std::vector<Vehicle> vehicles;      ///< Profiles of `names`, in the same order.
  std::vector<Eigen::Vector3d> pads;  ///< Pad of each vehicle, or empty.
  FleetGoal goal = FleetGoal::makespan;
  double separation = 10.0;        ///< Planned distance between vehicles [m].
  double timing_tolerance = 10.0;  ///< Maximum deviation of each flight from its timetable [s].

  /// Returns the separation rule for each pair of flights.
  SeparationRule rule() const { return {.distance = separation, .tolerance = timing_tolerance}; }
};

struct FlightOptions {
  std::string vehicle_name = "none";  ///< Preset name, or path of a vehicle profile.
  /// Vehicle profile. Empty: the sensor is assumed to reach every view.
  std::optional<Vehicle> vehicle;
  /// Presets that supply the mission mode when a file is written for a different autopilot than the
  /// vehicle's.
  std::vector<Vehicle> substitutes;

  /// Clearance at which every leg is verified, including the three errors below [m].
  double clearance = 2.0;
  double position_error = 0.1;
  double tracking_error = 0.3;
  double map_error = 0.1;

  /// Volume that counts as occupied until it is measured as free. May be empty.
  Eigen::AlignedBox3d unknown_box;
  /// True if the mission sets `unknown_box`. Otherwise it is the box around the scene.
  bool has_own_box = false;
  /// Further volumes that count as occupied until measured as free.
  std::vector<Eigen::AlignedBox3d> extra_unknown_boxes;
  double free_without_return = 0.0;
  AirspaceOptions airspace;

  std::optional<Eigen::Vector3d> takeoff;  ///< Take-off point (pad).
  /// Climb above the pad [m]. Default: the larger of 5 m and `clearance` + 1 m.
  std::optional<double> takeoff_climb;
  /// Rally points: alternative landing points for returns, on the ground.
  std::vector<Eigen::Vector3d> rally;
  /// Slope of the pad and the rally points as measured by the pilot [rad].
  std::optional<double> pad_slope;
  /// Maximum slope of the ground under the vehicle [rad].
  double max_pad_slope = 10.0 * geometry::radians_per_degree;

  double cruise_speed = 4.0;
  double hold = 0.5;          ///< Hold time at a view before the capture [s].
  double hold_after = 0.5;    ///< Hold time at a view after the capture [s].
  double wind_speed = 0.0;    ///< Wind speed [m/s].
  double wind_from = 0.0;     ///< Direction the wind comes from, clockwise from north [rad].
  double temperature = 15.0;  ///< Battery temperature [°C].
  double reserve = 0.25;      ///< Fraction of the battery energy that remains at landing.
  MissionViews views = MissionViews::fastest;
  VisitOrder order = VisitOrder::shortest;
  FlightStyle style = FlightStyle::stop;  ///< Leg style in file formats that support curves.
  CaptureOptions capture;
  FleetOptions fleet;

  Site site;  ///< Origin of the local frame. 0° N 0° E without a georeference.
  bool is_georeferenced = false;  ///< True if the mission has a georeference.

  bool has_vehicle() const { return vehicle.has_value(); }
  /// Returns the vehicle. The mission must have one (see `has_vehicle`).
  const Vehicle& required_vehicle() const { return vehicle.value(); }

  /// Returns `own` with the autopilot `autopilot`. If the dialects differ, the mission mode (and
  /// for DJI the WPML codes) come from the stand-in. Size, energy and gimbal remain those of `own`.
  Vehicle vehicle_for(Vehicle own, AutopilotType autopilot) const;

  /// Returns true if several vehicles share the mission.
  bool is_fleet() const { return fleet.names.size() > 1; }

  /// Returns the pads of the fleet. Without configured pads, they form a row on the ground through
  /// `first`, parallel to the nearest side of the unknown box. Their spacing is the separation plus
  /// 1 m, alternating on both sides of `first`.
  std::vector<Eigen::Vector3d> fleet_pads(const Eigen::Vector3d& first) const;

  /// Returns the options for a single vehicle of the fleet that starts at `pad` and keeps the given
  /// waypoint order. Speed, map error and sensor remain those of the first vehicle.
  FlightOptions for_vehicle(std::size_t number, const Eigen::Vector3d& pad) const;

  /// Returns the options for a subset of the fleet with the corresponding `pads`. `kept` must not
  /// be empty.
  FlightOptions with_vehicles(const std::vector<std::size_t>& kept,
                              const std::vector<Eigen::Vector3d>& pads) const;

  /// Returns the clearance budget. Its margin is the clearance minus the errors and the vehicle
  /// radius.
  ClearanceBudget budget() const;

  /// Returns true if a survey may start at `position`: at least twice the clearance from all
  /// unknown boxes and prior obstacles. Always true without a vehicle.
  bool is_in_known_airspace(const Eigen::Vector3d& position) const;

  /// Returns the settings of the measured space at the start of a survey.
  MeasuredSpaceConfig measured_space() const;

  /// Returns the obstacles that do not depend on measurements: ground, prior data, no-fly volumes
  /// and geofence.
  Obstacles rules() const;

  /// Returns the ground height z at a position: that of the terrain, known or assumed, otherwise
  /// the base of the scene [m].
  double ground_at(const Eigen::Vector2d& position) const;

  /// Returns the pad: the configured one, or the closest ground position to the first view outside
  /// the unknown box and its margin.
  Eigen::Vector3d pad(const Eigen::Vector3d& first_view) const;

  /// Returns the climb from the pad to the start of the first leg [m].
  double climb() const;

  /// Returns the maximum height z for the search of a return altitude [m]. It lies above the
  /// unknown box, prior obstacles, no-fly volumes and `obstacles_top`, and below the maximum height
  /// of the site. `pad_z` is the height z of the pad [m].
  double max_return_altitude(double pad_z, double obstacles_top) const;

  RouteOptions route(const Eigen::Vector3d& pad) const;

  /// Returns RtlProfile::braking at cruise speed [m].
  double braking_before_return() const;
  /// Returns the hold time before or after a capture [s]: the configured value, or the sensor's
  /// minimum if that is longer.
  double rest_before() const;
  double rest_after() const;

  /// Returns the image sharpness bounds at the view distance. Empty for a laser scanner.
  std::optional<ImageMotionBounds> image_motion_bounds() const;

  /// Returns the facts that route files must agree with, except the views. Without a configured
  /// pad, the altitude reference is the base of the scene.
  FlightFacts facts() const;

  /// Returns the maximum distance between pad centre and touchdown point [m].
  double pad_radius() const;

  /// Returns the landing points: the pad, then the rally points.
  std::vector<Eigen::Vector3d> landings(const Eigen::Vector3d& pad) const;

  /// Returns the ground of each landing point where it is known. In order of precedence it is
  /// measured, declared (`pad_slope`) or derived from the terrain.
  std::vector<LandingSurface> landing_surfaces(const Eigen::Vector3d& pad,
                                               std::span<const LandingSurface> measured) const;

  /// Returns the limits for the ground of landing points.
  PadLimits ground_limits() const;
};

/// Returns the autopilots that files are written for. For a DJI vehicle, the .plan and .waypoints
/// files are for other autopilots.
std::vector<AutopilotType> find_autopilots(const Vehicle& vehicle);

}  // namespace skycap::flight
