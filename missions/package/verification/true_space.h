/// Ground-truth space of a mission's site: the scene's mesh and the airspace rules.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/flight_options.h"
#include "flight/route/landing_surface.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::missions::package {

struct TrueSpace {
  flight::KnownSpace everywhere;
  flight::KnownSpace over_pad;  ///< Space without the ground under a pad at the given height.
};

TrueSpace true_space(const flight::FlightOptions& options, const geometry::Mesh& model,
                     double pad_height);

/// Returns the ground of the pad and rally points from the mesh. Where the mesh has no ground,
/// returns the ground from other sources.
std::vector<flight::LandingSurface> true_landing_surfaces(const flight::FlightOptions& options,
                                                          const geometry::Mesh& model,
                                                          const Eigen::Vector3d& pad);

}  // namespace skycap::missions::package
