#include "missions/site_data/site_priors.h"

#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/record_log.h"
#include "missions/site_data/file_reader.h"
#include "missions/site_data/missing_terrain.h"

namespace skycap::missions::site_data {
namespace {

template <typename Item>
std::uint32_t compute_crc(const std::vector<Item>& items) {
  return geometry::compute_crc32(
      {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item)});
}

/// Computes the checksum of the data, so that the same data in another file or format is the same
/// prior.
std::string compute_checksum(const Prior& prior) {
  std::vector<std::uint32_t> sums{compute_crc(prior.points), compute_crc(prior.grid.nodes)};
  for (const Object& object : prior.objects) {
    sums.push_back(geometry::compute_crc32(object.id));
    sums.push_back(compute_crc(object.mesh.vertices));
    sums.push_back(compute_crc(object.mesh.triangles));
  }
  return fmt::format("{:08x}", compute_crc(sums));
}

}  // namespace

flight::PriorObstacleConfig make_obstacle(const Source& source, const Prior& prior) {
  flight::PriorObstacleConfig obstacle;
  obstacle.name = "the prior " + source.file.filename().string();
  for (const Object& object : prior.objects) {
    if (has_area(object.mesh)) obstacle.surfaces.push_back({object.id, object.mesh});
  }
  obstacle.points = prior.points;
  // Downsampling keeps one point per cube of this size.
  obstacle.point_radius = std::numbers::sqrt3 * source.spacing.value_or(usual_spacing);
  obstacle.columns = make_columns(prior.grid);
  obstacle.uncertainty = prior.uncertainty;
  obstacle.is_ground = source.role == Role::terrain;
  return obstacle;
}

SitePriors read_site_priors(std::vector<Source> sources, const SiteFrame& site,
                            const std::function<void(std::size_t, const std::string&)>& failed,
                            const std::function<void(std::size_t)>& reading) {
  const ReadOnce once;
  SitePriors result;
  result.priors.resize(sources.size());
  result.checksums.resize(sources.size());
  TerrainHeight terrain_height;
  std::vector<const Prior*> landing_surfaces;
  std::vector<flight::PriorObstacleConfig> ground_obstacles;
  const auto read = [&](std::size_t i) {
    const Role role = sources[i].role;
    if (reading) reading(i);
    try {
      result.priors[i] = read_prior(sources[i], site, terrain_height);
      result.checksums[i] = compute_checksum(result.priors[i]);
      if (role != Role::obstacle && role != Role::terrain) return;
      auto obstacle = make_obstacle(sources[i], result.priors[i]);
      result.obstacles.push_back(std::make_shared<const flight::PriorObstacle>(obstacle));
      if (role == Role::terrain) ground_obstacles.push_back(std::move(obstacle));
    } catch (const Error& error) {
      failed(i, error.what());
    }
  };
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].role != Role::terrain) continue;
    read(i);
    landing_surfaces.push_back(&result.priors[i]);
  }
  if (!landing_surfaces.empty()) {
    const auto unknown = std::make_shared<UnknownGround>(ground_obstacles, site.ground_z);
    result.ground_note = unknown->note();
    result.obstacles.push_back(std::make_shared<const flight::PriorObstacle>(unknown->obstacle()));
    result.terrain = std::make_shared<const Terrain>(landing_surfaces);
    result.ground = [unknown, terrain = result.terrain](const Eigen::Vector2d& position) {
      const std::optional<double> known = terrain->height(position);
      return known ? known : unknown->height(position);
    };
    terrain_height = [terrain = result.terrain](const Eigen::Vector2d& position) {
      return terrain->height(position);
    };
  }
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].role != Role::terrain) read(i);
  }
  result.sources = std::move(sources);
  return result;
}

geometry::Mesh make_surfaces(const SitePriors& site, Role role,
                             const std::optional<Eigen::AlignedBox3d>& near) {
  geometry::Mesh mesh;
  const auto add_faces = [&](std::vector<flight::Triangle> faces) {
    if (near) {
      std::erase_if(faces, [&](const auto& face) {
        Eigen::AlignedBox3d box;
        for (const Eigen::Vector3d& corner : face) box.extend(corner);
        return !near->intersects(box);
      });
    }
    geometry::append(mesh, make_mesh(faces));
  };
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != role) continue;
    for (const Object& object : site.priors[i].objects) {
      if (!has_area(object.mesh)) continue;
      if (near && !near->intersects(geometry::bounding_box(object.mesh))) continue;
      geometry::append(mesh, object.mesh);
    }
    add_faces(to_triangles(site.priors[i].grid));
    add_faces(make_rim_triangles(site.priors[i].grid));
  }
  return mesh;
}

}  // namespace skycap::missions::site_data
