#include "missions/photo/photo_site.h"

#include <initializer_list>
#include <vector>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/pose/prism.h"
#include "missions/site_data/site_priors.h"

namespace skycap::missions::photo {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using site_data::Role;

/// Obstacles more than this number of view distances from a target are not considered as occluders.
constexpr double surroundings_reach = 3.0;

/// Throws if the targets are not inside the geofence: they are in another frame than the mission.
void require_inside_fence(const config::MissionSetup& setup, const geometry::Mesh& targets) {
  const std::vector<Eigen::Vector2d>& fence = setup.flight().airspace.geofence;
  const AlignedBox3d box = geometry::bounding_box(targets);
  const Vector3d centre = box.center();
  if (fence.empty() || geometry::contains(fence, centre.head<2>())) return;
  Eigen::AlignedBox2d fenced;
  for (const Eigen::Vector2d& corner : fence) fenced.extend(corner);
  const Eigen::Vector2d offset = centre.head<2>() - fenced.center();
  throw Error(
      ErrorKind::bad_config,
      fmt::format("the target is outside site.geofence: the centre of its base is at "
                  "({:.1f}, {:.1f}, {:.1f}) m in the mission frame, ({:.1f}, {:.1f}) m from "
                  "the centre of the geofence; set the keys crs and offset, or the key place, "
                  "of the prior data to the values of the program that wrote the file",
                  centre.x(), centre.y(), box.min().z(), offset.x(), offset.y()));
}

geometry::Mesh select_targets(const config::MissionSetup& setup) {
  geometry::Mesh targets = make_surfaces(*setup.scene().priors, Role::target);
  if (targets.triangles.empty()) {
    throw Error(ErrorKind::bad_config,
                "prior data with role: target has no surface; photos require a mesh, a city model "
                "or an outline with a height");
  }
  require_inside_fence(setup, targets);
  return targets;
}

/// Returns the surfaces of these roles that are close enough to the targets to occlude them.
geometry::Mesh select_near(const config::MissionSetup& setup, const geometry::Mesh& targets,
                           std::initializer_list<Role> roles) {
  AlignedBox3d near = geometry::bounding_box(targets);
  const double reach = surroundings_reach * setup.survey().planner.view_distance;
  near.min().array() -= reach;
  near.max().array() += reach;
  geometry::Mesh selected;
  for (const Role role : roles) {
    append(selected, make_surfaces(*setup.scene().priors, role, near));
  }
  return selected;
}

geometry::Mesh make_walls(const config::MissionSetup& setup, const geometry::Mesh& targets) {
  geometry::Mesh walls = targets;
  append(walls, select_near(setup, targets, {Role::obstacle}));
  return walls;
}

flight::MeasuredSpaceConfig space_config(const config::MissionSetup& setup) {
  flight::MeasuredSpaceConfig config = setup.flight().measured_space();
  if (setup.document->flight.free_space == config::FreeSpaceRule::measured) return config;
  // An empty region would mean all of space. Instead, the region is a single voxel in the ground,
  // where no flight is possible.
  const Vector3d centre = setup.flight().unknown_box.center();
  constexpr double depth = 3.0;
  const Vector3d buried(centre.x(), centre.y(), setup.flight().airspace.ground_height - depth);
  config.region = AlignedBox3d(buried, buried + Vector3d::Constant(config.voxel));
  config.extra_boxes.clear();
  return config;
}

}  // namespace

PhotoAirspace::PhotoAirspace(const config::MissionSetup& setup, unsigned threads)
    : setup_(setup),
      targets_(select_targets(setup)),
      walls_(make_walls(setup, targets_), threads),
      measured_(space_config(setup)),
      rules_(setup.flight().rules()),
      space_({&measured_, &rules_}) {}

bool PhotoAirspace::is_free(const Vector3d& position) const {
  const double min_standoff = setup_.survey().planner.limits.min_standoff;
  constexpr double rounding = 1e-6;
  if (walls_.distance(position) < min_standoff - rounding) return false;
  if (!setup_.flight().has_vehicle()) return true;
  // The distance is slightly larger than the verified clearance of legs, so that a path to the
  // position can end there.
  constexpr double margin = 0.01;
  return space_.is_free({position, position}, setup_.flight().budget().total() + margin);
}

survey::photo::PhotoSite photo_site(const config::MissionSetup& setup,
                                    const PhotoAirspace& airspace) {
  survey::photo::PhotoSite site;
  site.target = airspace.targets();
  site.surroundings = select_near(setup, site.target, {Role::obstacle, Role::terrain});
  const flight::FlightOptions& flight = setup.flight();
  site.ground = [&flight](const Eigen::Vector2d& position) { return flight.ground_at(position); };
  const AlignedBox3d box = geometry::bounding_box(site.target);
  const survey::ViewLimits& limits = setup.survey().planner.limits;
  site.foot = site.ground(box.center().head<2>());
  site.min_height = limits.min_height.value_or(site.foot);
  site.space.limits = limits;
  site.space.min_standoff = limits.min_standoff;
  site.space.is_free = [&airspace](const Vector3d& position) { return airspace.is_free(position); };
  return site;
}

}  // namespace skycap::missions::photo
