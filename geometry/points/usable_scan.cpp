#include "geometry/points/usable_scan.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

constexpr int farthest = 16384;  // [m]; beyond it, single precision moves points by 1 mm
constexpr float farthest_point = farthest;

bool is_usable(const Eigen::Vector3f& point) {
  return (point.array().abs() <= farthest_point).all();  // false for NaN
}

[[noreturn]] void reject(const std::string& what) {
  throw Error(ErrorKind::bad_geometry, "the scan " + what);
}

void require_points(std::span<const Eigen::Vector3f> points) {
  if (points.empty()) return;
  const Eigen::Map<const Eigen::ArrayXf> numbers(points.front().data(),
                                                 static_cast<Eigen::Index>(3 * points.size()));
  if (numbers.abs().maxCoeff<Eigen::PropagateNaN>() <= farthest_point) return;
  const auto bad = std::ranges::find_if_not(points, is_usable) - points.begin();
  reject("contains an invalid point (number " + std::to_string(bad) +
         "): it is not finite or is more than " + std::to_string(farthest) +
         " m from the origin; use a local frame");
}

}  // namespace

void require_usable(const ScanSpan& scan, const CameraConfig& camera) {
  if (!(scan.sensor_position().array().abs() <= farthest).all()) {
    reject("has a position that is not finite or is more than " + std::to_string(farthest) +
           " m from the origin; use a local frame");
  }
  require_points(scan.points);
  if (scan.pixels.empty()) return;
  if (scan.pixels.size() != scan.points.size()) {
    reject("has " + std::to_string(scan.pixels.size()) + " pixels for " +
           std::to_string(scan.points.size()) + " points; each point requires one");
  }
  const auto all = static_cast<std::uint64_t>(camera.width) * static_cast<unsigned>(camera.height);
  const bool ascends =
      std::ranges::adjacent_find(scan.pixels, std::ranges::greater_equal{}) == scan.pixels.end();
  if (!ascends || scan.pixels.back() >= all) {
    reject("has pixel indices that are not ascending or are outside the mission's camera of " +
           std::to_string(camera.width) + " x " + std::to_string(camera.height) + " pixels");
  }
}

}  // namespace skycap::geometry
