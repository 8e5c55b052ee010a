#include "missions/package/flight_files.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "flight/export/parameters.h"
#include "flight/interpreter/certified_export.h"
#include "flight/space/clearance.h"
#include "flight/space/interruptible_space.h"
#include "geometry/error.h"
#include "missions/package/fleet/timetable_file.h"

namespace skycap::missions::package {
namespace {

using flight::Dialect;
using flight::Format;

constexpr std::array formats_of_mavlink{Format::plan, Format::waypoints, Format::kml,
                                        Format::geojson, Format::csv};
constexpr std::array formats_of_dji{Format::kmz, Format::kml, Format::geojson, Format::csv};

/// Returns true for formats in the local frame, which do not require a georeference.
bool is_local(Format format) {
  return format == Format::csv || format == Format::ned_csv || format == Format::tum;
}

/// Returns the requirement of a format that the mission does not meet; empty if it meets all.
std::string what_is_missing_for(Format format, const flight::FlightOptions& options) {
  if (is_local(format)) return "";
  if (!options.has_place) {
    return "requires a georeference; set site.latitude_deg and site.longitude_deg";
  }
  const bool has_sea_level =
      format == Format::plan || format == Format::kml ||
      (format == Format::waypoints && options.flown().dialect != Dialect::px4);
  if (!has_sea_level || options.site.geoid_undulation) return "";
  return "requires heights above mean sea level; set site.geoid_undulation";
}

/// Adapts the plan to the programs that read the format. For vehicles with another autopilot,
/// QGroundControl files use the PX4 dialect, Mission Planner files the ArduPilot dialect, and DJI
/// files the codes of a DJI vehicle. Size, energy and gimbal remain those of the vehicle.
flight::FlightPlan in_dialect(flight::FlightPlan plan, Format format,
                              const flight::FlightOptions& options,
                              std::vector<std::string>& notes) {
  const bool is_dji = plan.vehicle.dialect == Dialect::dji;
  const auto write_for = [&](Dialect dialect, const std::string& file, const std::string& whom) {
    notes.push_back(file + " is written for " + whom + ": " + plan.vehicle.name +
                    " does not read this format");
    plan.vehicle = options.flown_by(std::move(plan.vehicle), dialect);
  };
  if (format == Format::plan && is_dji) write_for(Dialect::px4, "the .plan file", "PX4");
  if (format == Format::waypoints && is_dji) {
    write_for(Dialect::ardupilot, "the .waypoints file", "ArduPilot");
  }
  if (format == Format::kmz && !is_dji) {
    const auto stand_in =
        std::ranges::find(options.stand_ins, Dialect::dji, &flight::Vehicle::dialect);
    write_for(Dialect::dji, "the .kmz file", stand_in->name);
  }
  return plan;
}

/// Sets the returns for the plan's dialect. The route's returns are used if they were planned for
/// this dialect; otherwise new returns are searched for. Throws Error{bad_config} if there are no
/// verified returns.
void certify_dialect(flight::FlightPlan& plan, const flight::FreeSpace& space, double highest) {
  if (!plan.returns) return;
  flight::ReturnLaw law = plan.returns->law;
  if (std::ranges::find(law.dialects, plan.vehicle.dialect) != law.dialects.end()) return;
  law.dialects = {plan.vehicle.dialect};
  // DJI vehicles do not support rally points.
  if (plan.vehicle.dialect == Dialect::dji) law.landings.resize(1);
  std::vector<flight::Segment> legs;
  for (std::size_t i = 1; i < plan.waypoints.size(); ++i) {
    legs.push_back({plan.waypoints[i - 1].position, plan.waypoints[i].position});
  }
  flight::ReturnSearch search =
      least_return(space, legs, law, highest, flight::return_clearance(plan.clearance));
  if (!search.found) {
    throw Error(ErrorKind::bad_config, "no verified return altitude: " + search.why);
  }
  search.found->energy = plan.returns->energy;
  plan.returns = std::move(search.found);
}

bool has_parameters(Format format) { return format == Format::plan || format == Format::waypoints; }

/// Writes the parameter file and reads it back to verify its contents.
std::string checked_parameters(const flight::FlightPlan& plan) {
  std::string text = flight::write_parameters(plan);
  const flight::Dialect dialect = plan.vehicle.dialect;
  const std::vector<flight::Parameter> read = flight::read_parameters(text);
  flight::throw_first(flight::return_problems(read, dialect),
                      "the return parameters are not those that were verified");
  if (flight::return_height(read, dialect) != plan.returns->height) {
    throw Error(ErrorKind::bad_file, "the parameters do not contain the verified return altitude");
  }
  return text;
}

/// Returns the prefix of a route file's name.
std::string stem_in(std::string_view name) {
  const std::optional<std::size_t> vehicle = vehicle_of_file(name);
  return vehicle ? stem_of(*vehicle) : "mission";
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

  void leave_out(Format format, const std::string& why, ErrorKind kind) {
    const std::string note = "no " + stem_ + flight::format_info(format).ending + ": " + why;
    if (has_one_format_) throw Error(kind, note);
    add_note(note);
  }

  void stage_sortie(Format format, std::size_t sortie) {
    const std::string number = route_.sorties.size() > 1 ? "-" + std::to_string(sortie + 1) : "";
    const std::string name = stem_ + number + flight::format_info(format).ending;
    const std::filesystem::path file = folder_.stage(name);
    try {
      write_sortie(format, sortie, number, name, file);
    } catch (const Error& error) {
      folder_.drop(name);
      if (error.kind() == ErrorKind::bad_file) {  // Write errors are not specific to the mission.
        for (const FlightFile& written : files_.written) folder_.drop(written.name);
        throw;
      }
      // Files have temporary names until all are written.
      std::string why = error.what();
      const std::size_t place = why.find(file.string());
      if (place != std::string::npos) why.replace(place, file.string().size(), name);
      leave_out(format, why, error.kind());
    }
  }

  /// Adds notes and files to the lists only after the file is verified.
  void write_sortie(Format format, std::size_t sortie, const std::string& number,
                    const std::string& name, const std::filesystem::path& file) {
    const flight::FormatInfo& info = flight::format_info(format);
    std::vector<std::string> notes;
    const bool holds_curves = flight::holds_curves(format);
    if (!holds_curves && options_.style != flight::FlightStyle::stop) {
      const bool passes = options_.style == flight::FlightStyle::pass;
      notes.push_back(stem_ + info.ending + " stops " + (passes ? "at every view and " : "") +
                      "in every corner: the format cannot define curves");
    }
    const auto corners = holds_curves ? flight::Corners::flown_round : flight::Corners::stopped_in;
    flight::FlightPlan plan =
        in_dialect(flight_plan(route_, sortie, name_ + number, options_.site, rules_, corners),
                   format, options_, notes);
    certify_dialect(plan, space_, options_.highest_return(plan.pad.z(), plan.pad.z()));
    if (has_parameters(format) && plan.returns) {
      parameters_[flight::parameters_name(plan.vehicle.dialect, stem_)] = checked_parameters(plan);
    }
    const flight::ExportResult result = export_flight(plan, format, space_, file);
    files_.written.push_back({name, info.heights, result.min_clearance, sortie, flight_time(plan)});
    for (const std::string& note : notes) add_note(note);
    for (const std::string& note : result.notes) add_note(note);
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

std::span<const Format> package_formats(Dialect dialect) {
  if (dialect == Dialect::dji) return formats_of_dji;
  return formats_of_mavlink;
}

flight::FlightOptions in_given_order(flight::FlightOptions options) {
  options.order = flight::VisitOrder::survey;
  return options;
}

std::vector<flight::Station> stations_of(const flight::FlightOptions& options,
                                         const std::vector<geometry::View>& views,
                                         const std::vector<Way>& ways) {
  const std::optional<geometry::ScannerMount>& mount = options.capture.mount;
  const int shots = options.capture.scans_in_flight() ? 0 : 1;
  std::vector<flight::Station> stations;
  for (std::uint32_t i = 0; i < views.size(); ++i) {
    stations.push_back({mount ? geometry::nose_view(*mount, views[i]) : views[i],
                        options.rest_before(), shots, i, options.rest_after(), ways.at(i)});
  }
  return stations;
}

flight::Route plan_flight(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                          const Eigen::Vector3d& pad, const std::vector<geometry::View>& views,
                          const std::vector<Way>& ways, std::span<const flight::PadGround> grounds,
                          std::stop_token stop) {
  return plan_flight(options, measured, pad, stations_of(options, views, ways), grounds,
                     std::move(stop));
}

flight::Route plan_flight(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                          const Eigen::Vector3d& pad, std::vector<flight::Station> stations,
                          std::span<const flight::PadGround> grounds, std::stop_token stop) {
  flight::Obstacles rules = options.rules();
  const flight::KnownSpace known(rules);
  // The climb starts on the measured ground. The pilot must check the ground at the pad.
  const flight::KnownSpace pad_space(without_ground(std::move(rules)));
  const flight::JointSpace joint({&measured, &known});
  const flight::InterruptibleSpace space(joint, std::move(stop));
  flight::RouteOptions route = options.route(pad);
  route.grounds = options.grounds(pad, grounds);
  return plan_route(std::move(stations), options.flown(), space, &pad_space, route);
}

FlightFiles stage_flight(const std::string& name, const flight::FlightOptions& options,
                         const flight::Route& route, const flight::FreeSpace& measured,
                         std::span<const Format> formats, geometry::OutputFolder& folder,
                         const std::string& stem) {
  return RouteFiles(name, options, route, measured, folder, stem).stage(formats);
}

bool is_flight_file(std::string_view name) {
  const auto is_parameters = [&](Dialect dialect) {
    return name == flight::parameters_name(dialect, stem_in(name));
  };
  return name == timetable_name || is_parameters(Dialect::ardupilot) ||
         is_parameters(Dialect::px4) ||
         std::ranges::any_of(flight::formats(), [&](const flight::FormatInfo& info) {
           return is_flight_file(name, info.format);
         });
}

bool is_flight_file(std::string_view name, Format format) {
  const std::string stem = stem_in(name);
  if (!name.starts_with(stem)) return false;
  name.remove_prefix(stem.size());
  if (name.starts_with('-')) {
    name.remove_prefix(std::min(name.size(), name.find_first_not_of("0123456789", 1)));
  }
  return name == flight::format_info(format).ending;
}

}  // namespace skycap::missions::package
