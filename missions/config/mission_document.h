/// A mission as its file says it. Plain data: a section for each of the file's, which holds the
/// options of the libraries by value for keys that are used as they stand, and optionals for those
/// that follow from others where they are not given. read_mission_document() fills it,
/// docs/reference/mission-file.md lists every key.
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
#include "geometry/place/prism.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/online/live/live_options.h"
#include "missions/scan/scan_options.h"
#include "missions/scene/scene_options.h"
#include "missions/session/opening_flight.h"
#include "missions/site_data/source.h"
#include "sim/sensors/survey_sensor.h"
#include "survey/planners/planner_names.h"
#include "survey/see/see_config.h"
#include "survey/skycap/skycap_config.h"
#include "survey/survey_limits.h"
#include "survey/volumetric/volumetric_config.h"

namespace skycap::missions::config {

enum class SensorPreset {
  d435,             ///< Intel RealSense D435: 848 x 480 pixels, 69.4 x 42.5 degrees
  high_resolution,  ///< 2400 x 1750 pixels, 60 x 40 degrees (paper §IV-A, Radcliffe Camera)
};

struct SensorSection {
  SensorPreset preset = SensorPreset::d435;
  /// In place of the camera: a laser scanner's preset, or the path of a description.
  std::optional<std::string> lidar;
  sim::SurveySensorOptions options;
  /// Field of a flown rosette scanner; resolve() computes it once.
  std::optional<sim::RosetteField> rosette;
};

enum class PlannerPreset {
  paper,     ///< the published parameters
  building,  ///< what keeps SEE++ from stalling on large scenes: docs/explanation/see.md
};

/// What the planner skycap spares.
enum class PlannerGoal {
  minutes,  ///< a view costs the seconds that its stop takes, or one view distance of way
  views,    ///< a view costs three view distances of way
};

/// How densely a surface is measured, and from where, whatever the planner.
struct SamplingSection {
  double density = 146'000.0;                    ///< rho, wanted points per m^3
  double resolution_radius = 0.017;              ///< r
  std::optional<double> spacing;                 ///< epsilon, least distance of kept points
  std::optional<double> view_distance;           ///< d
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< measurements outside are dropped
};

struct PlannerSection {
  survey::PlannerName name = survey::PlannerName::see_plus_plus;
  PlannerGoal goal = PlannerGoal::views;
  PlannerPreset preset = PlannerPreset::paper;
  SamplingSection sampling;
  survey::see::SeeConfig see;  ///< what SEE and SEE++ alone use
  survey::skycap::StopRule skycap_stop;
  survey::skycap::SkycapIdeas skycap_ideas;
  survey::volumetric::VolumetricSettings volumetric;  ///< of the planners rsv to ae
};

/// The first view. Without a position it is drawn at random by the seed.
struct StartSection {
  std::optional<Eigen::Vector3d> position;
  std::optional<Eigen::Vector3d> look_at;    ///< a point; with a position, either this
  std::optional<Eigen::Vector3d> direction;  ///< or this is given
};

struct LimitsSection {
  survey::SurveyLimits options;            ///< but max_time, which max_minutes says
  std::optional<double> max_minutes;       ///< of the flight
  std::optional<double> ground_clearance;  ///< of a view, above the z of `scene.position`
  double stand_off = 0.0;                  ///< least distance of a view from all that was measured
  double lowest_pitch = -std::numbers::pi / 2.0;  ///< of the gimbal [rad], down is negative
  double highest_pitch = std::numbers::pi / 2.0;  ///< [rad]
};

/// The airspace over the site, in the mission's frame: x east, y north, z up.
struct SiteSection {
  std::vector<Eigen::Vector2d> geofence;  ///< polygon to stay inside of; empty: none
  std::vector<geometry::Prism> no_fly;    ///< to stay outside of
  std::optional<double> lowest_height;    ///< least z
  std::optional<double> highest_height;   ///< greatest z
};

/// Where the local frame (x east, y north, z up) is on the Earth. Missing: files that need it are
/// not written.
struct Georeference {
  std::optional<double> latitude_deg;      ///< of the frame's origin on WGS84
  std::optional<double> longitude_deg;     ///< east positive
  double ellipsoid_height = 0.0;           ///< of the origin
  std::optional<double> geoid_undulation;  ///< height of the geoid above the ellipsoid there
};

struct FlightSection {
  /// Plain keys; what follows from others is not in it yet.
  flight::FlightOptions options;
  std::optional<Eigen::AlignedBox3d> unknown_box;  ///< where space must be measured to be free
  std::vector<Eigen::Vector3d> unknown_beside;     ///< corners of further such boxes, two of each
  session::Opening opening = session::Opening::none;

  bool is_flown() const { return options.vehicle_name != "none"; }
};

/// What a publication reports for this scene, printed beside the results of trials.
struct ReferenceSection {
  std::optional<double> views;
  std::optional<double> coverage;       ///< share, not percent
  std::optional<double> planning_time;  ///< [s] for a survey
  std::optional<double> distance;
};

/// A mission as its file says it, and where the file says what.
struct MissionDocument {
  std::string file;                                        ///< what messages call it
  std::map<std::string, std::string, std::less<>> places;  ///< of the keys given: "FILE:LINE", or
                                                           ///< an override's origin

  std::string name;  ///< names the results' folder
  scene::SceneOptions scene;
  SensorSection sensor;
  PlannerSection planner;
  StartSection start;
  LimitsSection limits;
  SiteSection site;
  Georeference georeference;
  FlightSection flight;
  std::vector<site_data::Source> prior;
  evaluation::EvaluationOptions evaluation;
  scan::FlownScanOptions scan;
  online::LiveOptions live;
  ReferenceSection paper;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< zero: all processors

  bool gives(std::string_view key) const;

  /// Throws Error{bad_config}, one line: "FILE:LINE: key KEY WHAT". A key that is not given stands
  /// in the first line.
  [[noreturn]] void refuse(std::string_view key, const std::string& what) const;
};

}  // namespace skycap::missions::config
