#include "missions/photo/control_points.h"

#include <algorithm>
#include <set>

#include "flight/export/text.h"
#include "geometry/error.h"
#include "geometry/pose/brown_distortion.h"
#include "geometry/pose/world.h"
#include "geometry/text_parts.h"
#include "missions/photo/photo_table.h"

namespace skycap::missions::photo {
namespace {

using flight::fixed;
using survey::photo::PhotoPlan;

constexpr double border = 0.015;      // Fraction of each side of the image.
constexpr double max_distance = 2.0;  // Multiple of the view distance.
constexpr double to_the_surface =
    0.999;  // Fraction of a line of sight that ends before the surface.

[[noreturn]] void fail(std::size_t line, const std::string& what) {
  throw Error(ErrorKind::bad_file, "line " + std::to_string(line) + " " + what);
}

}  // namespace

std::vector<ControlPoint> read_control_points(const std::string& text,
                                              const std::optional<flight::Site>& site) {
  const std::vector<std::string> lines = flight::split_lines(geometry::without_mark(text));
  const std::string header = lines.empty() ? "" : std::string(geometry::trimmed(lines[0]));
  const bool is_local = header == "name,x,y,z";
  if (!is_local && header != "name,latitude,longitude,height") {
    fail(1, "must be \"name,x,y,z\" or \"name,latitude,longitude,height\"");
  }
  if (!is_local && !site) {
    fail(1, "lists geodetic points, which require site.latitude_deg and site.longitude_deg");
  }
  std::optional<flight::LocalFrame> frame;
  if (!is_local) frame.emplace(site->origin);
  std::vector<ControlPoint> points;
  std::set<std::string> names;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (geometry::trimmed(lines[i]).empty()) continue;
    const std::vector<std::string> fields = flight::split(lines[i], ',');
    if (fields.size() != 4) {
      fail(i + 1, "has " + std::to_string(fields.size()) + " fields; it must have 4");
    }
    ControlPoint point{std::string(geometry::trimmed(fields[0])), {}};
    if (point.name.empty()) fail(i + 1, "has no name");
    if (!names.insert(point.name).second) fail(i + 1, "lists \"" + point.name + "\" again");
    Eigen::Vector3d values;
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = flight::to_number(geometry::trimmed(fields[axis + 1]));
      if (!value) fail(i + 1, "has \"" + fields[axis + 1] + "\"; it must be a number");
      values[axis] = *value;
    }
    if (!is_local && (std::abs(values.x()) > 90.0 || std::abs(values.y()) > 180.0)) {
      fail(i + 1,
           "has a latitude outside the range -90 to 90 degrees or a longitude outside the range "
           "-180 to 180 degrees");
    }
    point.position = is_local ? values : frame->to_local({values.x(), values.y(), values.z()});
    if (!geometry::is_valid_position(point.position)) {
      fail(i + 1, "is more than 10,000 km from the origin");
    }
    points.push_back(std::move(point));
  }
  if (points.empty()) fail(lines.size(), "must be followed by at least one point");
  return points;
}

std::vector<ControlObservation> find_observations(const ControlPoint& point, const PhotoPlan& plan,
                                                  const Blocked& is_blocked) {
  const geometry::PhotoCamera camera(plan.camera);
  const Eigen::Vector2d size(camera.width(), camera.height());
  std::vector<ControlObservation> observations;
  for (std::uint32_t i = 0; i < plan.photos.size(); ++i) {
    const geometry::View& view = plan.photos[i].view;
    const Eigen::Vector3d local = geometry::camera_pose(view).inverse() * point.position;
    const double distance = local.norm();
    if (local.z() <= 0.0 || distance > max_distance * plan.view_distance) continue;
    // With distortion, points far outside the image may be mapped back into it.
    if (!camera.project(local, -0.1)) continue;
    Eigen::Vector2d slope = local.head<2>() / local.z();
    if (plan.camera.distortion) slope = geometry::distort(*plan.camera.distortion, slope);
    const Eigen::Vector2d pixel = camera.focal_length_px() * slope + 0.5 * size;
    const bool is_inside = (pixel.array() >= border * size.array()).all() &&
                           (pixel.array() <= (1.0 - border) * size.array()).all();
    if (!is_inside) continue;
    const Eigen::Vector3d end = view.position + to_the_surface * (point.position - view.position);
    if (is_blocked(view.position, end)) continue;
    observations.push_back({i, pixel, distance});
  }
  return observations;
}

std::string control_table(const std::vector<ControlPoint>& points, const PhotoPlan& plan,
                          const Blocked& is_blocked) {
  const geometry::PhotoCamera camera(plan.camera);
  std::string text = "point,photo,pixel_x,pixel_y,distance_m,gsd_m\n";
  for (const ControlPoint& point : points) {
    std::vector<ControlObservation> observations = find_observations(point, plan, is_blocked);
    std::ranges::stable_sort(observations, {}, &ControlObservation::distance);
    for (const ControlObservation& observation : observations) {
      text += point.name + "," + image_name(plan.photos[observation.photo]) + "," +
              fixed(observation.pixel.x(), 1) + "," + fixed(observation.pixel.y(), 1) + "," +
              fixed(observation.distance, 3) + "," + fixed(camera.gsd(observation.distance), 5) +
              "\n";
    }
  }
  return text;
}

std::vector<std::string> control_warnings(const std::vector<ControlPoint>& points,
                                          const PhotoPlan& plan, const Blocked& is_blocked) {
  std::vector<std::string> warnings;
  for (const ControlPoint& point : points) {
    const std::size_t photos = find_observations(point, plan, is_blocked).size();
    if (photos >= min_control_photos) continue;
    warnings.push_back("control point \"" + point.name + "\" is visible in " +
                       std::to_string(photos) + " photos; at least " +
                       std::to_string(min_control_photos) +
                       " are required. Move it to an area where photos overlap");
  }
  return warnings;
}

}  // namespace skycap::missions::photo
