#include "sim/models/masonry/plan_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Geometry>

namespace skycap::sim::models {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double position_tolerance = 1e-6;  // Distance below which points are identical [m].

}  // namespace

Vector2d PlanCurve::Leg::point(double along) const {
  if (radius == 0.0) return from + along / length * (to - from);
  return Eigen::Rotation2Dd(along / radius) * from;
}

Vector2d PlanCurve::Leg::normal(double along) const {
  if (radius != 0.0) return point(along).normalized();
  const Vector2d ahead = (to - from).normalized();
  return {ahead.y(), -ahead.x()};
}

void PlanCurve::add_leg(const Vector2d& from, const Vector2d& to, double radius) {
  double length = (to - from).norm();
  if (radius != 0.0) {
    double angle = std::atan2(cross(from, to), from.dot(to));
    if (angle <= 0.0) angle += 2.0 * pi;
    length = radius * angle;
  }
  legs_.push_back({from, to, radius, length_, length});
  length_ += length;
}

PlanCurve PlanCurve::circle(double radius) {
  PlanCurve plan;
  plan.add_leg({radius, 0.0}, {radius, 0.0}, radius);
  return plan;
}

PlanCurve PlanCurve::with_projections(double radius, int count, double width, double distance) {
  const double root = std::sqrt(radius * radius - 0.25 * width * width);
  PlanCurve plan;
  for (int i = 0; i < count; ++i) {
    const Eigen::Rotation2Dd here(2.0 * pi * i / count), next(2.0 * pi * (i + 1) / count);
    const Vector2d middle(distance, 0.0), corner(distance, 0.5 * width), end(root, 0.5 * width);
    const Vector2d next_end(root, -0.5 * width), next_corner(distance, -0.5 * width);
    plan.add_leg(here * middle, here * corner, 0.0);
    plan.add_leg(here * corner, here * end, 0.0);
    plan.add_leg(here * end, next * next_end, radius);
    plan.add_leg(next * next_end, next * next_corner, 0.0);
    plan.add_leg(next * next_corner, next * middle, 0.0);
  }
  return plan;
}

PlanCurve PlanCurve::rectangle(double width, double depth) {
  const double x = 0.5 * width, y = 0.5 * depth;
  PlanCurve plan;
  plan.add_leg({x, -y}, {x, y}, 0.0);
  plan.add_leg({x, y}, {-x, y}, 0.0);
  plan.add_leg({-x, y}, {-x, -y}, 0.0);
  plan.add_leg({-x, -y}, {x, -y}, 0.0);
  return plan;
}

double PlanCurve::wrapped(double s) const {
  return s - length_ * std::floor((s + position_tolerance) / length_);
}

Vector2d PlanCurve::point(double s, double offset) const {
  const double arc_position = wrapped(s);
  const auto is_past = [](double value, const Leg& leg) {
    return value < leg.start - position_tolerance;
  };
  const auto leg = std::upper_bound(legs_.begin(), legs_.end(), arc_position, is_past) - 1;
  const double along = std::max(0.0, arc_position - leg->start);
  const Vector2d normal = leg->normal(along);
  if (along > position_tolerance) return leg->point(along) + offset * normal;
  const Leg& before = leg == legs_.begin() ? legs_.back() : *(leg - 1);
  const Vector2d normal_before = before.normal(before.length);
  return leg->from + offset * (normal + normal_before) / (1.0 + normal.dot(normal_before));
}

bool PlanCurve::is_corner(double s) const {
  const double arc_position = wrapped(s);
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    if (std::abs(arc_position - legs_[i].start) > position_tolerance) continue;
    const Leg& before = legs_[(i + legs_.size() - 1) % legs_.size()];
    return before.normal(before.length).dot(legs_[i].normal(0.0)) < 1.0 - 1e-6;
  }
  return false;
}

}  // namespace skycap::sim::models
