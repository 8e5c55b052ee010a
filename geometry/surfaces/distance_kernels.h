/// Distances of nearby points from a mesh, computed several at a time. The kernels are compiled for
/// each instruction set and give bit-identical results.
#pragma once

#include <cstddef>

#include "geometry/surfaces/facet_layout.h"

namespace skycap::geometry {

struct DistanceKernels {
  /// Number of points per packet. The points of a packet should be close to each other.
  static constexpr std::size_t packet = 16;

  /// Computes the squared distances [m^2] of `count` points, a multiple of `packet`, from the
  /// facets. `sliver_distance` returns the squared distance of a point from a facet that is too
  /// thin to define a plane.
  void (*squared_distances)(const FacetNode* nodes, const Facet* facets,
                            double (*sliver_distance)(const Facet& facet, const double* point),
                            std::size_t count, const double* const* points, double* squared);
};

extern const DistanceKernels baseline_distance_kernels, avx2_distance_kernels,
    avx512_distance_kernels;

/// Returns the kernels of the widest allowed instruction set.
const DistanceKernels& distance_kernels();

}  // namespace skycap::geometry
