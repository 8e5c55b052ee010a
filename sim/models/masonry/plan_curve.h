/// Ground plan of a wall: a closed line of arcs and straight legs around the origin.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace skycap::sim::models {

/// Returns twice the area of the triangle between two vectors, positive if b is to the left of a.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Closed line on the ground around the origin, parametrised by the distance s.
class PlanCurve {
 public:
  static PlanCurve circle(double radius);
  /// Returns a circle interrupted by `count` projections with straight fronts, `width` wide,
  /// `distance` from the centre, and perpendicular sides. s = 0 is the middle of the front at
  /// azimuth 0.
  static PlanCurve with_projections(double radius, int count, double width, double distance);

  /// Returns a rectangle around the origin, `width` along x and `depth` along y. s runs along the
  /// faces to +x, +y, -x and -y, from the corner at +x, -y.
  static PlanCurve rectangle(double width, double depth);

  double length() const { return length_; }
  /// Returns the point at s, moved outwards by `offset` along the normal, or along the mitre at a
  /// corner.
  Eigen::Vector2d point(double s, double offset) const;
  /// Returns true if the plan has a corner at s.
  bool is_corner(double s) const;

 private:
  struct Leg {
    Eigen::Vector2d from, to;
    double radius;  // Radius around the origin. 0 for a straight leg.
    double start, length;

    double angle() const { return length / radius; }
    Eigen::Vector2d point(double along) const;
    Eigen::Vector2d normal(double along) const;
  };
  void add_leg(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius);
  double wrapped(double s) const;

  std::vector<Leg> legs_;
  double length_ = 0.0;
};

}  // namespace skycap::sim::models
