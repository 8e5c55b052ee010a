/// All prior data of a mission: obstacles, ground and targets.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "flight/clearance/prior_obstacle.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/terrain.h"

namespace skycap::missions::site_data {

struct SitePriors {
  std::vector<Source> sources;
  std::vector<Prior> priors;  ///< Priors in the order of the sources.
  /// Obstacles from sources with the roles obstacle and terrain.
  std::vector<std::shared_ptr<const flight::PriorObstacle>> obstacles;
  std::shared_ptr<const Terrain> terrain;  ///< Terrain; null without terrain files.
  TerrainHeight ground;     ///< Ground height everywhere [m], assumed where unknown; may be null.
  std::string ground_note;  ///< Description of the assumed ground outside the terrain.
  std::vector<std::string> checksums;  ///< Checksums of the contents of the sources, in order.
};

/// Reads all sources, terrain first. If reading a source throws, `failed` is called with its index
/// and the message, and must throw an error with the position in the mission file. `reading`
/// (optional) is called before each source is read.
SitePriors read_site_priors(std::vector<Source> sources, const SiteFrame& site,
                            const std::function<void(std::size_t, const std::string&)>& failed,
                            const std::function<void(std::size_t)>& reading = {});

/// Returns an obstacle that contains all positions within the prior's uncertainty of its surfaces,
/// points and height columns.
flight::PriorObstacleConfig make_obstacle(const Source& source, const Prior& prior);

/// Returns the surfaces of all objects and grids with the given role, or an empty mesh. `near`
/// limits the result to objects and grid faces that intersect this box.
geometry::Mesh make_surfaces(const SitePriors& site, Role role,
                             const std::optional<Eigen::AlignedBox3d>& near = {});

}  // namespace skycap::missions::site_data
