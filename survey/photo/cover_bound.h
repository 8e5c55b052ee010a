/// Lower bound of the number of photos that observe each sample often enough.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "survey/photo/photo_choice.h"

namespace skycap::survey::photo {

/// Lower bound of the number of photos that satisfy these samples, because each sample requires K +
/// 1 observations. Angles are ignored. Source: Lagrangian bound of the covering problem, maximised
/// with the volume algorithm (Barahona and Anbil, "The volume algorithm: producing primal solutions
/// with a subgradient method", 2000). Each price vector gives a valid bound.
struct CoverBound {
  double relaxed = 0.0;    ///< Bound of the linear relaxation.
  std::size_t photos = 0;  ///< Bound as an integer number of photos.
};
/// Computes the bound. `observations` is K + 1, `upper_bound` the number of photos of a plan.
CoverBound cover_bound(const PhotoChoiceProblem& problem, std::span<const std::uint32_t> samples,
                       int observations, std::size_t upper_bound);

}  // namespace skycap::survey::photo
