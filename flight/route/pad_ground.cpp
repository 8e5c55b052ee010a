#include "flight/route/pad_ground.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Dense>

#include "flight/space/place_text.h"
#include "geometry/angle.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t fewest_places = 6;
constexpr double most_slope_error = 2.0 * geometry::radians_per_degree;

std::string degrees_text(double angle) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f degrees", angle * geometry::degrees_per_radian);
  return text;
}

}  // namespace

const char* name_of(GroundSource source) {
  switch (source) {
    case GroundSource::measured:
      return "as measured";
    case GroundSource::declared:
      return "as declared";
    case GroundSource::terrain:
      return "by the terrain";
    case GroundSource::scene:
      return "in the scene";
  }
  return "";
}

std::optional<PadGround> pad_ground(const Vector3d& pad, std::span<const Vector3d> places,
                                    GroundSource source) {
  if (places.size() < fewest_places) return std::nullopt;
  // Least squares fit of z = rise + gradient . (x, y), relative to the pad.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  const auto row_of = [&](const Vector3d& place) {
    return Vector3d(1.0, place.x() - pad.x(), place.y() - pad.y());
  };
  for (const Vector3d& place : places) {
    const Vector3d row = row_of(place);
    normal += row * row.transpose();
    right += row * (place.z() - pad.z());
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> factors(normal);
  if (!factors.isInvertible()) return std::nullopt;
  const Vector3d plane = factors.solve(right);
  double squares = 0.0;
  for (const Vector3d& place : places) {
    const double residual = place.z() - pad.z() - row_of(place).dot(plane);
    squares += residual * residual;
  }
  const auto count = static_cast<double>(places.size());
  const Eigen::Matrix3d covariance = squares / (count - 3.0) * factors.inverse();
  if (std::sqrt(covariance.bottomRightCorner<2, 2>().trace()) > most_slope_error) {
    return std::nullopt;
  }
  return PadGround{pad, std::atan(plane.tail<2>().norm()), std::sqrt(squares / count), plane.x(),
                   source};
}

std::vector<Vector2d> places_on(const Vector3d& pad, double radius) {
  constexpr int rays = 8;
  std::vector<Vector2d> places{pad.head<2>()};
  for (const double share : {0.5, 1.0}) {
    for (int ray = 0; ray < rays; ++ray) {
      const double angle = 2.0 * std::numbers::pi * ray / rays;
      places.push_back(pad.head<2>() + share * radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  return places;
}

std::string why_unfit(const PadGround& ground, const PadLimits& limits) {
  const std::string by = name_of(ground.source);
  if (ground.slope > limits.steepest) {
    return "has a slope of " + degrees_text(ground.slope) + " " + by + "; the maximum is " +
           degrees_text(limits.steepest) + " (flight.max_pad_slope_deg): move it";
  }
  if (ground.unevenness > pad_roughness) {
    return "has an unevenness of " + length_text(ground.unevenness) + " " + by +
           "; the maximum is " + length_text(pad_roughness) + ": move it";
  }
  const double most = pad_roughness + limits.height_error;
  if (std::abs(ground.rise) > most) {
    return "has ground " + length_text(std::abs(ground.rise)) +
           (ground.rise > 0.0 ? " above it " : " below it ") + by + "; at most " +
           length_text(most) + ", since heights count from the standing vehicle: correct its z";
  }
  return "";
}

void check_grounds(std::span<const PadGround> grounds, const PadLimits& limits) {
  for (const PadGround& ground : grounds) {
    const std::string why = why_unfit(ground, limits);
    if (why.empty()) continue;
    throw Error(ErrorKind::bad_config,
                "the landing point at " + place_text(ground.place) + " " + why);
  }
}

PadScan::PadScan(const Vector3d& pad, double radius) : pad_(pad), radius_(radius) {}

void PadScan::take_in(std::span<const Eigen::Vector3f> points) {
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

std::optional<PadGround> PadScan::ground() const {
  std::vector<Vector3d> means;
  for (const Cell& cell : cells_) {
    if (cell.count > 0) means.push_back(pad_ + cell.sum / static_cast<double>(cell.count));
  }
  return pad_ground(pad_, means, GroundSource::measured);
}

}  // namespace skycap::flight
