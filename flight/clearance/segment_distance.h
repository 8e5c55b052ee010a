/// Exact distances from a straight segment to the primitives of obstacles. The clearance
/// verification relies on these functions. They use closed forms in double precision: for
/// coordinates below 10 km the error is below 1e-8 m.
///
/// Source of the tests per feature: Ericson, Real-Time Collision Detection (2005), sections 5.1.5
/// (point and triangle) and 5.1.9 (two segments). The code cites them as "Ericson 5.1.5".
#pragma once

#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::flight {

/// Straight segment. It is a point if `from` equals `to`.
struct Segment {
  Eigen::Vector3d from;
  Eigen::Vector3d to;

  Eigen::Vector3d at(double fraction) const { return from + fraction * (to - from); }
  double length() const { return (to - from).norm(); }
};

using Triangle = std::array<Eigen::Vector3d, 3>;

/// Closest points of a segment and another shape.
struct NearestPoints {
  double squared_distance;
  Eigen::Vector3d on_segment;
  Eigen::Vector3d on_other;
};

NearestPoints nearest(const Segment& segment, const Eigen::Vector3d& point);
NearestPoints nearest(const Segment& segment, const Segment& other);

/// Returns distance 0 where the segment pierces the triangle. Degenerate triangles are treated as
/// segments or points.
NearestPoints nearest(const Segment& segment, const Triangle& triangle);

/// Returns false only if the triangle's plane is at least `reach` away from the segment. Cheap test
/// before nearest().
bool may_be_nearer(const Segment& segment, const Triangle& triangle, double reach);

/// Returns distance 0 where the segment intersects the solid box.
NearestPoints nearest(const Segment& segment, const Eigen::AlignedBox3d& box);

}  // namespace skycap::flight
