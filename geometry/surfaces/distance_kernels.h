/// Distances of many points that are near each other, several at a time: compiled for each
/// instruction set, and the same bits with all of them.
#pragma once

#include <cstddef>

#include "geometry/surfaces/facet_layout.h"

namespace skycap::geometry {

struct DistanceKernels {
  /// Points are taken in packets of that many: those of a packet should be near each other.
  static constexpr std::size_t packet = 16;

  /// Of `count` points, a multiple of `packet`, their squared distances from the facets.
  /// `of_sliver` says those of a point and a facet without a plane of its own.
  void (*squared_distances)(const FacetNode* nodes, const Facet* facets,
                            double (*of_sliver)(const Facet& facet, const double* point),
                            std::size_t count, const double* const* points, double* squared);
};

extern const DistanceKernels baseline_distance_kernels, avx2_distance_kernels,
    avx512_distance_kernels;

/// The widest that may be used.
const DistanceKernels& distance_kernels();

}  // namespace skycap::geometry
