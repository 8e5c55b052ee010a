/// Estimation of the local surface geometry from the nearest neighbours of a point.
///
/// Source: the geometry estimation of the authors' released SEE code. SEE++ §III only states that
/// "the local geometry" is estimated and that the view is placed along the normal.
#pragma once

#include <span>

#include <Eigen/Core>

namespace skycap::geometry {

/// Orthonormal, right-handed frame at a boundary point of the measured surface.
struct SurfaceFrame {
  Eigen::Vector3d normal;    ///< n: unit vector, towards the sensor that measured the point
  Eigen::Vector3d outward;   ///< e_f: unit vector along the surface, away from the measured side
  Eigen::Vector3d boundary;  ///< e_b = n x e_f: unit vector along the boundary
};

/// Returns the frame at `point` from its nearest `neighbours`, which include the point itself. The
/// axes are the principal axes of the neighbours. The outward direction leads from the mean of the
/// neighbours to the point. `sensor` is the sensor position of the measurement and must differ from
/// `point`.
///
/// Ambiguous cases are resolved as follows. If the neighbours are centred on the point, e_f is the
/// axis of the middle spread. If they are collinear, the normal is the direction to the sensor,
/// made orthogonal to the line. With fewer than three or identical neighbours, the normal is the
/// direction to the sensor.
SurfaceFrame surface_frame(const Eigen::Vector3d& point,
                           std::span<const Eigen::Vector3f> neighbours,
                           const Eigen::Vector3d& sensor);

}  // namespace skycap::geometry
