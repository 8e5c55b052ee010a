#include "flight/route/landing_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Dense>

#include "flight/clearance/position_text.h"
#include "geometry/angle.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t min_samples = 6;
constexpr double max_slope_error = 2.0 * geometry::radians_per_degree;

std::string degrees_text(double angle) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f degrees", angle * geometry::degrees_per_radian);
  return text;
}

}  // namespace

const char* to_string(GroundSource source) {
  switch (source) {
    case GroundSource::measured:
      return "as measured";
    case GroundSource::declared:
      return "as declared";
    case GroundSource::terrain:
      return "in the terrain data";
    case GroundSource::scene:
      return "in the scene";
  }
  return "";
}

std::optional<LandingSurface> pad_ground(const Vector3d& pad, std::span<const Vector3d> positions,
                                         GroundSource source) {
  if (positions.size() < min_samples) return std::nullopt;
  // Least squares fit of z = rise + gradient . (x, y), relative to the pad.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  const auto row_at = [&](const Vector3d& position) {
    return Vector3d(1.0, position.x() - pad.x(), position.y() - pad.y());
  };
  for (const Vector3d& position : positions) {
    const Vector3d row = row_at(position);
    normal += row * row.transpose();
    right += row * (position.z() - pad.z());
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> factors(normal);
  if (!factors.isInvertible()) return std::nullopt;
  const Vector3d plane = factors.solve(right);
  double squares = 0.0;
  for (const Vector3d& position : positions) {
    const double residual = position.z() - pad.z() - row_at(position).dot(plane);
    squares += residual * residual;
  }
  const auto count = static_cast<double>(positions.size());
  const Eigen::Matrix3d covariance = squares / (count - 3.0) * factors.inverse();
  if (std::sqrt(covariance.bottomRightCorner<2, 2>().trace()) > max_slope_error) {
    return std::nullopt;
  }
  return LandingSurface{pad, std::atan(plane.tail<2>().norm()), std::sqrt(squares / count),
                        plane.x(), source};
}

std::vector<Vector2d> landing_points(const Vector3d& pad, double radius) {
  constexpr int rays = 8;
  std::vector<Vector2d> positions{pad.head<2>()};
  for (const double share : {0.5, 1.0}) {
    for (int ray = 0; ray < rays; ++ray) {
      const double angle = 2.0 * std::numbers::pi * ray / rays;
      positions.push_back(pad.head<2>() +
                          share * radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  return positions;
}

std::string unfit_reason(const LandingSurface& ground, const PadLimits& limits) {
  const std::string by = to_string(ground.source);
  if (ground.slope > limits.max_slope) {
    return "has a slope of " + degrees_text(ground.slope) + " " + by + "; the maximum is " +
           degrees_text(limits.max_slope) + " (flight.max_pad_slope_deg); move the point";
  }
  if (ground.unevenness > pad_roughness) {
    return "has an unevenness of " + length_text(ground.unevenness) + " " + by +
           "; the maximum is " + length_text(pad_roughness) + "; move the point";
  }
  const double max = pad_roughness + limits.height_error;
  if (std::abs(ground.rise) > max) {
    return "has ground " + length_text(std::abs(ground.rise)) +
           (ground.rise > 0.0 ? " above it " : " below it ") + by + "; the maximum is " +
           length_text(max) +
           ", because the altitude reference is the vehicle on the ground; correct the z of the "
           "point";
  }
  return "";
}

void check_landing_surfaces(std::span<const LandingSurface> landing_surfaces,
                            const PadLimits& limits) {
  for (const LandingSurface& ground : landing_surfaces) {
    const std::string reason = unfit_reason(ground, limits);
    if (reason.empty()) continue;
    throw Error(ErrorKind::bad_config,
                "the landing point at " + position_text(ground.position) + " " + reason);
  }
}

PadScan::PadScan(const Vector3d& pad, double radius) : pad_(pad), radius_(radius) {}

void PadScan::add_points(std::span<const Eigen::Vector3f> points) {
  const double reach = radius_ + 1.0;
  const double cell = 2.0 * radius_ / cells_across;
  for (const Eigen::Vector3f& point : points) {
    // Fast rejection, because most points are elsewhere.
    if (!(std::abs(double{point.x()} - pad_.x()) < radius_)) continue;
    const Vector3d offset = point.cast<double>() - pad_;
    if (!(offset.head<2>().squaredNorm() < radius_ * radius_) || std::abs(offset.z()) > reach) {
      continue;
    }
    const auto index = [&](double along) {
      return std::min(cells_across - 1, static_cast<std::size_t>((along + radius_) / cell));
    };
    Cell& met = cells_[index(offset.y()) * cells_across + index(offset.x())];
    met.sum += offset;
    ++met.count;
  }
}

std::optional<LandingSurface> PadScan::ground() const {
  std::vector<Vector3d> means;
  for (const Cell& cell : cells_) {
    if (cell.count > 0) means.push_back(pad_ + cell.sum / static_cast<double>(cell.count));
  }
  return pad_ground(pad_, means, GroundSource::measured);
}

}  // namespace skycap::flight
