/// The ground plan of a wall: a closed line round the origin, of arcs and straight legs.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace skycap::sim::models {

/// Twice the area of the triangle between two vectors; positive if b is to the left of a.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// A closed line on the ground round the origin, as a distance s along it.
class PlanCurve {
 public:
  static PlanCurve circle(double radius);
  /// A circle interrupted by `count` projections with straight fronts, `width` wide, `distance`
  /// from the centre, and sides at right angles to them. s = 0 is the middle of the front at
  /// azimuth 0.
  static PlanCurve with_projections(double radius, int count, double width, double distance);

  /// A rectangle round the origin, `width` along x and `depth` along y. s runs along its faces to
  /// +x, +y, -x and -y, from the corner at +x, -y.
  static PlanCurve rectangle(double width, double depth);

  double length() const { return length_; }
  /// The point at s, moved outwards by `offset`: along the normal, at a corner along the mitre.
  Eigen::Vector2d point(double s, double offset) const;
  /// Whether the plan turns a corner at s.
  bool is_corner(double s) const;

 private:
  struct Leg {
    Eigen::Vector2d from, to;
    double radius;  // about the origin; zero for a straight leg
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
