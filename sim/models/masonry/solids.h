/// Modelling operations for procedural scenes. Each returns one closed surface facing outwards,
/// whose edges are shared by exactly two triangles.
///
/// Axes: x, y, z in metres, z up. Solids of a round building are created at azimuth 0, with x out
/// of the wall and y along it, to the right of an observer who faces it. They are then rotated into
/// place around the z axis.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/surfaces/mesh.h"
#include "sim/scene/surface.h"

namespace skycap::sim::models {

using Polyline2 = std::vector<Eigen::Vector2d>;
using Polyline3 = std::vector<Eigen::Vector3d>;

/// Resolution of curves.
struct Fineness {
  double chord_error;  ///< Maximum distance between chord and arc [m].

  /// Returns the number of chords for an arc, at least one per 60 degrees.
  int chords(double radius, double angle) const;
  /// Returns the number of chords for a full circle, a multiple of `multiple`.
  int circle(double radius, int multiple = 2) const;
  /// Returns true if a detail of that size [m] is large enough to be modelled.
  bool shows(double size) const { return size > 1.5 * chord_error; }
};

/// Returns the maximum chord length for an arc.
double chord_length(const Fineness& fineness, double radius);

/// Outline of a moulding. Coordinates are those of the solid: (radius, height) for revolve(),
/// (sideways, upwards) for sweep(). Consecutive points must differ.
class Profile {
 public:
  Profile(const Fineness& fineness, double x, double y);
  Profile& to(double x, double y);    ///< Adds a line to (x, y).
  Profile& by(double dx, double dy);  ///< Adds a line by (dx, dy).
  /// Adds a circular arc to (x, y) with the total rotation `angle`. A positive angle turns left, so
  /// that the arc bulges to the right of its chord. |angle| < 2 pi.
  Profile& arc_to(double x, double y, double angle);
  Profile& arc_by(double dx, double dy, double angle);
  /// Adds a cyma: two equal arcs, the first with the rotation `angle`, the second with the opposite
  /// one.
  Profile& wave_by(double dx, double dy, double angle);
  /// Returns the outline without points closer than half a chord error to the simplified outline.
  /// Coarse models thus omit small mouldings.
  Polyline2 points() const;

 private:
  Fineness fineness_;
  Polyline2 points_;
};

/// Returns the solid of revolution of `profile` around the z axis. The profile (radius, height)
/// runs from its lowest to its highest point on the axis.
geometry::Mesh revolve(const Polyline2& profile, int chords);

/// Returns the ring of revolution of a closed profile (radius, height) that does not touch the
/// axis.
geometry::Mesh revolve_ring(const Polyline2& profile, int chords);

/// Returns the solid through all rings. The rings have the same number of corresponding points and
/// the same orientation. The two end rings are planar.
geometry::Mesh loft(const std::vector<Polyline3>& rings);

/// Returns the outline (y, z), extruded along x from `back` to `front`.
geometry::Mesh extrude(const Polyline2& outline, double back, double front);

geometry::Mesh box(const Eigen::Vector3d& smallest, const Eigen::Vector3d& largest);

/// Returns a moulding along a planar path with mitred corners. The closed `section` (sideways,
/// upwards) follows `path`, where sideways is to the left as seen from the tip of `up`. A closed
/// path connects its last point to its first; an open path has square ends.
geometry::Mesh sweep(const Polyline2& section, const Polyline3& path, const Eigen::Vector3d& up,
                     bool is_closed);

/// Returns `mesh` rotated around the z axis, counter-clockwise from above.
geometry::Mesh turned(geometry::Mesh mesh, double azimuth);
/// Returns `mesh` translated by `by`.
geometry::Mesh moved(geometry::Mesh mesh, const Eigen::Vector3d& by);

/// Returns the volume inside a closed surface, negative if it faces inwards.
double signed_volume(const geometry::Mesh& mesh);

/// Part of a building: closed solids with the name of their element. Equal elements share a name.
struct Part {
  std::string name;
  geometry::Mesh mesh;
  Surface surface = Surface::matt;
};
using Parts = std::vector<Part>;

/// Returns one mesh of all parts, in order.
geometry::Mesh join(const Parts& parts);

}  // namespace skycap::sim::models
