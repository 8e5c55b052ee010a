/// Flight plan of a finished survey: the route and its files for autopilots, ground stations and
/// maps.
#pragma once

#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/export/export.h"
#include "flight/flight_options.h"
#include "flight/interpreter/interpreted_route.h"
#include "flight/route/route.h"
#include "geometry/io/output_folder.h"
#include "geometry/pose/pose.h"
#include "missions/package/replan/mission_choice.h"

namespace skycap::missions::package {

/// Path as a list of points.
using Polyline = std::vector<Eigen::Vector3d>;

/// Returns the options with a fixed order of views and given paths between them. Replanned views,
/// and surveys in their own order, are flown with these options.
flight::FlightOptions with_fixed_order(flight::FlightOptions options);

/// Plans a route through views of a survey, verified in the space that the survey measured. `paths`
/// contains the survey's path to each view from the previous view or from above the pad. Unknown
/// paths are empty. `landing_surfaces` contains the measured ground of the pad and rally points.
/// The route lists the views that this flight cannot reach. Throws all errors of plan_route().
/// Throws Error{bad_usage} shortly after a stop request.
flight::Route plan_flight(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                          const Eigen::Vector3d& pad, const std::vector<geometry::View>& views,
                          const std::vector<Polyline>& paths,
                          std::span<const flight::LandingSurface> landing_surfaces = {},
                          std::stop_token stop = {});

/// Returns a station for each view, with the rest times of the mission.
std::vector<flight::CapturePoint> make_capture_points(const flight::FlightOptions& options,
                                                      const std::vector<geometry::View>& views,
                                                      const std::vector<Polyline>& paths);

/// Plans a verified route through `capture_points`, including their hold times and actions.
flight::Route plan_flight(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                          const Eigen::Vector3d& pad,
                          std::vector<flight::CapturePoint> capture_points,
                          std::span<const flight::LandingSurface> landing_surfaces = {},
                          std::stop_token stop = {});

/// Route file and its verified minimum clearance, determined by reading the file back.
struct FlightFile {
  std::string name;
  std::string heights;         ///< Altitude reference.
  double min_clearance = 0.0;  ///< Verified minimum clearance [m], see flight::LegVerification.
  std::size_t sortie = 0;      ///< Index of the sortie in the route.
  double duration = 0.0;       ///< Duration with the autopilot that the file is written for [s].
  flight::Format format = flight::Format::plan;
  std::vector<flight::InterpretedStop> captures{};  ///< as read back, see flight::list_captures()
};

struct FlightFiles {
  std::vector<FlightFile> written;
  std::vector<std::string> parameters;  ///< Names of the parameter files.
  std::vector<std::string> notes;  ///< Formats that were skipped or omit information, with reasons.
};

/// Returns the formats of a mission package: those of the vehicle's autopilot or app, of maps and
/// of other programs.
std::span<const flight::Format> package_formats(const flight::Vehicle& vehicle);

/// Stages the route of the mission `name` in each format. Several sorties are written to numbered
/// files such as "mission-1.plan", with `stem` as the prefix. Each file is read back and verified.
///
/// A format is skipped with a note if it requires missing mission keys (for example the geoid
/// undulation) or if its file fails verification. If it is the only format, this is an error
/// instead: Error{bad_config} or the error of export_flight(). Throws Error{bad_file} if a file
/// cannot be written. For MAVLink vehicles, the parameters for the return altitude are also staged.
FlightFiles stage_flight(const std::string& name, const flight::FlightOptions& options,
                         const flight::Route& route, const flight::FreeSpace& measured,
                         std::span<const flight::Format> formats, geometry::OutputFolder& folder,
                         const std::string& stem = "mission");

/// Coverage of a simulated re-flight with an empty cloud and different noise, as fractions of the
/// surface samples.
struct ReflightCoverage {
  double all = 0.0;               ///< Fraction of the whole surface.
  std::optional<double> visible;  ///< Fraction of the visible surface.
  /// Fraction of the visible surface if all points are kept, without downsampling.
  std::optional<double> visible_before_downsampling;
};

/// Mission for which replanning was enabled.
struct ReplannedMission {
  package::MissionChoice choice;
  std::optional<ReflightCoverage>
      again;  ///< Coverage of the replanned mission; only in simulations.
  /// Coverage of the mission through the survey's views.
  std::optional<ReflightCoverage> survey_again{};
};

struct FleetMission;
struct WrittenMission;

/// Route and files of a finished survey.
struct SurveyMission {
  flight::Route route;  ///< Verified route, without stations if planning failed.
  FlightFiles files;
  std::optional<flight::ImageMotionBounds> image_motion{};  ///< how sharp they are
  std::string failure;  ///< Reason why planning failed; empty after success.
  std::optional<ReplannedMission> replanned{};      ///< Result of replanning, if it was enabled.
  std::shared_ptr<const WrittenMission> written{};  ///< what the files cover, if simulated
  std::shared_ptr<const FleetMission> fleet{};  ///< the same by several vehicles, if there are any
};

/// Returns true for names of route files (in any format or in `format`). The first overload also
/// accepts parameter files and timetables.
bool is_flight_file(std::string_view name);
bool is_flight_file(std::string_view name, flight::Format format);

}  // namespace skycap::missions::package
