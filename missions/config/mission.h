/// A mission as its file says it: which scene, which sensor, which planner, and how the result is
/// judged. Plain data; read_mission() fills it, docs/mission_file.md lists every key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/fleet/fleet_goal.h"
#include "flight/motion/flight_style.h"
#include "flight/motion/picture_bounds.h"
#include "flight/motion/vehicle.h"
#include "geometry/angle.h"
#include "geometry/place/prism.h"
#include "missions/site_data/source.h"
#include "sim/models/models.h"
#include "sim/sensors/depth_camera_config.h"
#include "sim/sensors/navigation_errors.h"
#include "sim/sensors/sensor.h"
#include "survey/see/see_config.h"
#include "survey/skycap/skycap_config.h"
#include "survey/volumetric/volumetric_config.h"

namespace skycap::missions::site_data {
struct SitePriors;
}

namespace skycap::missions::config {

/// Which axis of the model's own frame points up.
enum class UpAxis { z, y };

/// What is surveyed, and how it is put into the world. In this order the model is turned upright,
/// rotated, scaled, and moved so that the middle of the base of its bounding box is at `position`.
struct SceneConfig {
  std::string model;  ///< builtin:NAME, model:NAME, or the path of a mesh
  sim::LevelOfDetail detail = sim::LevelOfDetail::standard;  ///< of a builtin model
  std::uint64_t seed = 1;                                    ///< of a builtin model that is drawn
  UpAxis up_axis = UpAxis::z;
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad], about x, then y, then z
  std::optional<double> longest_side;                  ///< of the bounding box, after rotation
  std::optional<double> scale;                         ///< factor; only one of the two is given
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  /// The model again: x and y from its position [m], and a turn about its own upright [rad].
  std::vector<Eigen::Vector3d> copies;
  bool ground = false;       ///< whether the sensor also sees a plane under the model
  bool neighbours = false;   ///< and what stands beside it by prior data
  double reflectance = 0.4;  ///< diffuse, at the laser's wavelength, where no other is given
  std::optional<std::string> materials;  ///< a file of reflectances, glass and mirrors, by name
};

enum class SensorPreset {
  d435,             ///< Intel RealSense D435: 848 x 480 pixels, 69.4 x 42.5 degrees
  high_resolution,  ///< 2400 x 1750 pixels, 60 x 40 degrees (paper §IV-A, Radcliffe Camera)
};

/// Where a sensor takes its scans while a survey is flown.
enum class Capture {
  stops,   ///< at the views, at rest
  moving,  ///< and on the ways between them
};

/// How a laser scanner is fixed to the vehicle that carries it.
struct ScannerMount {
  Eigen::Isometry3d body_from_scanner = Eigen::Isometry3d::Identity();
  double look_azimuth = 0.0;  ///< where its views look, anticlockwise from the nose [rad]
  double look_pitch = 0.0;    ///< of a scanner that looks one way only [rad]
};

struct SensorConfig {
  SensorPreset preset = SensorPreset::d435;
  sim::DepthCameraConfig camera = sim::d435();  ///< its noise's seed is the mission's
  /// In place of the camera: a laser scanner's preset, or the path of a description.
  std::optional<std::string> lidar;
  /// What `lidar` names; `camera` is then planning_camera() of it (survey_sensor.h), by which
  /// planners choose views. Its seed is the mission's.
  std::optional<sim::LidarConfig> scanner;
  /// Of a scanner that is flown. One without looks where each view does.
  std::optional<ScannerMount> mount;
  flight::Shutter shutter{.exposure = 0.01, .readout = 0.0};
  double settle = 0.0;  ///< at rest before a picture, for the sensor's own sake [s]
  Capture capture = Capture::stops;
  double frame_period = 1.0;  ///< between the scans that are taken on the way [s]

  bool is_moving() const { return capture == Capture::moving; }
};

enum class PlannerName { see_plus_plus, see, skycap, rsv, rse, oa, uv, pc, af, ae };

enum class PlannerPreset {
  paper,     ///< the published parameters
  building,  ///< what keeps SEE++ from stalling on large scenes: docs/mission_file.md
};

/// What the planner skycap spares.
enum class PlannerGoal {
  minutes,  ///< a view costs the seconds that its stop takes, or one view distance of way
  views,    ///< a view costs three view distances of way
};

struct PlannerConfig {
  PlannerName name = PlannerName::see_plus_plus;
  PlannerGoal goal = PlannerGoal::views;
  PlannerPreset preset = PlannerPreset::paper;
  survey::see::SeeConfig see;
  survey::skycap::StopRule
      skycap_stop;  ///< of the planner skycap; the rest follows from the other keys
  survey::skycap::SkycapIdeas skycap_ideas;
};

/// The first view. Without a position it is drawn at random by the seed.
struct StartConfig {
  std::optional<Eigen::Vector3d> position;
  std::optional<Eigen::Vector3d> look_at;    ///< a point; with a position, either this
  std::optional<Eigen::Vector3d> direction;  ///< or this is given
};

struct LimitsConfig {
  std::size_t max_views = 1000;
  std::optional<double> max_distance;      ///< straight lines between views
  std::optional<double> ground_clearance;  ///< of a view, above the z of `scene.position`
  double stand_off = 0.0;                  ///< least distance of a view from all that was measured
  double lowest_pitch = -std::numbers::pi / 2.0;  ///< of the gimbal [rad], down is negative
  double highest_pitch = std::numbers::pi / 2.0;  ///< [rad]
  std::optional<double> max_minutes;              ///< of the flight, by the two below
  double speed = 5.0;                             ///< between views [m/s]
  double time_per_view = 5.0;                     ///< to stop, turn and measure [s]
};

/// The airspace over the site, in the mission's frame: x east, y north, z up.
struct SiteConfig {
  std::vector<Eigen::Vector2d> geofence;  ///< polygon to stay inside of; empty: none
  std::vector<geometry::Prism> no_fly;    ///< to stay outside of
  std::optional<double> lowest_height;    ///< least z
  std::optional<double> highest_height;   ///< greatest z
};

struct EvaluationConfig {
  double registration_distance = 0.005;  ///< r_d: a sample this near to a measurement is covered
  std::size_t samples = 100'000;         ///< points spread over the scene's surface
  std::size_t visible_directions = 200;  ///< from which a sample may be seen; for visible coverage
  std::size_t ceiling_views = 100;       ///< views of the attainable coverage; zero leaves it out
  /// That fits through the ways to places that count; else what the limits keep from surfaces.
  std::optional<double> radius;
};

/// Where the local frame (x east, y north, z up) is on the Earth. Missing: files that need it are
/// not written.
struct Georeference {
  std::optional<double> latitude_deg;      ///< of the frame's origin on WGS84
  std::optional<double> longitude_deg;     ///< east positive
  double ellipsoid_height = 0.0;           ///< of the origin
  std::optional<double> geoid_undulation;  ///< height of the geoid above the ellipsoid there
};

/// In which order the exported mission visits the survey's views.
enum class VisitOrder { shortest, survey };

/// Which views the exported mission takes.
enum class MissionViews {
  survey,  ///< the survey's
  anew,    ///< chosen by the surface that the survey measured
};

/// What a flown survey begins with, before any view is planned: ways outside of the unknown box.
enum class Opening {
  none,
  orbit,   ///< round the box
  strips,  ///< to and fro over it
};

/// Several vehicles that share the mission; the first of them flies the survey.
struct FleetConfig {
  std::vector<std::string> vehicles;       ///< as FlightConfig::vehicle; none, or several
  std::vector<flight::Vehicle> described;  ///< what they say, see config::resolved()
  std::vector<Eigen::Vector3d> pads;       ///< one for each, or none given
  flight::FleetGoal goal = flight::FleetGoal::makespan;
  double separation = 10.0;        ///< kept between vehicles, by plan
  double timing_tolerance = 10.0;  ///< by which each may be early or late [s]
};

/// How views become a flight. Without a vehicle nothing is flown: the sensor is taken to reach
/// every view, and no route is written.
struct FlightConfig {
  std::string vehicle = "none";  ///< a preset, or the path of a description
  flight::Vehicle described;     ///< what that says, see config::resolved()
  double clearance = 2.0;        ///< that every leg is proven at; the errors below are part of it
  double position_error = 0.1;
  double tracking_error = 0.3;
  double map_error = 0.1;
  std::optional<Eigen::AlignedBox3d> unknown_box;  ///< where space must be measured to be free
  std::vector<Eigen::Vector3d> unknown_beside;     ///< corners of further such boxes, two of each
  double free_without_return = 0.0;
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
  Opening opening = Opening::none;
  MissionViews views = MissionViews::survey;
  VisitOrder order = VisitOrder::shortest;
  flight::FlightStyle style = flight::FlightStyle::stop;  ///< of files that can hold curves
  FleetConfig fleet;

  bool is_flown() const { return vehicle != "none"; }
};

/// Level circles round a point, from the lowest to the highest, with a straight climb between.
struct OrbitConfig {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< its z is what heights count from
  double radius = 30.0;
  double lowest = 10.0;   ///< height of the first circle
  double highest = 30.0;  ///< of the last
  int circles = 3;        ///< evenly spaced in height
  double speed = 6.0;     ///< along circles and climbs [m/s]
  double start = 0.0;     ///< where circles begin: from east, anticlockwise [rad]
};

/// In which coordinates a scan's LAS files are.
enum class ScanCrs {
  local,  ///< the mission's frame
  utm,    ///< UTM on WGS84, in the zone of the frame's origin
};

/// What `skycap scan` records, and how well its carrier knows where it is. Body frame: x forward,
/// y left, z up.
struct ScanConfig {
  std::string sensor = "ouster_os1_128";  ///< a preset, or the path of a description
  std::optional<std::string> route;       ///< a file; in place of the orbit
  OrbitConfig orbit;
  ScanCrs crs = ScanCrs::local;                               ///< utm needs the mission's place
  double speed = 5.0;                                         ///< along routes without times [m/s]
  Eigen::Vector3d mount_position = Eigen::Vector3d::Zero();   ///< of the sensor, body frame
  Eigen::Vector3d mount_rotation = Eigen::Vector3d::Zero();   ///< [rad], about x, then y, then z
  sim::NavigationErrors navigation;                           ///< its seed is the mission's
  Eigen::Vector3d lever_arm_error = Eigen::Vector3d::Zero();  ///< of the believed mount_position
  Eigen::Vector3d boresight_error = Eigen::Vector3d::Zero();  ///< of the believed rotation [rad]
  double frame_period = 1.0;  ///< of a camera along a route with times [s]
  double depth_unit = 0.001;  ///< of a depth image [m]
};

/// What is made of scans that come from outside, in live surveys.
struct LiveConfig {
  bool checks_poses = true;            ///< scans that contradict what is known are set aside
  bool registers = false;              ///< their poses are corrected by what is known
  double pose_sigma = 0.0;             ///< of a scan that says none: standard deviation, each axis
  double pose_sigma_angle = 0.0;       ///< and about each axis [rad]
  bool removes_flying_pixels = false;  ///< and isolated returns
};

/// What a publication reports for this scene, printed beside the results of trials.
struct ReferenceConfig {
  std::optional<double> views;
  std::optional<double> coverage;       ///< share, not percent
  std::optional<double> planning_time;  ///< [s] for a survey
  std::optional<double> distance;
};

struct Mission {
  std::string name;  ///< names the results' folder
  SceneConfig scene;
  SensorConfig sensor;
  PlannerConfig planner;
  survey::volumetric::VolumetricSettings volumetric;  ///< of the planners rsv to ae
  StartConfig start;
  LimitsConfig limits;
  SiteConfig site;
  Georeference georeference;
  FlightConfig flight;
  std::vector<site_data::Source> prior;
  std::shared_ptr<const site_data::SitePriors> priors;  ///< what those say, see config::resolved()
  EvaluationConfig evaluation;
  ScanConfig scan;
  LiveConfig live;
  ReferenceConfig paper;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< zero: all processors
};

}  // namespace skycap::missions::config
