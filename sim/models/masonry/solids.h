/// The few modelling operations that the procedural scenes are made of. Each gives one closed
/// surface, every edge shared by exactly two triangles, facing outwards.
///
/// Axes: x, y, z in metres, z up. A solid that belongs on a round building is made at azimuth 0,
/// where x points out of the wall, y along it to the right of someone who faces it, and is then
/// turned into place about the z axis.
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

/// How finely curves are cut into chords.
struct Fineness {
  double chord_error;  ///< the farthest that a chord may stay from its arc [m]

  /// The number of chords for an arc; at least one for each 60 degrees.
  int chords(double radius, double angle) const;
  /// The number of chords for a full circle, a multiple of `multiple`.
  int circle(double radius, int multiple = 2) const;
  /// Whether a detail of that size is worth modelling; smaller ones are left out.
  bool shows(double size) const { return size > 1.5 * chord_error; }
};

/// The longest chord for an arc.
double chord_length(const Fineness& fineness, double radius);

/// Draws the outline of a moulding. Coordinates are whatever the solid takes: (radius, height) for
/// revolve(), (sideways, upwards) for sweep(). Consecutive points differ.
class Profile {
 public:
  Profile(const Fineness& fineness, double x, double y);
  Profile& to(double x, double y);    ///< straight to (x, y)
  Profile& by(double dx, double dy);  ///< straight on by (dx, dy)
  /// Along a circular arc to (x, y) that turns by `angle` in all: to the left if it is positive,
  /// so that it bulges out to the right of its chord. |angle| < 2 pi.
  Profile& arc_to(double x, double y, double angle);
  Profile& arc_by(double dx, double dy, double angle);
  /// By two equal arcs, the first turning by `angle`, the second back: a cyma.
  Profile& wave_by(double dx, double dy, double angle);
  /// The outline so far, without the points that stay nearer than half a chord error to the outline
  /// without them: small mouldings go where a coarse model cannot show them.
  Polyline2 points() const;

 private:
  Fineness fineness_;
  Polyline2 points_;
};

/// The solid that `profile` sweeps round the z axis, (radius, height) from its lowest point on the
/// axis to its highest point on the axis.
geometry::Mesh revolve(const Polyline2& profile, int chords);

/// The ring that a closed profile, (radius, height), which stays off the axis, sweeps round it.
geometry::Mesh revolve_ring(const Polyline2& profile, int chords);

/// The solid between two ends that passes through every ring. The rings have equally many points,
/// correspond point by point and turn the same way; the two end rings are flat.
geometry::Mesh loft(const std::vector<Polyline3>& rings);

/// The outline (y, z), extruded along x from `back` to `front`.
geometry::Mesh extrude(const Polyline2& outline, double back, double front);

geometry::Mesh box(const Eigen::Vector3d& smallest, const Eigen::Vector3d& largest);

/// A moulding along a path in a plane: the closed `section` (sideways, upwards) travels along
/// `path`, sideways being to the left of it seen from the tip of `up`, with mitred corners. A
/// closed path joins its last point to its first; an open one has square ends.
geometry::Mesh sweep(const Polyline2& section, const Polyline3& path, const Eigen::Vector3d& up,
                     bool is_closed);

/// `mesh`, turned about the z axis, counter-clockwise seen from above.
geometry::Mesh turned(geometry::Mesh mesh, double azimuth);
/// `mesh`, moved.
geometry::Mesh moved(geometry::Mesh mesh, const Eigen::Vector3d& by);

/// The volume that a closed surface encloses; negative if it faces inwards.
double signed_volume(const geometry::Mesh& mesh);

/// A building while it is put together: closed solids with the name of what they are. Equal
/// elements share a name.
struct Part {
  std::string name;
  geometry::Mesh mesh;
  Surface surface = Surface::matt;
};
using Parts = std::vector<Part>;

/// All parts in one mesh, in their order.
geometry::Mesh join(const Parts& parts);

}  // namespace skycap::sim::models
