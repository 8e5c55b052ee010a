/// Candidate views of PB-NBV on parallels of a sphere, and the sectors visited first.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "survey/pb_nbv/pb_nbv_config.h"

namespace skycap::survey::pb_nbv {

/// Returns the directions of the candidates from the sphere's centre: i = 0 .. parallels - 1 at the
/// polar angle i max / parallels, with numbers proportional to its sine.
std::vector<Eigen::Vector3d> make_candidate_directions(const PbNbvSettings& settings);

/// Rule that the first views are in different sectors of the azimuth. Sector 0 is centred on the
/// first view. The next view is in the next sector to the left or to the right of those visited.
class SectorRule {
 public:
  SectorRule(std::size_t sectors, double first_azimuth)
      : sectors_(sectors), first_azimuth_(first_azimuth), left_(1), right_(sectors - 1) {}

  /// Returns the sector of an azimuth [rad].
  std::size_t sector(double azimuth) const;
  /// Returns whether all sectors were visited.
  bool is_complete() const { return left_ > right_; }
  /// Returns whether the next view may be in the sector.
  bool admits(std::size_t sector) const {
    return is_complete() || sector == left_ || sector == right_;
  }
  /// Marks the sector of the chosen view as visited.
  void visit(std::size_t sector);
  /// Marks both admitted sectors as visited, because they have no candidates.
  void skip();

 private:
  std::size_t sectors_;
  double first_azimuth_;
  std::size_t left_, right_;
};

}  // namespace skycap::survey::pb_nbv
