/// Exact distances from a straight segment to the shapes that obstacles are made of. The clearance
/// proof rests on these few functions. Closed forms in double precision: for coordinates below
/// 10 km the results are good to 1e-8 m.
///
/// Source of the feature-by-feature tests: Ericson, Real-Time Collision Detection (2005), sections
/// 5.1.5 (point and triangle) and 5.1.9 (two segments), written "Ericson 5.1.5" in the code.
#pragma once

#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::flight {

/// A straight segment; `from` may equal `to`, then it is a point.
struct Segment {
  Eigen::Vector3d from;
  Eigen::Vector3d to;

  Eigen::Vector3d at(double fraction) const { return from + fraction * (to - from); }
  double length() const { return (to - from).norm(); }
};

using Triangle = std::array<Eigen::Vector3d, 3>;

/// The nearest two points of a segment and another shape.
struct NearestPoints {
  double squared_distance;
  Eigen::Vector3d on_segment;
  Eigen::Vector3d on_other;
};

NearestPoints nearest(const Segment& segment, const Eigen::Vector3d& point);
NearestPoints nearest(const Segment& segment, const Segment& other);

/// Zero distance where the segment pierces the triangle. Triangles without area (needles, points)
/// are handled as the segments they are.
NearestPoints nearest(const Segment& segment, const Triangle& triangle);

/// False only if the triangle's plane keeps it `reach` or farther from the segment: a cheap test to
/// be made before nearest().
bool may_be_nearer(const Segment& segment, const Triangle& triangle, double reach);

/// Zero distance where the segment meets the solid box.
NearestPoints nearest(const Segment& segment, const Eigen::AlignedBox3d& box);

}  // namespace skycap::flight
