#include "missions/prior/site_priors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/record_log.h"

namespace skycap::missions::prior {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Columns of one grid; of larger grids several cells make one, as high as the highest.
constexpr double most_columns = 2e6;

/// What one node adds to the column of its cells: itself and, at the grid's border, half a cell
/// beyond it.
void extend(AlignedBox3d& column, const HeightGrid& grid, std::size_t row, std::size_t line) {
  const auto node = [&](std::size_t r, std::size_t c) -> Vector3d {
    return grid.nodes[r * grid.columns + c].cast<double>();
  };
  const Vector3d here = node(row, line);
  if (!here.allFinite()) return;
  column.extend(here);
  const auto beyond = [&](const Vector3d& inner) {
    Vector3d outer = here + 0.5 * (here - inner);
    outer.z() = here.z();
    if (outer.allFinite()) column.extend(outer);
  };
  if (row == 0) beyond(node(1, line));
  if (row + 1 == grid.rows) beyond(node(row - 1, line));
  if (line == 0) beyond(node(row, 1));
  if (line + 1 == grid.columns) beyond(node(row, line - 1));
}

/// Upright boxes over the cells between nodes, as high as the highest node of each.
std::vector<AlignedBox3d> columns_of(const HeightGrid& grid) {
  std::vector<AlignedBox3d> columns;
  if (grid.rows < 2 || grid.columns < 2) return columns;
  const double cells = static_cast<double>(grid.columns) * static_cast<double>(grid.rows);
  const auto step =
      static_cast<std::size_t>(std::max(1.0, std::ceil(std::sqrt(cells / most_columns))));
  for (std::size_t row = 0; row + 1 < grid.rows; row += step) {
    for (std::size_t line = 0; line + 1 < grid.columns; line += step) {
      AlignedBox3d column;
      for (std::size_t r = row; r <= std::min(row + step, grid.rows - 1); ++r) {
        for (std::size_t c = line; c <= std::min(line + step, grid.columns - 1); ++c) {
          extend(column, grid, r, c);
        }
      }
      if (!column.isEmpty()) columns.push_back(column);
    }
  }
  return columns;
}

bool has_area(const geometry::Mesh& mesh) {
  return !mesh.triangles.empty() && geometry::surface_area(mesh) > 0.0;
}

template <typename Item>
std::uint32_t crc_of(const std::vector<Item>& items) {
  return geometry::crc32_of(
      {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item)});
}

/// Of what was read: the same file at another place, or in another format, is the same prior.
std::string digest_of(const Prior& prior) {
  std::vector<std::uint32_t> sums{crc_of(prior.points), crc_of(prior.grid.nodes)};
  for (const Object& object : prior.objects) {
    sums.push_back(geometry::crc32_of(object.id));
    sums.push_back(crc_of(object.mesh.vertices));
    sums.push_back(crc_of(object.mesh.triangles));
  }
  return fmt::format("{:08x}", crc_of(sums));
}

/// What lies beyond the heights that are known, up to `height`.
flight::PriorObstacleConfig ground_beyond(const AlignedBox3d& known, double height) {
  constexpr double far = 5e4;
  const Vector3d low(-far, -far, height - 1.0), high(far, far, height);
  flight::PriorObstacleConfig beyond;
  beyond.name = "the ground beyond the terrain";
  beyond.is_ground = true;
  const auto add = [&](double west, double south, double east, double north) {
    beyond.columns.emplace_back(Vector3d(west, south, low.z()), Vector3d(east, north, high.z()));
  };
  add(low.x(), low.y(), known.min().x(), high.y());
  add(known.max().x(), low.y(), high.x(), high.y());
  add(known.min().x(), low.y(), known.max().x(), known.min().y());
  add(known.min().x(), known.max().y(), known.max().x(), high.y());
  return beyond;
}

}  // namespace

flight::PriorObstacleConfig obstacle_of(const Source& source, const Prior& prior) {
  flight::PriorObstacleConfig obstacle;
  obstacle.name = "the prior " + source.file.filename().string();
  for (const Object& object : prior.objects) {
    if (has_area(object.mesh)) obstacle.surfaces.push_back({object.id, object.mesh});
  }
  obstacle.points = prior.points;
  // Of those in a cube of that side one is left.
  obstacle.point_radius = std::numbers::sqrt3 * source.spacing;
  obstacle.columns = columns_of(prior.grid);
  obstacle.uncertainty = prior.uncertainty;
  obstacle.is_ground = source.role == Role::terrain;
  return obstacle;
}

SitePriors read_site_priors(std::vector<Source> sources, const SiteFrame& site,
                            const std::function<void(std::size_t, const std::string&)>& failed) {
  SitePriors result;
  result.priors.resize(sources.size());
  result.digests.resize(sources.size());
  TerrainHeight terrain_height;
  const auto read = [&](std::size_t i) {
    try {
      result.priors[i] = read_prior(sources[i], site, terrain_height);
      result.digests[i] = digest_of(result.priors[i]);
      const bool binds = sources[i].role == Role::obstacle || sources[i].role == Role::terrain;
      if (!binds) return;
      const auto obstacle = obstacle_of(sources[i], result.priors[i]);
      result.obstacles.push_back(std::make_shared<const flight::PriorObstacle>(obstacle));
    } catch (const Error& error) {
      failed(i, error.what());
    }
  };
  std::vector<const Prior*> grounds;
  AlignedBox3d known;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].role != Role::terrain) continue;
    read(i);
    grounds.push_back(&result.priors[i]);
    known.extend(result.priors[i].box);
  }
  if (!grounds.empty()) {
    result.obstacles.push_back(
        std::make_shared<const flight::PriorObstacle>(ground_beyond(known, site.takeoff_z)));
    result.terrain = std::make_shared<const Terrain>(grounds);
    terrain_height = [terrain = result.terrain](const Eigen::Vector2d& place) {
      return terrain->height(place);
    };
  }
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].role != Role::terrain) read(i);
  }
  result.sources = std::move(sources);
  return result;
}

geometry::Mesh surfaces_of(const SitePriors& site, Role role) {
  geometry::Mesh mesh;
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != role) continue;
    for (const Object& object : site.priors[i].objects) {
      if (has_area(object.mesh)) geometry::append(mesh, object.mesh);
    }
    geometry::append(mesh, mesh_of(triangles_of(site.priors[i].grid, 1)));
  }
  return mesh;
}

}  // namespace skycap::missions::prior
