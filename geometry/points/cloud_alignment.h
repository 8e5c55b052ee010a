/// Rigid alignment of two clouds of the same building whose sensor positions are unknown.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "geometry/points/registration.h"

namespace skycap::geometry {

/// Registers `moved` with `reference` (registration.h) by planes of radius `radius` [m]. `reach` is
/// the greatest offset that is searched [m]. Normals of both clouds are oriented away from
/// `centre`, a position inside the building. Returns nullopt if fewer than 20 planes have a
/// partner. Deterministic.
std::optional<Registration> align_clouds(std::span<const Eigen::Vector3f> moved,
                                         std::span<const Eigen::Vector3f> reference,
                                         const Eigen::Vector3d& centre, double radius,
                                         double reach);

}  // namespace skycap::geometry
