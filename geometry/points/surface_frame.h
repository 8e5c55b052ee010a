/// The surface around a point, from its nearest neighbours alone.
///
/// Source: the geometry estimation of SEE as its authors released it; SEE++ §III says only that
/// "the local geometry" is estimated and the view placed along the normal.
#pragma once

#include <span>

#include <Eigen/Core>

namespace skycap::geometry {

/// An orthonormal, right-handed frame at a boundary point of the measured surface.
struct SurfaceFrame {
  Eigen::Vector3d normal;    ///< n: unit, on the side of the sensor that measured the point
  Eigen::Vector3d outward;   ///< e_f: unit, along the surface, from the measured side outwards
  Eigen::Vector3d boundary;  ///< e_b = n x e_f: unit, along the boundary
};

/// The frame at `point`, whose nearest neighbours (itself included) are `neighbours`: the principal
/// axes of the neighbours, outwards being where the point lies from their mean. `sensor` is where
/// the point was measured from.
///
/// Where the neighbours leave a choice: of a neighbourhood centred on the point, e_f is the axis of
/// the middle spread; neighbours on one line have as normal the direction to the sensor made
/// orthogonal to the line; of fewer than three or of identical neighbours the normal is the
/// direction to the sensor. The sensor must not be at the point.
SurfaceFrame surface_frame(const Eigen::Vector3d& point,
                           std::span<const Eigen::Vector3f> neighbours,
                           const Eigen::Vector3d& sensor);

}  // namespace skycap::geometry
