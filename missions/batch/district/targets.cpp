#include "missions/batch/district/targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/wizard/target.h"

namespace skycap::missions::batch {
namespace {

using Eigen::AlignedBox2d;
using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using flight::GeodeticPoint;
using site_data::Object;

/// Maximum difference of target base heights on a ground plane without terrain [m].
constexpr double max_unevenness = 2.0;

/// Maximum size of a group, as it is surveyed in one mission [m].
constexpr double largest_group = 80.0;

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

/// Tests whether an object is in the area of the targets.
class TargetFilter {
 public:
  TargetFilter(const TargetChoice& choice, const flight::LocalFrame& frame)
      : choice_(choice), frame_(frame) {
    if (!choice.near) return;
    near_ = frame.to_local({choice.near->latitude_deg, choice.near->longitude_deg, 0.0}).head<2>();
  }

  bool hold(const AlignedBox3d& box) const {
    const AlignedBox2d base(box.min().head<2>().eval(), box.max().head<2>().eval());
    if (choice_.near && base.exteriorDistance(near_) > choice_.distance) return false;
    if (choice_.within.empty()) return true;
    const GeodeticPoint middle = frame_.to_geodetic(box.center());
    const auto& [a, b] = std::tie(choice_.within[0], choice_.within[1]);
    return is_between(middle.latitude_deg, a.latitude_deg, b.latitude_deg) &&
           is_between(middle.longitude_deg, a.longitude_deg, b.longitude_deg);
  }

 private:
  static bool is_between(double value, double a, double b) {
    return std::min(a, b) <= value && value <= std::max(a, b);
  }

  const TargetChoice& choice_;
  const flight::LocalFrame& frame_;
  Vector2d near_ = Vector2d::Zero();
};

/// Returns the origin at the centre of the boxes, at the minimum or maximum of their base heights.
GeodeticPoint compute_origin(const std::vector<AlignedBox3d>& boxes,
                             const flight::LocalFrame& frame, bool has_terrain,
                             const std::string& map) {
  AlignedBox3d all;
  double min_height = std::numeric_limits<double>::infinity(), max_height = -min_height;
  for (const AlignedBox3d& box : boxes) {
    all.extend(box);
    Vector3d foot = box.center();
    foot.z() = box.min().z();
    const double height = frame.to_geodetic(foot).height;
    min_height = std::min(min_height, height);
    max_height = std::max(max_height, height);
  }
  if (!has_terrain && max_height - min_height > max_unevenness) {
    throw Error(ErrorKind::bad_config,
                fmt::format("{}: the base heights of the targets differ by {:.1f} m, and the "
                            "ground between the targets is unknown; set terrain or choose targets "
                            "whose base heights differ by at most {:g} m",
                            map, max_height - min_height, max_unevenness));
  }
  GeodeticPoint origin = frame.to_geodetic(all.center());
  constexpr double centimetre = 1e-7;  // one centimetre of latitude [degrees]
  origin.latitude_deg = rounded(origin.latitude_deg, centimetre);
  origin.longitude_deg = rounded(origin.longitude_deg, centimetre);
  origin.height =
      has_terrain ? std::floor(100.0 * min_height) / 100.0 : std::ceil(100.0 * max_height) / 100.0;
  return origin;
}

/// Returns the distance between two meshes at their vertices, up to `up_to` [m].
double gap(const geometry::Mesh& a, const geometry::MeshDistance& to_a, const geometry::Mesh& b,
           const geometry::MeshDistance& to_b, double up_to) {
  double min = up_to;
  for (const Vector3d& corner : a.vertices) min = std::min(min, to_b.distance(corner));
  for (const Vector3d& corner : b.vertices) min = std::min(min, to_a.distance(corner));
  return min;
}

struct Pair {
  double distance;
  std::size_t a, b;
};

/// Returns pairs of objects closer than `together` [m], closest pairs first. The boxes are swept
/// from west to east.
std::vector<Pair> near_pairs(std::span<const Object> objects, double together) {
  std::vector<AlignedBox3d> boxes;
  for (const Object& object : objects) boxes.push_back(geometry::bounding_box(object.mesh));
  std::vector<std::size_t> order(objects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return boxes[i].min().x(); });
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const std::size_t a = std::min(order[i], order[j]), b = std::max(order[i], order[j]);
      if (boxes[order[j]].min().x() - boxes[order[i]].max().x() >= together) break;
      if (boxes[a].exteriorDistance(boxes[b]) >= together) continue;
      const geometry::Mesh &mesh_a = objects[a].mesh, &mesh_b = objects[b].mesh;
      const double distance = gap(mesh_a, geometry::MeshDistance(mesh_a), mesh_b,
                                  geometry::MeshDistance(mesh_b), together);
      if (distance < together) pairs.push_back({distance, a, b});
    }
  }
  std::ranges::sort(pairs, [](const Pair& one, const Pair& other) {
    return std::tie(one.distance, one.a, one.b) < std::tie(other.distance, other.a, other.b);
  });
  return pairs;
}

}  // namespace

ChosenTargets choose_targets(const DistrictFile& district,
                             const std::vector<site_data::Source>& files) {
  const TargetChoice& choice = district.targets;
  const std::string map = files[0].file.string();
  site_data::Source source = wizard::select_sources(files, choice.ids)[0];
  source.select.attributes = choice.attributes;
  const GeodeticPoint middle = site_data::compute_centre(source);
  const flight::LocalFrame frame(middle);
  const std::vector<Object> objects = wizard::read_things(files, source.select, middle).objects;
  const TargetFilter target_filter(choice, frame);
  ChosenTargets chosen;
  std::vector<AlignedBox3d> boxes;
  for (const Object& object : objects) {
    if (!site_data::has_area(object.mesh)) continue;
    const AlignedBox3d box = geometry::bounding_box(object.mesh);
    if (!target_filter.hold(box)) continue;
    chosen.ids.push_back(object.id);
    boxes.push_back(box);
  }
  if (chosen.ids.empty()) {
    throw Error(
        ErrorKind::bad_config,
        fmt::format(
            "{}: key targets selects none of the {} objects of {}; enlarge the box or the distance",
            district.file.string(), objects.size(), map));
  }
  std::vector<std::string> sorted = chosen.ids;
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice != sorted.end()) wizard::require_single(objects, *twice, map);
  chosen.are_all =
      choice.ids.empty() && choice.attributes.empty() && chosen.ids.size() == objects.size();
  chosen.origin = compute_origin(boxes, frame, district.request.terrain.has_value(), map);
  return chosen;
}

std::vector<Group> grouped(std::span<const Object> objects, double together) {
  std::vector<std::size_t> group_indices(objects.size());
  std::iota(group_indices.begin(), group_indices.end(), std::size_t{0});
  std::vector<Group> groups(objects.size());
  std::vector<AlignedBox3d> boxes;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    groups[i] = {i};
    boxes.push_back(geometry::bounding_box(objects[i].mesh));
  }
  for (const auto& [distance, a, b] : near_pairs(objects, together)) {
    const std::size_t to = std::min(group_indices[a], group_indices[b]);
    const std::size_t from = std::max(group_indices[a], group_indices[b]);
    const AlignedBox3d both = boxes[to].merged(boxes[from]);
    if (to == from || both.sizes().maxCoeff() > largest_group) continue;
    boxes[to] = both;
    for (const std::size_t member : groups[from]) group_indices[member] = to;
    groups[to].insert(groups[to].end(), groups[from].begin(), groups[from].end());
    groups[from].clear();
  }
  std::erase_if(groups, [](const Group& group) { return group.empty(); });
  for (Group& group : groups) std::ranges::sort(group);
  return groups;
}

}  // namespace skycap::missions::batch
