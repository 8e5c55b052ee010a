#include "missions/package/flight_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "flight/clearance/clearance.h"
#include "flight/clearance/interruptible_space.h"
#include "flight/export/parameters.h"
#include "flight/export/photo_runs.h"
#include "flight/export/scanner_commands.h"
#include "flight/interpreter/verified_export.h"
#include "geometry/error.h"
#include "missions/package/fleet/timetable_file.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

using flight::AutopilotType;
using flight::Format;

constexpr std::array mavlink_formats{Format::plan, Format::waypoints, Format::kml, Format::geojson,
                                     Format::csv};
constexpr std::array dji_formats{Format::kmz, Format::kml, Format::geojson, Format::csv};
constexpr std::array litchi_formats{Format::litchi, Format::kml, Format::geojson, Format::csv};

/// Returns the requirement of a format that the mission does not meet; empty if it meets all.
std::string what_is_missing_for(Format format, const flight::FlightOptions& options) {
  const flight::Vehicle& vehicle = options.required_vehicle();
  if (format == Format::waypoints && vehicle.autopilot == AutopilotType::dji) {
    const double lack =
        flight::stop_overshoot(options.vehicle_for(vehicle, AutopilotType::ardupilot)) -
        options.budget().margin;
    if (lack > 0.0) {
      return "requires a larger margin, because an interrupted ArduCopter vehicle passes its stop; "
             "raise flight.clearance by " +
             support::short_text(std::ceil(100.0 * lack) / 100.0) + " m";
    }
  }
  if (flight::is_local(format)) return "";
  if (!options.is_georeferenced) {
    return "requires a georeference; set site.latitude_deg and site.longitude_deg";
  }
  const bool has_sea_level =
      format == Format::plan || format == Format::kml ||
      (format == Format::waypoints && vehicle.autopilot != AutopilotType::px4);
  if (!has_sea_level || options.site.geoid_undulation) return "";
  return "requires heights above mean sea level; set site.geoid_undulation";
}

/// Adapts the plan to the programs that read the format. For vehicles with another autopilot,
/// QGroundControl files use the PX4 dialect, Mission Planner files the ArduPilot dialect, and DJI
/// files the codes of a DJI vehicle. Size, energy and gimbal remain those of the vehicle.
flight::FlightPlan adapt_to_autopilot(flight::FlightPlan plan, Format format,
                                      const flight::FlightOptions& options,
                                      std::vector<std::string>& notes) {
  const bool is_dji = plan.vehicle.autopilot == AutopilotType::dji;
  const auto write_for = [&](AutopilotType autopilot, const std::string& file,
                             const std::string& whom) {
    notes.push_back(file + " is written for " + whom + ": " + plan.vehicle.name +
                    " does not read this format");
    plan.vehicle = options.vehicle_for(std::move(plan.vehicle), autopilot);
  };
  if (format == Format::plan && is_dji) write_for(AutopilotType::px4, "the .plan file", "PX4");
  if (format == Format::waypoints && is_dji) {
    write_for(AutopilotType::ardupilot, "the .waypoints file", "ArduPilot");
  }
  if (format == Format::kmz && !is_dji) {
    const auto substitute =
        std::ranges::find(options.substitutes, AutopilotType::dji, &flight::Vehicle::autopilot);
    write_for(AutopilotType::dji, "the .kmz file", substitute->name);
  }
  return plan;
}

/// Sets the returns for the plan's dialect. The route's returns are used if they were planned for
/// this dialect; otherwise new returns are searched for. Throws Error{bad_config} if there are no
/// verified returns.
void verify_autopilot_returns(flight::FlightPlan& plan, const flight::FreeSpace& space,
                              double max_height) {
  if (!plan.returns) return;
  flight::RtlProfile rtl_profile = plan.returns->rtl_profile;
  if (std::ranges::find(rtl_profile.autopilots, plan.vehicle.autopilot) !=
      rtl_profile.autopilots.end())
    return;
  rtl_profile.autopilots = {plan.vehicle.autopilot};
  // DJI vehicles do not support rally points.
  if (plan.vehicle.autopilot == AutopilotType::dji) rtl_profile.landings.resize(1);
  std::vector<flight::Segment> legs;
  for (std::size_t i = 1; i < plan.waypoints.size(); ++i) {
    legs.push_back({plan.waypoints[i - 1].position, plan.waypoints[i].position});
  }
  flight::ReturnSearch search = min_return_altitude(space, legs, rtl_profile, max_height,
                                                    flight::return_clearance(plan.clearance));
  if (!search.found) {
    throw Error(ErrorKind::bad_config, "no verified return altitude: " + search.reason);
  }
  search.found->energy = plan.returns->energy;
  plan.returns = std::move(search.found);
}

bool has_parameters(Format format) { return format == Format::plan || format == Format::waypoints; }

/// Writes the parameter file and reads it back to verify its contents.
std::string checked_parameters(const flight::FlightPlan& plan) {
  std::string text = flight::write_parameters(plan);
  const flight::AutopilotType autopilot = plan.vehicle.autopilot;
  const std::vector<flight::Parameter> read = flight::read_parameters(text);
  flight::throw_first(flight::return_problems(read, autopilot),
                      "the return parameters differ from the verified ones");
  if (flight::return_height(read, autopilot) != plan.returns->height) {
    throw Error(ErrorKind::bad_file, "the parameters do not contain the verified return altitude");
  }
  return text;
}

/// Returns the prefix of a route file's name.
std::string stem_in(std::string_view name) {
  const std::optional<std::size_t> vehicle = parse_vehicle_number(name);
  return vehicle ? make_stem(*vehicle) : "mission";
}

/// Stages a route in each format, sortie by sortie.
class RouteFiles {
 public:
  RouteFiles(const std::string& name, const flight::FlightOptions& options,
             const flight::Route& route, const flight::FreeSpace& measured,
             geometry::OutputFolder& folder, std::string stem)
      : name_(name),
        options_(options),
        route_(route),
        folder_(folder),
        stem_(std::move(stem)),
        rules_(options.rules()),
        known_(rules_),
        space_({&measured, &known_}) {}

  FlightFiles stage(std::span<const Format> formats) {
    has_one_format_ = formats.size() == 1;
    for (const Format format : formats) {
      if (const std::string lack = what_is_missing_for(format, options_); !lack.empty()) {
        leave_out(format, lack, ErrorKind::bad_config);
        continue;
      }
      for (std::size_t i = 0; i < route_.sorties.size(); ++i) stage_sortie(format, i);
    }
    for (const auto& [name, text] : parameters_) {
      folder_.write(name, text);
      files_.parameters.push_back(name);
    }
    return std::move(files_);
  }

 private:
  void add_note(const std::string& note) {
    if (std::ranges::find(files_.notes, note) == files_.notes.end()) files_.notes.push_back(note);
  }

  void leave_out(Format format, const std::string& reason, ErrorKind kind) {
    const std::string note = "no " + stem_ + flight::format_info(format).extension + ": " + reason;
    if (has_one_format_) throw Error(kind, note);
    add_note(note);
  }

  void stage_sortie(Format format, std::size_t sortie) {
    const std::string number = route_.sorties.size() > 1 ? "-" + std::to_string(sortie + 1) : "";
    std::vector<std::string> notes;
    std::vector<std::string> names{stem_ + number + flight::format_info(format).extension};
    const auto written_before = static_cast<std::ptrdiff_t>(files_.written.size());
    try {
      const flight::FlightPlan plan = plan_for(format, sortie, number, notes);
      const std::vector<flight::FlightPlan> parts = flight::split_plan(plan, format);
      if (parts.size() > 1) names = names_of_parts(format, sortie, parts.size());
      for (std::size_t i = 0; i < parts.size(); ++i) {
        const flight::ExportResult result =
            export_flight(parts[i], format, space_, folder_.stage(names[i]));
        files_.written.push_back({names[i], flight::format_info(format).heights,
                                  result.min_clearance, sortie, flight_time(parts[i]), format,
                                  result.captures});
        notes.insert(notes.end(), result.notes.begin(), result.notes.end());
      }
      if (parts.size() > 1) {
        notes.push_back(names.front() + " to " + names.back() +
                        " are one flight: set finish action \"None\" and start each file where the "
                        "previous one ends");
      }
      for (const std::string& note : notes) add_note(note);
    } catch (const Error& error) {
      files_.written.erase(files_.written.begin() + written_before, files_.written.end());
      // The files have temporary names until all are written.
      std::string reason = error.what();
      for (const std::string& name : names) {
        const std::string file = folder_.staged(name).string();
        const std::size_t name_begin = file.empty() ? std::string::npos : reason.find(file);
        if (name_begin != std::string::npos) reason.replace(name_begin, file.size(), name);
        if (!file.empty()) folder_.drop(name);
      }
      if (error.kind() == ErrorKind::bad_file) {  // Write errors are not specific to the mission.
        for (const FlightFile& written : files_.written) folder_.drop(written.name);
        throw;
      }
      leave_out(format, reason, error.kind());
    }
  }

  std::vector<std::string> names_of_parts(Format format, std::size_t sortie,
                                          std::size_t parts) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < parts; ++i) {
      names.push_back(stem_ + "-" + std::to_string(sortie + 1) + "-" + std::to_string(i + 1) +
                      flight::format_info(format).extension);
    }
    return names;
  }

  /// Returns the plan of a sortie for the format, with its returns; adds its parameters.
  flight::FlightPlan plan_for(Format format, std::size_t sortie, const std::string& number,
                              std::vector<std::string>& notes) {
    const bool supports_curves = flight::supports_curves(format);
    const auto corners = supports_curves ? flight::Corners::rounded : flight::Corners::stopped_in;
    flight::FlightPlan plan = adapt_to_autopilot(
        flight_plan(route_, sortie, name_ + number, options_.site, rules_, corners), format,
        options_, notes);
    if (!supports_curves) plan = with_runs(std::move(plan), format, notes);
    if (options_.capture.is_scanner) {
      const geometry::ScannerMount mount =
          options_.capture.mount.value_or(geometry::ScannerMount{});
      plan = flight::with_scanner_commands(
          std::move(plan), format,
          {mount.view_azimuth, mount.view_pitch, options_.capture.scans_in_flight()},
          route_.sorties[sortie].energy_left, notes);
    }
    verify_autopilot_returns(plan, space_,
                             options_.max_return_altitude(plan.pad.z(), plan.pad.z()));
    if (has_parameters(format) && plan.returns) {
      parameters_[flight::parameters_name(plan.vehicle.autopilot, stem_)] =
          checked_parameters(plan);
    }
    return plan;
  }

  /// Returns the plan with photo runs: evenly spaced photos without a stop, in a format without
  /// curves.
  flight::FlightPlan with_runs(flight::FlightPlan plan, Format format,
                               std::vector<std::string>& notes) const {
    const std::string name = stem_ + flight::format_info(format).extension;
    const bool is_fly_through = options_.style == flight::FlightStyle::pass;
    if (flight::holds_photo_runs(format) && plan.photo &&
        !plan.vehicle.needs_waypoint_per_photo()) {
      flight::FlightPlan faster = flight::with_photo_runs(plan);
      const std::size_t photos = flight::photos_in_runs(faster);
      const auto minutes = [](const flight::FlightPlan& of) {
        return flight::fixed(flight_time(of) / 60.0, 1) + " min";
      };
      if (photos > 0) {
        notes.push_back(
            plan.name + ": " + name +
            (is_fly_through ? " takes " : " could, with flight.style: fly-through, take ") +
            std::to_string(photos) + " photos without a stop, in " + minutes(faster) +
            " instead of " + minutes(plan));
      }
      if (photos > 0 && is_fly_through) return faster;
    }
    if (options_.style != flight::FlightStyle::stop) {
      notes.push_back(name + " stops " + (is_fly_through ? "at every view and " : "") +
                      "at every corner, because the format cannot define curves");
    }
    return plan;
  }

  const std::string& name_;  ///< Name of the mission.
  const flight::FlightOptions& options_;
  const flight::Route& route_;
  geometry::OutputFolder& folder_;
  std::string stem_;  ///< Prefix of all file names.
  flight::Obstacles rules_;
  flight::KnownSpace known_;
  flight::JointSpace space_;
  bool has_one_format_ = false;
  /// Parameters of all sorties, because a pilot sets them only once.
  std::map<std::string, std::string> parameters_;
  FlightFiles files_;
};

}  // namespace

std::span<const Format> package_formats(const flight::Vehicle& vehicle) {
  if (vehicle.app == flight::MissionApp::litchi) return litchi_formats;
  if (vehicle.autopilot == AutopilotType::dji) return dji_formats;
  return mavlink_formats;
}

flight::FlightOptions with_fixed_order(flight::FlightOptions options) {
  options.order = flight::VisitOrder::survey;
  return options;
}

std::vector<flight::CapturePoint> make_capture_points(const flight::FlightOptions& options,
                                                      const std::vector<geometry::View>& views,
                                                      const std::vector<Polyline>& paths) {
  const std::optional<geometry::ScannerMount>& mount = options.capture.mount;
  const int captures = options.capture.scans_in_flight() ? 0 : 1;
  std::vector<flight::CapturePoint> capture_points;
  for (std::uint32_t i = 0; i < views.size(); ++i) {
    capture_points.push_back({mount ? geometry::nose_view(*mount, views[i]) : views[i],
                              options.rest_before(), captures, i, options.rest_after(),
                              paths.at(i)});
  }
  return capture_points;
}

flight::Route plan_flight(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                          const Eigen::Vector3d& pad, const std::vector<geometry::View>& views,
                          const std::vector<Polyline>& paths,
                          std::span<const flight::LandingSurface> landing_surfaces,
                          std::stop_token stop) {
  return plan_flight(options, measured, pad, make_capture_points(options, views, paths),
                     landing_surfaces, std::move(stop));
}

flight::Route plan_flight(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                          const Eigen::Vector3d& pad,
                          std::vector<flight::CapturePoint> capture_points,
                          std::span<const flight::LandingSurface> landing_surfaces,
                          std::stop_token stop) {
  flight::Obstacles rules = options.rules();
  const flight::KnownSpace known(rules);
  // The climb starts on the measured ground. The pilot must check the ground at the pad.
  const flight::KnownSpace pad_space(without_ground(std::move(rules)));
  const flight::JointSpace joint({&measured, &known});
  const flight::InterruptibleSpace space(joint, std::move(stop));
  flight::RouteOptions route = options.route(pad);
  route.landing_surfaces = options.landing_surfaces(pad, landing_surfaces);
  return plan_route(std::move(capture_points), options.required_vehicle(), space, &pad_space,
                    route);
}

FlightFiles stage_flight(const std::string& name, const flight::FlightOptions& options,
                         const flight::Route& route, const flight::FreeSpace& measured,
                         std::span<const Format> formats, geometry::OutputFolder& folder,
                         const std::string& stem) {
  return RouteFiles(name, options, route, measured, folder, stem).stage(formats);
}

bool is_flight_file(std::string_view name) {
  const auto is_parameters = [&](AutopilotType autopilot) {
    return name == flight::parameters_name(autopilot, stem_in(name));
  };
  return name == timetable_name || is_parameters(AutopilotType::ardupilot) ||
         is_parameters(AutopilotType::px4) ||
         std::ranges::any_of(flight::formats(), [&](const flight::FormatInfo& info) {
           return is_flight_file(name, info.format);
         });
}

bool is_flight_file(std::string_view name, Format format) {
  const std::string stem = stem_in(name);
  if (!name.starts_with(stem)) return false;
  name.remove_prefix(stem.size());
  while (name.starts_with('-')) {  // the sortie, and its part
    name.remove_prefix(std::min(name.size(), name.find_first_not_of("0123456789", 1)));
  }
  return name == flight::format_info(format).extension;
}

}  // namespace skycap::missions::package
