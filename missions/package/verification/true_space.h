/// A mission's site as it truly is: the scene's mesh and the rules.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "flight/flight_options.h"
#include "flight/route/pad_ground.h"
#include "flight/space/clearance.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::missions::package {

struct TrueSpace {
  flight::KnownSpace everywhere;
  flight::KnownSpace over_pad;  ///< without the ground that a pad at that height stands on
};

TrueSpace true_space(const flight::FlightOptions& options, const geometry::Mesh& model,
                     double pad_height);

/// The ground of pad and rally points as the mesh has it; where it has none, what else is known.
std::vector<flight::PadGround> true_grounds(const flight::FlightOptions& options,
                                            const geometry::Mesh& model,
                                            const Eigen::Vector3d& pad);

}  // namespace skycap::missions::package
