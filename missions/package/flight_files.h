/// A finished survey as missions to be flown again: the route, and its files for autopilots, ground
/// stations and maps.
#pragma once

#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "flight/export/export.h"
#include "flight/flight_options.h"
#include "flight/route/route.h"
#include "flight/space/clearance.h"
#include "geometry/io/output_folder.h"
#include "geometry/place/pose.h"
#include "missions/package/replan/mission_choice.h"

namespace skycap::missions::package {

/// A way through space, point by point.
using Way = std::vector<Eigen::Vector3d>;

/// The flight with its views in the order given, and with the ways to them: as views chosen anew
/// are flown, or those of the survey in its own order.
flight::FlightOptions in_given_order(flight::FlightOptions options);

/// The flight of a mission's vehicle through views of its survey, proven in what the survey has
/// measured; ways[i] is how it came to view i from the view before or from above the pad (empty if
/// that is not known); `grounds` are those of pad and rally points that were measured. Views that
/// this flight cannot visit are listed in it. Throws what plan_route() throws, and
/// Error{bad_usage} soon after a stop is requested.
flight::Route plan_flight(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                          const Eigen::Vector3d& pad, const std::vector<geometry::View>& views,
                          const std::vector<Way>& ways,
                          std::span<const flight::PadGround> grounds = {},
                          std::stop_token stop = {});

/// The stations of these views, with the rests that the mission asks for.
std::vector<flight::Station> stations_of(const flight::FlightOptions& options,
                                         const std::vector<geometry::View>& views,
                                         const std::vector<Way>& ways);

/// The same through stations that are given with all that is done there.
flight::Route plan_flight(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                          const Eigen::Vector3d& pad, std::vector<flight::Station> stations,
                          std::span<const flight::PadGround> grounds = {},
                          std::stop_token stop = {});

/// A route file, and how near its flight as read back comes to anything.
struct FlightFile {
  std::string name;
  std::string heights;         ///< what they count from
  double min_clearance = 0.0;  ///< proven [m], see flight::LegProof
  std::size_t sortie = 0;      ///< of the route
  double duration = 0.0;       ///< as the autopilot that it is written for flies it [s]
};

struct FlightFiles {
  std::vector<FlightFile> written;
  std::vector<std::string> parameters;  ///< names of the parameter files written with them
  std::vector<std::string> notes;  ///< what was not written, or what a format leaves out, and why
};

/// The formats of a mission package: those that this autopilot reads, and those of maps and other
/// programs.
std::span<const flight::Format> package_formats(flight::Dialect dialect);

/// Stages the route of the mission `name` in each of the formats; with several sorties a file for
/// each, "mission-1.plan" and so on, or with another `stem`. Every file is read back and proved. A
/// format that needs what the mission does not say, such as the geoid's height, or whose file fails
/// its proof, is left out with a note, unless it is the only one: then that is thrown, as
/// Error{bad_config} or what export_flight() throws. A file that cannot be written is thrown as
/// Error{bad_file}. Beside files for MAVLink vehicles their parameters are staged, which say how
/// high to return.
FlightFiles stage_flight(const std::string& name, const flight::FlightOptions& options,
                         const flight::Route& route, const flight::FreeSpace& measured,
                         std::span<const flight::Format> formats, geometry::OutputFolder& folder,
                         const std::string& stem = "mission");

/// What a mission covers when it is flown again in the simulator, from an empty cloud and with
/// other noise: shares of samples.
struct FlownAgain {
  double all = 0.0;               ///< of the whole surface
  std::optional<double> visible;  ///< of what admissible views can see
  /// The same with all points kept, whatever the mission's spacing.
  std::optional<double> visible_unthinned;
};

/// A mission whose views were to be chosen anew.
struct AnewMission {
  package::MissionChoice choice;
  std::optional<FlownAgain> again;           ///< in simulation
  std::optional<FlownAgain> survey_again{};  ///< of the mission along the survey's views
};

struct FleetMission;

/// The flight of a finished survey and where it was written to.
struct SurveyMission {
  flight::Route route;  ///< without stations if there is none
  FlightFiles files;
  std::optional<flight::PictureBounds> pictures{};  ///< how sharp they are
  std::string failure;                ///< why there is no route; empty if there is one
  std::optional<AnewMission> anew{};  ///< if views were to be chosen anew
  std::optional<FlownAgain> again{};  ///< of a scanner's mission along the ways of its survey
  std::shared_ptr<const FleetMission> fleet{};  ///< the same by several vehicles, if there are any
};

/// Whether a file of this name is a flight's: in any format, a parameter file or timetable, or in
/// that format.
bool is_flight_file(std::string_view name);
bool is_flight_file(std::string_view name, flight::Format format);

}  // namespace skycap::missions::package
