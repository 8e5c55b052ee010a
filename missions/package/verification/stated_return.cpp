#include "missions/package/verification/stated_return.h"

#include <vector>

#include "flight/export/export.h"
#include "flight/export/parameters.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/package/fleet/timetable_file.h"

namespace skycap::missions::package {

using flight::AutopilotType;

namespace {

std::optional<StatedHeight> stated_by_parameters(const std::filesystem::path& route,
                                                 AutopilotType autopilot) {
  const std::optional<std::size_t> vehicle = parse_vehicle_number(route.filename().string());
  const std::string name =
      flight::parameters_name(autopilot, vehicle ? make_stem(*vehicle) : "mission");
  const std::filesystem::path file = route.parent_path() / name;
  if (name.empty() || !std::filesystem::exists(file)) return std::nullopt;
  // Maximum file size [bytes]; a vehicle has some thousand parameters.
  constexpr std::size_t largest = 1 << 20;
  const std::string text = geometry::read_file(file, largest);
  try {
    const std::vector<flight::Parameter> parameters = flight::read_parameters(text);
    const std::optional<double> height = flight::return_height(parameters, autopilot);
    if (!height) return std::nullopt;
    return StatedHeight{*height, name, flight::return_problems(parameters, autopilot)};
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
}

}  // namespace

std::optional<AutopilotType> autopilot_for_file(const std::filesystem::path& file,
                                                const flight::Vehicle& vehicle) {
  const std::string extension = file.extension().string();
  if (extension == ".kmz" || file.string().ends_with(".litchi.csv")) return AutopilotType::dji;
  if (extension != ".plan" && extension != ".waypoints" && extension != ".txt") return std::nullopt;
  if (vehicle.autopilot != AutopilotType::dji) return vehicle.autopilot;
  return extension == ".plan" ? AutopilotType::px4 : AutopilotType::ardupilot;
}

std::optional<StatedHeight> stated_height(const std::filesystem::path& route,
                                          const std::optional<double>& given,
                                          AutopilotType autopilot) {
  if (given) return StatedHeight{*given, "--return-altitude", {}};
  if (const auto height = flight::read_return_height(route)) {
    return StatedHeight{*height, "globalRTHHeight", {}};
  }
  return stated_by_parameters(route, autopilot);
}

}  // namespace skycap::missions::package
