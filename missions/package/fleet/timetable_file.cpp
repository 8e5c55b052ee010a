#include "missions/package/fleet/timetable_file.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/pose/world.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

constexpr std::string_view header = "vehicle,name,sortie,file,start_s,landing_s,pad_x,pad_y,pad_z";
constexpr std::string_view stem = "fleet-";
/// Maximum file size [bytes], sufficient for thousands of sorties.
constexpr std::size_t largest_timetable = 1 << 20;

/// Converts an integer from 1 to an index from 0. Returns an empty value for other text.
std::optional<std::size_t> index_in(std::string_view text) {
  const std::optional<double> number = flight::to_number(text);
  if (!number || *number < 1.0 || *number > 1e6 || *number != std::floor(*number)) return {};
  return static_cast<std::size_t>(*number) - 1;
}

/// Parser of one row. Error messages start with file name and line.
class RowReader {
 public:
  RowReader(std::string location, std::span<const std::string> vehicles)
      : location_(std::move(location)), vehicles_(vehicles) {}

  TimetableRow read(const std::string& line) const {
    const std::vector<std::string> fields = flight::split(line, ',');
    if (fields.size() != 9)
      fail("has " + std::to_string(fields.size()) + " fields; it must have 9");
    TimetableRow row;
    row.vehicle = index(fields[0], "vehicle");
    row.name = fields[1];
    check_vehicle(row);
    row.sortie = index(fields[2], "sortie");
    row.file = fields[3];
    const bool is_in_same_folder = row.file.find('/') == std::string::npos;
    if (!is_in_same_folder || parse_vehicle_number(row.file) != row.vehicle) {
      fail("the file \"" + row.file + "\" is not one of " + make_stem(row.vehicle) + ".*");
    }
    row.start = number(fields[4], "start_s");
    row.landing = number(fields[5], "landing_s");
    if (row.start < 0.0 || row.landing <= row.start)
      fail("the landing time must be after the start time");
    for (int axis = 0; axis < 3; ++axis) row.pad[axis] = number(fields[6 + axis], "pad");
    geometry::require_valid_position(row.pad, location_ + "pad");
    return row;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::bad_file, location_ + what);
  }

  std::size_t index(const std::string& field, const std::string& name) const {
    const auto index = index_in(field);
    if (!index) fail(name + " is \"" + field + "\"; it must be an integer of at least 1");
    return *index;
  }

  double number(const std::string& field, const std::string& name) const {
    const auto number = flight::to_number(field);
    if (!number) fail(name + " is \"" + field + "\"; it must be a number");
    return *number;
  }

  void check_vehicle(const TimetableRow& row) const {
    if (row.vehicle >= vehicles_.size()) {
      fail("unknown vehicle " + std::to_string(row.vehicle + 1) + ": flight.vehicles has " +
           std::to_string(vehicles_.size()));
    }
    if (row.name == vehicles_[row.vehicle]) return;
    fail("vehicle " + std::to_string(row.vehicle + 1) + " is " + vehicles_[row.vehicle] +
         " in flight.vehicles, not " + row.name);
  }

  std::string location_;
  std::span<const std::string> vehicles_;  ///< Vehicles of the mission.
};

}  // namespace

std::string timetable_csv(std::span<const TimetableRow> rows) {
  std::string csv = std::string(header) + "\n";
  for (const TimetableRow& row : rows) {
    csv += std::to_string(row.vehicle + 1) + "," + row.name + "," + std::to_string(row.sortie + 1) +
           "," + row.file;
    for (const double number : {row.start, row.landing, row.pad.x(), row.pad.y(), row.pad.z()}) {
      csv.append(",").append(support::exact_text(number));
    }
    csv += "\n";
  }
  return csv;
}

std::vector<TimetableRow> read_timetable(const std::filesystem::path& path,
                                         const flight::FlightOptions& options) {
  const std::string text = geometry::read_file(path, largest_timetable);
  const std::vector<std::string> lines = flight::split_lines(text);
  if (lines.empty() || lines.front() != header) {
    throw Error(
        ErrorKind::bad_file,
        path.string() + ":1: is not a timetable; its first line must be " + std::string(header));
  }
  std::vector<TimetableRow> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::string location = path.string() + ":" + std::to_string(i + 1) + ": ";
    TimetableRow row = RowReader(location, options.fleet.names).read(lines[i]);
    const bool is_twice = std::ranges::any_of(rows, [&](const TimetableRow& other) {
      return other.vehicle == row.vehicle && other.sortie == row.sortie;
    });
    if (is_twice) throw Error(ErrorKind::bad_file, location + "a sortie is listed twice");
    rows.push_back(std::move(row));
  }
  if (!rows.empty()) return rows;
  throw Error(ErrorKind::bad_file, path.string() + ": contains no sorties");
}

std::string make_stem(std::size_t vehicle) {
  return std::string(stem) + std::to_string(vehicle + 1);
}

std::optional<std::size_t> parse_vehicle_number(std::string_view name) {
  if (!name.starts_with(stem)) return std::nullopt;
  name.remove_prefix(stem.size());
  const std::size_t end = name.find_first_not_of("0123456789");
  if (end == std::string_view::npos || (name[end] != '.' && name[end] != '-')) return std::nullopt;
  return index_in(name.substr(0, end));
}

bool is_fleet_file(std::string_view name) {
  return name == timetable_name || parse_vehicle_number(name).has_value();
}

flight::FlightOptions find_file_flight(const std::filesystem::path& file,
                                       const flight::FlightOptions& options) {
  const std::optional<std::size_t> vehicle = parse_vehicle_number(file.filename().string());
  if (!vehicle || !options.is_fleet()) return options;
  const std::filesystem::path table = file.parent_path() / timetable_name;
  for (const TimetableRow& row : read_timetable(table, options)) {
    if (row.vehicle == *vehicle) return options.for_vehicle(*vehicle, row.pad);
  }
  throw Error(ErrorKind::bad_file, table.string() + ": contains no sortie of vehicle " +
                                       std::to_string(*vehicle + 1) + ", whose file is " +
                                       file.filename().string());
}

flight::Format own_format(const flight::Vehicle& vehicle) {
  if (vehicle.app == flight::MissionApp::litchi) return flight::Format::litchi;
  if (vehicle.autopilot == flight::AutopilotType::dji) return flight::Format::kmz;
  return vehicle.autopilot == flight::AutopilotType::px4 ? flight::Format::plan
                                                         : flight::Format::waypoints;
}

}  // namespace skycap::missions::package
