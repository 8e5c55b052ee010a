/// Contents of a mission file as plain data, with one struct per section. Keys used unchanged are
/// stored in the libraries' option structs. Keys whose default is derived from others are
/// std::optional. read_mission_document() fills the document; docs/reference/mission-file.md
/// documents every key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/flight_options.h"
#include "geometry/pose/photo_camera.h"
#include "geometry/pose/prism.h"
#include "missions/config/sensor_reader.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/online/live/live_options.h"
#include "missions/scan/scan_options.h"
#include "missions/scene/scene_options.h"
#include "missions/session/initial_pattern_flight.h"
#include "missions/site_data/source.h"
#include "sim/sensors/survey_sensor.h"
#include "survey/fixed_views/fixed_views_config.h"
#include "survey/patterns/pattern_config.h"
#include "survey/pb_nbv/pb_nbv_config.h"
#include "survey/photo/photo_planner.h"
#include "survey/planners/planner_names.h"
#include "survey/see/see_config.h"
#include "survey/surfel/surfel_config.h"
#include "survey/survey_limits.h"
#include "survey/volumetric/volumetric_config.h"

namespace skycap::missions::config {

struct SensorSection {
  std::string preset = "d435";  ///< find_camera()
  /// Useful range of the camera preset. Empty for other cameras and scanners. Set by the reader.
  std::optional<RangeInterval> useful_range;
  /// Laser scanner used instead of the camera: a preset or the path of a sensor description.
  std::optional<std::string> lidar;
  /// Instead of the camera: a photo camera's preset, or the path of a description.
  std::optional<std::string> photo_camera;
  std::optional<geometry::PhotoCameraConfig> photo;  ///< what it names; resolve() reads it
  sim::SurveySensorOptions options;
  /// Field of view of a rosette scanner in flight. Cached by resolve(), as it is costly to compute.
  std::optional<sim::RosetteField> rosette;
};

/// How sure the shape of a target is that photos are planned for.
enum class PhotoPass {
  coarse,  ///< an outline: photos for a first model, by which the second flight is planned
  final_pass,
};

/// Photos of a mission with a photo camera.
struct PhotoSection {
  std::optional<double> gsd;  ///< ground sampling distance, head-on [m]
  std::optional<int> min_partners;
  survey::photo::StereoRule rule;  ///< incidence and parallax
  survey::photo::PosesGiven poses = survey::photo::PosesGiven::known;
  std::optional<std::vector<std::string>> patterns;  ///< by name; nothing: all but nadir
  std::optional<std::string> pattern;                ///< that is flown as it is
  double forward_overlap = 0.8;
  double side_overlap = 0.7;
  double target_share = 1.0;
  int max_photos = 2000;
  PhotoPass pass = PhotoPass::final_pass;
};

/// Continuous flight around a known structure. Empty limits of motion are those of
/// config::complete_inspection().
struct InspectionSection {
  std::optional<double> range;  ///< Maximum view distance; makes the mission an inspection [m].
  std::optional<std::string> cloud;  ///< Point cloud of the structure, instead of a target.
  double share = 0.98;               ///< Required fraction of the attainable points.
  double max_incidence = 1.3089969389957472;  ///< [rad]
  int min_views = 1;
  std::optional<double> spacing;           ///< Distance between the points of the structure [m].
  std::optional<double> max_speed;         ///< [m/s]
  std::optional<double> max_acceleration;  ///< [m/s^2]
  std::optional<double> max_jerk;          ///< [m/s^3]
  std::optional<double> max_yaw_rate;      ///< [rad/s]
  std::optional<double> max_yaw_acceleration;  ///< [rad/s^2]
  int moves = 60'000;
  int searches = 2;
};

/// Where a mission with a photo camera, which measures no free space, may fly.
enum class FreeSpaceRule {
  measured,  ///< outside of the unknown boxes
  assumed,   ///< beyond the clearance from prior data; the pilot must check the airspace
};

enum class PlannerPreset {
  paper,     ///< published parameters
  building,  ///< prevents SEE++ from stalling on large scenes: docs/explanation/see.md
};

/// Quantity that the planner skycap minimises.
enum class PlannerGoal {
  minutes,  ///< a view costs the duration of a stop, or one view distance of path without a vehicle
  views,    ///< a view costs three view distances of path
};

/// Sampling density and view distance, used by all planners.
struct SamplingSection {
  double density = 146'000.0;            ///< rho, required points per m^3
  std::optional<double> density_per_m2;  ///< required points per m^2 of surface; replaces density
  double resolution_radius = 0.017;      ///< r, the neighbourhood radius for classifying points [m]
  std::optional<double> spacing;         ///< epsilon, minimum distance between stored points [m]
  std::optional<double> view_distance;   ///< d, the distance of views from surfaces [m]
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are discarded
};

struct PlannerSection {
  survey::PlannerName name = survey::PlannerName::see_plus_plus;
  PlannerGoal goal = PlannerGoal::views;
  PlannerPreset preset = PlannerPreset::paper;
  SamplingSection sampling;
  survey::see::SeeConfig see;  ///< settings used only by SEE and SEE++
  survey::surfel::StopRule surfel_stop;
  survey::surfel::AblationSwitches ablation;
  survey::volumetric::VolumetricSettings volumetric;   ///< settings of the planners rsv to ae
  survey::pb_nbv::PbNbvSettings pb_nbv;                ///< settings of PB-NBV
  survey::fixed_views::FixedViewSettings fixed_views;  ///< settings of uniform and random
  survey::patterns::PatternSettings patterns;          ///< settings of nadir to corridor
  /// Shared library or Python file of the planner external; resolve() makes it absolute.
  std::optional<std::string> file;
  bool is_file_by_user = false;  ///< whether the user of this run states `file`; else not executed
};

/// First view. Without a position, the seed determines a random one.
struct StartSection {
  std::optional<Eigen::Vector3d> position;
  std::optional<Eigen::Vector3d> look_at;  ///< target point of the view; conflicts with `direction`
  std::optional<Eigen::Vector3d> direction;  ///< viewing direction; conflicts with `look_at`
};

struct LimitsSection {
  survey::SurveyLimits options;       ///< max_time is not set here but derived from max_minutes
  std::optional<double> max_minutes;  ///< maximum flight time [min]
  /// Minimum height of a view above the z of `scene.position` [m].
  std::optional<double> ground_clearance;
  double min_standoff = 0.0;  ///< minimum distance between a view and all measured points [m]
  double min_pitch = -std::numbers::pi / 2.0;  ///< minimum gimbal pitch [rad], negative is down
  double max_pitch = std::numbers::pi / 2.0;   ///< maximum gimbal pitch [rad]
};

/// Airspace limits in the mission frame: x east, y north, z up [m].
struct SiteSection {
  /// Polygon that contains all views and paths; empty: unlimited.
  std::vector<Eigen::Vector2d> geofence;
  std::vector<geometry::Prism> no_fly;  ///< prisms that no view or path may enter
  std::optional<double> min_height;     ///< minimum z [m]
  std::optional<double> max_height;     ///< maximum z [m]
};

/// Georeference of the local frame (x east, y north, z up). Without it, files that require
/// geographic coordinates are not written.
struct Georeference {
  std::optional<double> latitude_deg;      ///< WGS84 latitude of the frame's origin
  std::optional<double> longitude_deg;     ///< WGS84 longitude of the origin, positive east
  double ellipsoid_height = 0.0;           ///< ellipsoidal height of the origin [m]
  std::optional<double> geoid_undulation;  ///< geoid height above the ellipsoid at the origin [m]
};

struct FlightSection {
  /// Options set directly by keys. resolve() adds derived options to a copy.
  flight::FlightOptions options;
  std::optional<Eigen::AlignedBox3d> unknown_box;  ///< box in which unobserved space is occupied
  /// Lower and upper corners of further such boxes, alternating.
  std::vector<Eigen::Vector3d> extra_unknown_boxes;
  session::InitialPattern initial_pattern = session::InitialPattern::none;
  FreeSpaceRule free_space = FreeSpaceRule::measured;

  bool has_vehicle() const { return options.vehicle_name != "none"; }
};

/// Published results for this scene, printed next to the results of trials.
struct ReferenceSection {
  std::optional<double> views;
  std::optional<double> coverage;       ///< fraction, not percent
  std::optional<double> planning_time;  ///< duration of all planning in a survey [s]
  std::optional<double> distance;
};

/// Contents of a mission file and the source location of each key.
struct MissionDocument {
  std::string file;  ///< file name in messages
  /// Location of each given key: "FILE:LINE", or the origin of an override.
  std::map<std::string, std::string, std::less<>> locations;

  std::string name;  ///< mission name, used for the results folder
  scene::SceneOptions scene;
  SensorSection sensor;
  PhotoSection photo;
  InspectionSection inspection;
  PlannerSection planner;
  StartSection start;
  LimitsSection limits;
  SiteSection site;
  Georeference georeference;
  FlightSection flight;
  std::vector<site_data::Source> prior;
  evaluation::EvaluationOptions evaluation;
  scan::ScanFlightOptions scan;
  online::LiveOptions live;
  ReferenceSection paper;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: one per processor

  bool has(std::string_view key) const;

  /// Whether photos are planned, for a target that prior data knows.
  bool is_photo() const { return sensor.photo_camera.has_value(); }
  /// Whether a continuous flight around a known structure is planned, with any camera.
  bool is_inspection() const { return inspection.range.has_value(); }
  /// Whether the flight is planned from prior data only, so that nothing is measured or simulated.
  bool is_for_known_target() const { return is_photo() || is_inspection(); }

  /// Throws Error{bad_config} with the one-line message "FILE:LINE: key KEY WHAT". Line 1 is
  /// reported for keys that are not in the file.
  [[noreturn]] void reject(std::string_view key, const std::string& what) const;
};

}  // namespace skycap::missions::config
