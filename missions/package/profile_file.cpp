#include "missions/package/profile_file.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "flight/export/text.h"
#include "geometry/error.h"

namespace skycap::missions::package {
namespace {

using flight::ObstacleKind;
using flight::ProfilePart;
using flight::ProfilePiece;

constexpr double profile_step = 1.0;
constexpr double max_profile_pieces = 2000.0;

constexpr const char* profile_header =
    "sortie,part,from_m,to_m,x,y,z,height_m,ground_m,ground,clearance_m,required_m,kind,"
    "nearest_x,nearest_y,nearest_z,nearest";
constexpr std::size_t profile_columns = 17;

const char* name_of(ProfilePart part) {
  if (part == ProfilePart::climb) return "climb";
  return part == ProfilePart::leg ? "leg" : "landing";
}

const char* kind_of(const ProfilePiece& piece) {
  if (!piece.clearance) return "not verified";
  switch (piece.closest.kind) {
    case ObstacleKind::none:
      return "none";
    case ObstacleKind::unknown_space:
      return "unknown";
    case ObstacleKind::occupied_space:
      return "measured";
    case ObstacleKind::no_fly:
    case ObstacleKind::fence:
      return "airspace";
    case ObstacleKind::ground:
      return "ground";
    default:
      return "object";
  }
}

/// Names may contain commas, so they are the last field. Line breaks would end the row.
std::string one_line(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return name;
}

std::string row_text(const ProfilePiece& piece, const flight::FlightOptions& options,
                     const flight::Route& route) {
  const auto number = [](double value) { return flight::fixed(value, 3); };
  const Eigen::Vector2d position = piece.to.head<2>();
  const double pad = route.options.takeoff.z();
  const std::optional<double> terrain =
      options.airspace.terrain ? options.airspace.terrain(position) : std::nullopt;
  std::string row = std::to_string(piece.sortie + 1) + "," + name_of(piece.part);
  for (const double value :
       {piece.begin, piece.end, piece.to.x(), piece.to.y(), piece.to.z(), piece.to.z() - pad,
        terrain.value_or(options.ground_at(position)) - pad}) {
    row += "," + number(value);
  }
  row += terrain ? ",terrain," : ",assumed,";
  // Rounded down, so that the table never states more than what is verified.
  constexpr double half_digit = 0.0005;
  if (piece.clearance) row += number(std::max(0.0, *piece.clearance - half_digit));
  row += "," + number(route.clearance) + "," + kind_of(piece);
  const bool has_nearest = piece.clearance && piece.closest.kind != ObstacleKind::none;
  for (int axis = 0; axis < 3; ++axis) {
    row += ",";
    if (has_nearest) row += number(piece.closest.on_obstacle[axis]);
  }
  return row + "," + (has_nearest ? one_line(piece.obstacle) : "") + "\n";
}

}  // namespace

std::vector<ProfilePiece> make_profile(const flight::FlightOptions& options,
                                       const flight::Route& route,
                                       const flight::FreeSpace& measured,
                                       const std::stop_token& stop) {
  const flight::KnownSpace rules(options.rules());
  const flight::JointSpace space({&measured, &rules});
  return route_profile(route, space, std::max(profile_step, route.length / max_profile_pieces),
                       stop);
}

std::string profile_csv(const std::vector<ProfilePiece>& pieces,
                        const flight::FlightOptions& options, const flight::Route& route) {
  std::string text = std::string(profile_header) + "\n";
  for (const ProfilePiece& piece : pieces) text += row_text(piece, options, route);
  return text;
}

void stage_profile(const flight::FlightOptions& options, const flight::Route& route,
                   const flight::FreeSpace& measured, geometry::OutputFolder& folder,
                   const std::stop_token& stop) {
  if (route.sorties.empty() || stop.stop_requested()) return;
  const std::vector<ProfilePiece> pieces = make_profile(options, route, measured, stop);
  if (stop.stop_requested()) return;
  folder.write(profile_name, profile_csv(pieces, options, route));
}

std::vector<ProfileRow> read_profile(const std::string& text) {
  std::vector<ProfileRow> rows;
  const std::vector<std::string> lines = flight::split_lines(text);
  const auto fail = [](std::size_t line, const std::string& what) {
    throw Error(ErrorKind::bad_file, "line " + std::to_string(line) + " " + what);
  };
  if (lines.empty() || lines.front() != profile_header) fail(1, "is not the header of a profile");
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> fields = flight::split(lines[i], ',');
    if (fields.size() < profile_columns) fail(i + 1, "has too few fields");
    const auto number = [&](std::size_t field) {
      const std::optional<double> value = flight::to_number(fields[field]);
      if (!value) fail(i + 1, "has no number in field " + std::to_string(field + 1));
      return *value;
    };
    ProfileRow row{.part = fields[1],
                   .begin = number(2),
                   .end = number(3),
                   .height = number(7),
                   .ground = number(8),
                   .is_terrain = fields[9] == "terrain",
                   .clearance = fields[10].empty() ? 0.0 : number(10),
                   .required = number(11),
                   .kind = fields[12],
                   .obstacle = fields[16]};
    for (std::size_t rest = profile_columns; rest < fields.size(); ++rest) {
      row.obstacle += "," + fields[rest];
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace skycap::missions::package
