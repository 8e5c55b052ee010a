#include "missions/package/verification/stated_return.h"

#include <vector>

#include "flight/export/export.h"
#include "flight/export/parameters.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/package/fleet/timetable_file.h"

namespace skycap::missions::package {

using flight::Dialect;

namespace {

std::optional<StatedHeight> stated_by_parameters(const std::filesystem::path& route,
                                                 Dialect dialect) {
  const std::optional<std::size_t> vehicle = vehicle_of_file(route.filename().string());
  const std::string name =
      flight::parameters_name(dialect, vehicle ? stem_of(*vehicle) : "mission");
  const std::filesystem::path file = route.parent_path() / name;
  if (name.empty() || !std::filesystem::exists(file)) return std::nullopt;
  // Maximum file size [bytes]; a vehicle has some thousand parameters.
  constexpr std::size_t largest = 1 << 20;
  const std::string text = geometry::read_file(file, largest);
  try {
    const std::vector<flight::Parameter> parameters = flight::read_parameters(text);
    const std::optional<double> height = flight::return_height(parameters, dialect);
    if (!height) return std::nullopt;
    return StatedHeight{*height, name, flight::return_problems(parameters, dialect)};
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
}

}  // namespace

std::optional<Dialect> dialect_of(const std::filesystem::path& file,
                                  const flight::Vehicle& vehicle) {
  const std::string ending = file.extension().string();
  if (ending == ".kmz" || file.string().ends_with(".litchi.csv")) return Dialect::dji;
  if (ending != ".plan" && ending != ".waypoints" && ending != ".txt") return std::nullopt;
  if (vehicle.dialect != Dialect::dji) return vehicle.dialect;
  return ending == ".plan" ? Dialect::px4 : Dialect::ardupilot;
}

std::optional<StatedHeight> stated_height(const std::filesystem::path& route,
                                          const std::optional<double>& given, Dialect dialect) {
  if (given) return StatedHeight{*given, "--return-altitude", {}};
  if (const auto height = flight::read_return_height(route)) {
    return StatedHeight{*height, "globalRTHHeight", {}};
  }
  return stated_by_parameters(route, dialect);
}

}  // namespace skycap::missions::package
