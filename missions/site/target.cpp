#include "missions/site/target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/place/prism.h"
#include "missions/prior/site_priors.h"

namespace skycap::missions::site {
namespace {

using Eigen::Vector2d;
using prior::Object;
using prior::Role;
using prior::Source;

/// What is clicked on is no farther from the click than this [m].
constexpr double near_click = 10.0;

Source source_of(const std::filesystem::path& file, Role role, const Reading& reading) {
  Source source;
  source.file = file;
  source.role = role;
  source.crs = reading.crs;
  source.vertical = reading.vertical;
  return source;
}

/// Of the file that the target is in: its outlines stand on the terrain if there is one.
Source map_source(const Wishes& wishes, Role role) {
  Source source = source_of(wishes.map, role, wishes.reading);
  source.base = wishes.reading.base;
  source.height = wishes.reading.height;
  if (wishes.terrain && source.height && !source.base) {
    source.base_on_terrain = true;
    source.vertical.reset();
  }
  return source;
}

bool is_over(const geometry::Mesh& mesh, const Vector2d& place) {
  return std::ranges::any_of(mesh.triangles, [&](const auto& triangle) {
    std::array<Vector2d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh.vertices[triangle[i]].template head<2>();
    return geometry::turn(corners[0], corners[1], corners[2]) != 0.0 &&
           geometry::contains(corners, place);
  });
}

/// From a place on the map to an object: zero on it, else to the box around it.
double distance(const Object& object, const Vector2d& place) {
  if (is_over(object.mesh, place)) return 0.0;
  const Eigen::AlignedBox3d box = geometry::bounding_box(object.mesh);
  const Eigen::AlignedBox2d base(box.min().head<2>().eval(), box.max().head<2>().eval());
  return std::max(0.01, base.exteriorDistance(place));
}

std::vector<Object> objects_of(const Wishes& wishes, const flight::GeodeticPoint& origin,
                               const std::vector<std::string>& ids) {
  std::vector<Source> sources = sources_of(wishes, ids);
  std::erase_if(sources, [](const Source& source) {
    return source.role != Role::target && source.role != Role::terrain;
  });
  const auto failed = [](std::size_t, const std::string& what) {
    throw Error(ErrorKind::bad_config, what);
  };
  const prior::SitePriors site = prior::read_site_priors(sources, {.origin = origin}, failed);
  return site.priors[0].objects;
}

std::string clicked(const Wishes& wishes) {
  const Click& click = *wishes.target.click;
  const std::vector<Object> objects =
      objects_of(wishes, {click.latitude_deg, click.longitude_deg, 0.0}, {});
  const Object* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Object& object : objects) {
    const double here = distance(object, Vector2d::Zero());
    if (here < least) nearest = &object;
    least = std::min(least, here);
  }
  if (nearest == nullptr || least > near_click) {
    throw Error(
        ErrorKind::bad_config,
        fmt::format("{}: has nothing within {:.0f} m of latitude {:.7f}, longitude {:.7f}{}",
                    wishes.map.string(), near_click, click.latitude_deg, click.longitude_deg,
                    nearest == nullptr
                        ? ""
                        : fmt::format("; the nearest, {}, is {:.0f} m away", nearest->id, least)));
  }
  return nearest->id;
}

/// The ids of what the pick means.
std::vector<std::string> picked(const Wishes& wishes) {
  if (wishes.target.click) return {clicked(wishes)};
  Source source = map_source(wishes, Role::target);
  source.select.ids = wishes.target.ids;
  source.select.attributes = wishes.target.attributes;
  std::vector<std::string> ids;
  for (const Object& object :
       prior::read_prior(source, {.origin = prior::middle_of(source)}, [](const Vector2d&) {
         return std::optional(0.0);  // the terrain is no matter here
       }).objects) {
    ids.push_back(object.id);
  }
  if (ids.size() == 1 || !wishes.target.ids.empty()) return ids;
  std::string some;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, ids.size()); ++i) {
    some += (i == 0 ? "" : ", ") + ids[i];
  }
  throw Error(ErrorKind::bad_config,
              fmt::format("{}: holds {} things, {}{}; say which by --id, --at or --attribute",
                          wishes.map.string(), ids.size(), some, ids.size() > 5 ? ", ..." : ""));
}

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

}  // namespace

std::vector<Source> sources_of(const Wishes& wishes, const std::vector<std::string>& target) {
  std::vector<Source> sources = {map_source(wishes, Role::target),
                                 map_source(wishes, Role::obstacle)};
  sources[0].select.ids = target;
  for (const std::filesystem::path& file : wishes.obstacles) {
    sources.push_back(source_of(file, Role::obstacle, wishes.reading));
  }
  if (wishes.terrain) sources.push_back(source_of(*wishes.terrain, Role::terrain, wishes.reading));
  return sources;
}

Target find_target(const Wishes& wishes) {
  Target target{.ids = picked(wishes), .origin = {}, .box = {}};
  Source source = map_source(wishes, Role::target);
  source.select.ids = target.ids;
  target.origin = prior::middle_of(source);
  constexpr double centimetre = 1e-7;  // of latitude [degrees]
  target.origin.latitude_deg = rounded(target.origin.latitude_deg, centimetre);
  target.origin.longitude_deg = rounded(target.origin.longitude_deg, centimetre);
  for (const Object& object : objects_of(wishes, target.origin, target.ids)) {
    target.box.extend(geometry::bounding_box(object.mesh));
  }
  // Along the same plumb line the frame's other origin moves heights alone.
  target.origin.height = rounded(target.box.min().z(), 0.01);
  target.box.translate(Eigen::Vector3d(0.0, 0.0, -target.origin.height));
  return target;
}

}  // namespace skycap::missions::site
