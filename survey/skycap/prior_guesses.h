/// Guesses by what is thought to be there: a prior surface as patches of the planner's resolution,
/// each open until its place is known.
///
/// A patch is answered when a surface that faces alike is measured within its uncertainty and one
/// spacing of it, or when a scan measured at its place, or saw through it. What is answered is
/// never open again: measurements overrule the prior.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_grid.h"
#include "survey/skycap/dose_map.h"
#include "survey/skycap/prior_surface.h"
#include "survey/skycap/space_memory.h"

namespace skycap::survey::skycap {

struct PriorPatch {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< unit
  float area;
  float uncertainty;
};

class PriorGuesses {
 public:
  enum class State : std::uint8_t { open, found, refuted };

  /// One patch for all points in a cube of the spacing that face about alike.
  PriorGuesses(const PriorSurface& surface, float spacing);

  /// Answers what was measured since the last call.
  void update(const DoseMap& map, const SpaceMemory& space);

  const std::vector<PriorPatch>& patches() const { return patches_; }
  /// Where the patches are that no scan has seen through: they hide what is behind them.
  std::vector<Eigen::Vector3f> standing() const;
  /// Whether an open patch is within `radius`.
  bool is_open_near(const Eigen::Vector3f& point, float radius) const;
  State state(std::size_t patch) const { return states_[patch]; }

 private:
  std::vector<PriorPatch> patches_;
  std::vector<State> states_;
  geometry::PointGrid grid_;  ///< of the patches
  float spacing_;
  float reach_;  ///< of the most uncertain one
  std::size_t surfels_asked_ = 0, images_asked_ = 0;
  std::vector<geometry::Neighbour> found_;  // kept for its memory
};

}  // namespace skycap::survey::skycap
