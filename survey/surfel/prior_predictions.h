/// Surface prediction from prior data. The prior surface is divided into patches with the planner's
/// resolution. Each patch is open until its position is known.
///
/// A patch is closed in three cases: a surface with a similar orientation is measured within its
/// uncertainty plus one spacing, a scan measured its position, or a scan saw through it. A closed
/// patch is never opened again, because measurements take precedence over prior data.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_grid.h"
#include "survey/surfel/free_space_history.h"
#include "survey/surfel/prior_surface.h"
#include "survey/surfel/surfel_map.h"

namespace skycap::survey::surfel {

struct PriorPatch {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< unit vector
  float area;
  float uncertainty;
};

class PriorPredictions {
 public:
  enum class State : std::uint8_t { open, found, refuted };

  /// Creates one patch for all points of similar orientation in a cube with the edge length
  /// `spacing` [m].
  PriorPredictions(const PriorSurface& surface, float spacing);

  /// Closes patches according to the measurements since the last call.
  void update(const SurfelMap& map, const FreeSpaceHistory& space);

  const std::vector<PriorPatch>& patches() const { return patches_; }
  /// Returns the positions of the patches that no scan has seen through. They occlude surface
  /// behind them.
  std::vector<Eigen::Vector3f> standing() const;
  /// Returns whether an open patch is within `radius` of `point`.
  bool is_open_near(const Eigen::Vector3f& point, float radius) const;
  State state(std::size_t patch) const { return states_[patch]; }

 private:
  std::vector<PriorPatch> patches_;
  std::vector<State> states_;
  geometry::PointGrid grid_;  ///< grid of the patch positions
  float spacing_;
  float reach_;  ///< maximum uncertainty of a patch plus one spacing [m]
  std::size_t surfels_asked_ = 0, images_asked_ = 0;
  std::vector<geometry::Neighbour> found_;  // scratch array
};

}  // namespace skycap::survey::surfel
