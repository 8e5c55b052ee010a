#include "missions/wizard/target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/pose/prism.h"
#include "missions/site_data/missing_values.h"
#include "missions/site_data/site_priors.h"

namespace skycap::missions::wizard {
namespace {

using Eigen::Vector2d;
using site_data::Object;
using site_data::Role;
using site_data::Source;

/// Maximum distance between a click and the selected object [m].
constexpr double near_click = 10.0;

bool is_over(const geometry::Mesh& mesh, const Vector2d& position) {
  return std::ranges::any_of(mesh.triangles, [&](const auto& triangle) {
    std::array<Vector2d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh.vertices[triangle[i]].template head<2>();
    return geometry::turn(corners[0], corners[1], corners[2]) != 0.0 &&
           geometry::contains(corners, position);
  });
}

/// Returns the horizontal distance [m] from a position to an object: zero above its surface,
/// otherwise to its bounding box.
double distance(const Object& object, const Vector2d& position) {
  if (is_over(object.mesh, position)) return 0.0;
  const Eigen::AlignedBox3d box = geometry::bounding_box(object.mesh);
  const Eigen::AlignedBox2d base(box.min().head<2>().eval(), box.max().head<2>().eval());
  return std::max(0.01, base.exteriorDistance(position));
}

std::string clicked(const std::vector<Source>& files, const Click& click) {
  const std::string file = files[0].file.string();
  const std::vector<Object> objects =
      read_things(files, {}, {click.latitude_deg, click.longitude_deg, 0.0}).objects;
  const Object* nearest = nullptr;
  double min = std::numeric_limits<double>::infinity();
  for (const Object& object : objects) {
    const double here = distance(object, Vector2d::Zero());
    if (here < min) nearest = &object;
    min = std::min(min, here);
  }
  if (nearest == nullptr || min > near_click) {
    throw Error(
        ErrorKind::bad_config,
        fmt::format("{}: contains no object within {:.0f} m of latitude {:.7f}, longitude {:.7f}{}",
                    file, near_click, click.latitude_deg, click.longitude_deg,
                    nearest == nullptr ? ""
                                       : fmt::format("; the nearest object, {}, is {:.0f} m away",
                                                     nearest->id, min)));
  }
  require_single(objects, nearest->id, file);
  return nearest->id;
}

/// Returns the identifiers of the selected objects.
std::vector<std::string> picked(const std::vector<Source>& files, const Pick& pick) {
  if (pick.click) return {clicked(files, *pick.click)};
  Source source = files[0];
  source.role = Role::target;
  source.select.ids = pick.ids;
  source.select.attributes = pick.attributes;
  std::vector<std::string> ids;
  for (const Object& object :
       site_data::read_prior(source,
                             {.origin = site_data::compute_centre(source), .takeoff_z = 0.0},
                             [](const Vector2d&) {
                               return std::optional(0.0);  // the terrain is not required here
                             })
           .objects) {
    ids.push_back(object.id);
  }
  if (ids.size() == 1 || !pick.ids.empty()) return ids;
  std::string some;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, ids.size()); ++i) {
    some += (i == 0 ? "" : ", ") + ids[i];
  }
  throw Error(
      ErrorKind::bad_config,
      fmt::format("{}: contains {} objects ({}{}); choose one with --id, --at or --attribute",
                  source.file.string(), ids.size(), some, ids.size() > 5 ? ", ..." : ""));
}

/// Throws one error that lists all values that the files lack.
void require_complete(const std::vector<Source>& files) {
  std::string text;
  for (const Source& source : files) {
    const site_data::MissingValues missing = site_data::missing_values(source);
    std::string what, remedy;
    const auto add = [](std::string& list, const std::string& item) {
      list += (list.empty() ? "" : ", ") + item;
    };
    if (missing.crs && &source == &files[0]) {
      add(what, "coordinate reference system");
      add(remedy, "--crs such as EPSG:25832");
    }
    if (!missing.outline_without_height.empty()) {
      add(what, "height of object " + missing.outline_without_height);
      add(remedy, "--height METRES");
    }
    if (missing.base) {
      add(what, "base height of outlines");
      add(remedy, "--base ground, --base METRES with --vertical, or --terrain FILE");
    } else if (missing.vertical) {
      add(what, "vertical datum");
      add(remedy, "--vertical ellipsoid or geoid");
    }
    if (what.empty()) continue;
    text +=
        (text.empty() ? "" : "; ") + source.file.string() + ": missing " + what + "; set " + remedy;
  }
  if (!text.empty()) throw Error(ErrorKind::bad_config, text);
}

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

}  // namespace

std::vector<Source> collect_files(const SiteRequest& request) {
  const auto file = [&](const std::filesystem::path& path, Role role) {
    Source source;
    source.file = path;
    source.role = role;
    return source;
  };
  // Heights that count from the take-off point are those of the map's outlines alone.
  const bool counts_from_takeoff =
      request.import_options.vertical == site_data::HeightDatum::takeoff;
  const site_data::Assumptions assumed{
      request.import_options.crs,
      counts_from_takeoff ? std::nullopt : request.import_options.vertical,
      request.terrain.has_value()};
  Source map = file(request.map, Role::obstacle);
  map.crs = request.import_options.crs;  // instead of the file's own
  if (counts_from_takeoff) map.vertical = request.import_options.vertical;
  map.base = request.import_options.base;
  map.height = request.import_options.height;
  // An error of the whole map's height does not affect a mission without other files. Those must
  // specify their datum.
  site_data::Assumptions assumed_of_map = assumed;
  assumed_of_map.has_heights_above_geoid = !map.vertical;
  std::vector<Source> files{site_data::completed(map, assumed_of_map)};
  for (const std::filesystem::path& path : request.obstacles) {
    files.push_back(site_data::completed(file(path, Role::obstacle), assumed));
  }
  if (request.terrain) {
    files.push_back(site_data::completed(file(*request.terrain, Role::terrain), assumed));
  }
  require_complete(files);
  return files;
}

bool assumes_geoid(const SiteRequest& request) {
  if (request.import_options.vertical) return false;
  Source map;
  map.file = request.map;
  map.crs = request.import_options.crs;
  const site_data::MissingValues missing = site_data::missing_values(map);
  return missing.vertical && !missing.base;
}

std::vector<Object> list_things(const std::vector<Source>& files) {
  Source source = files[0];
  source.role = Role::target;
  const flight::GeodeticPoint origin = site_data::compute_centre(source);
  return read_things(files, {}, origin).objects;
}

std::vector<Source> select_sources(const std::vector<Source>& files,
                                   const std::vector<std::string>& target) {
  std::vector<Source> sources = files;
  sources.insert(sources.begin(), files[0]);
  sources[0].role = Role::target;
  sources[0].select.ids = target;
  return sources;
}

site_data::Prior read_things(const std::vector<Source>& files, const site_data::Selection& select,
                             const flight::GeodeticPoint& origin) {
  std::vector<Source> sources = select_sources(files, {});
  sources[0].select = select;
  std::erase_if(sources, [](const Source& source) {
    return source.role != Role::target && source.role != Role::terrain;
  });
  const auto failed = [](std::size_t, const std::string& what) {
    throw Error(ErrorKind::bad_config, what);
  };
  // Heights that count from the take-off point are those of the ground here.
  return site_data::read_site_priors(sources, {.origin = origin, .takeoff_z = 0.0}, failed)
      .priors[0];
}

void require_single(const std::vector<Object>& objects, const std::string& id,
                    const std::string& file) {
  if (std::ranges::count(objects, id, &Object::id) <= 1) return;
  throw Error(
      ErrorKind::bad_config,
      fmt::format("{}: contains several objects named {}; give them unique names", file, id));
}

Target find_target(const std::vector<Source>& files, const Pick& pick) {
  Target target{.ids = picked(files, pick), .origin = {}, .box = {}};
  target.origin = site_data::compute_centre(select_sources(files, target.ids)[0]);
  constexpr double centimetre = 1e-7;  // one centimetre of latitude [degrees]
  target.origin.latitude_deg = rounded(target.origin.latitude_deg, centimetre);
  target.origin.longitude_deg = rounded(target.origin.longitude_deg, centimetre);
  const site_data::Prior found = read_things(files, {.ids = target.ids}, target.origin);
  for (const Object& object : found.objects) {
    target.box.extend(geometry::bounding_box(object.mesh));
  }
  target.uncertainty = found.uncertainty;
  // Moving the origin vertically changes only the heights in the frame.
  target.origin.height = rounded(target.box.min().z(), 0.01);
  target.box.translate(Eigen::Vector3d(0.0, 0.0, -target.origin.height));
  return target;
}

}  // namespace skycap::missions::wizard
