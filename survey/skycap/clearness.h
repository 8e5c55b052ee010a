/// How likely it is that nothing hides a guessed place: unknown space before it may hold something,
/// the likelier the more of it there is.
///
/// Of the last stretch of the way to a place, three times `scale` long, L metres are unknown; then
/// the place is in sight with the probability exp(-L / scale). The ways to one place fall into 54
/// directions, nine to a face of a cube. Each is asked about in pieces that double in length, each
/// in its middle, once a view that may use it comes up; and because what is known stays known,
/// later only what was unknown so far is asked, of new images.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "survey/skycap/space_memory.h"
#include "survey/skycap/unseen_surface.h"

namespace skycap::survey::skycap {

class Clearness {
 public:
  /// `scale` [m]: of so much unknown space 37 % lets a look through.
  explicit Clearness(float scale);

  /// Answers for `patches` from now on, with what `space` knows now; both must outlive the answers.
  void update(std::span<const UnseenPatch> patches, const SpaceMemory& space);

  /// Of patch `i`, for a sensor at `sensor`: in (0, 1]. One without any image, or of what a prior
  /// tells, which tells what hides it too. Safe to call from several threads.
  float of(std::size_t i, const Eigen::Vector3f& sensor) const;

 private:
  static constexpr int pieces = 5, ways_to_a_face = 3;
  static constexpr std::size_t ways = 6UL * ways_to_a_face * ways_to_a_face;
  static constexpr std::uint32_t all_unknown = (1U << pieces) - 1U;

  static std::size_t way_towards(const Eigen::Vector3f& offset);

  std::array<float, pieces> middles_;                 ///< of the pieces, from the place [m]
  std::array<float, all_unknown + 1> probabilities_;  ///< by the unknown pieces
  std::array<Eigen::Vector3f, ways> directions_;

  std::span<const UnseenPatch> patches_;
  const SpaceMemory* space_ = nullptr;
  /// Of each patch and way: the pieces that are unknown, below the number of images asked.
  mutable std::vector<std::uint32_t> asked_;
  struct Row {
    std::size_t number;
    Eigen::Vector3f position;
  };
  std::unordered_map<std::uint64_t, Row> rows_;  ///< of asked_, by the names of places
};

}  // namespace skycap::survey::skycap
