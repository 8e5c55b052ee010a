/// All prior data of a mission, read and made ready for those who ask: what is in the way of a
/// flight, the ground, what is surveyed.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "flight/space/prior_obstacle.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/terrain.h"

namespace skycap::missions::site_data {

struct SitePriors {
  std::vector<Source> sources;
  std::vector<Prior> priors;  ///< of the sources, in their order
  /// Of the roles obstacle and terrain.
  std::vector<std::shared_ptr<const flight::PriorObstacle>> obstacles;
  std::shared_ptr<const Terrain> terrain;  ///< null: there is none
  TerrainHeight
      ground;  ///< z of the ground everywhere, where unknown as it is taken to be; or null
  std::string ground_note;           ///< what is taken for the ground where no terrain has any
  std::vector<std::string> digests;  ///< of what the sources hold, in their order
};

/// Reads them, terrain first. Whatever is thrown for a source passes through `failed`, which has to
/// throw, too: it knows where the mission file names that source. `reading`, if there is one, is
/// told of each source before it is read.
SitePriors read_site_priors(std::vector<Source> sources, const SiteFrame& site,
                            const std::function<void(std::size_t, const std::string&)>& failed,
                            const std::function<void(std::size_t)>& reading = {});

/// Everything within the prior's uncertainty of its surfaces, points and columns of heights.
flight::PriorObstacleConfig obstacle_of(const Source& source, const Prior& prior);

/// The surfaces of all objects and grids of a role, one behind the other; empty: there are none.
/// With `near` of those objects, and of those faces of grids, that meet it.
geometry::Mesh surfaces_of(const SitePriors& site, Role role,
                           const std::optional<Eigen::AlignedBox3d>& near = {});

}  // namespace skycap::missions::site_data
