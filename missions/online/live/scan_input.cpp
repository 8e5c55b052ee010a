#include "missions/online/live/scan_input.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/text/text_scanner.h"
#include "geometry/points/usable_scan.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/world.h"
#include "missions/online/live/live_journal.h"

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Returns the pose given by position and quaternion.
Isometry3d make_pose(const std::vector<double>& n, const std::string& what) {
  const Eigen::Quaterniond turn(n[6], n[3], n[4], n[5]);
  if (!(std::abs(turn.norm() - 1.0) < 1e-2)) {
    throw Error(ErrorKind::bad_file,
                what + ": the quaternion must have unit length; the order is x y z qx qy qz qw");
  }
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(n[0], n[1], n[2]);
  pose.linear() = turn.normalized().toRotationMatrix();
  geometry::require_valid_position(pose.translation(), what);
  return pose;
}

/// Applies Brown-Conrady distortion to the slopes x/z, y/z of a ray.
Vector2d distorted(const Vector2d& slope, const std::array<double, 5>& coefficients) {
  const auto& [k1, k2, p1, p2, k3] = coefficients;
  const double x = slope.x(), y = slope.y(), r2 = slope.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

CameraIntrinsics to_intrinsics(const geometry::Camera& camera) {
  return {.focal_length_px = camera.focal_length_px(),
          .principal_point_px = camera.principal_point_px(),
          .distortion = {}};
}

struct Seen {
  std::uint32_t pixel;
  float depth;
  std::uint32_t point;
};

/// Assigns points in the optical frame to the pixels of the camera. Keeps the nearest point of each
/// pixel.
void organise(std::span<const Vector3d> points, const geometry::Camera& camera, ScanFound& found) {
  std::vector<Seen> seen;
  seen.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = camera.project(points[i]);
    if (!pixel) continue;
    const long column = std::clamp(std::lround(pixel->x()), 0L, camera.width() - 1L);
    const long row = std::clamp(std::lround(pixel->y()), 0L, camera.height() - 1L);
    seen.push_back({static_cast<std::uint32_t>(row * camera.width() + column),
                    static_cast<float>(points[i].z()), static_cast<std::uint32_t>(i)});
  }
  found.out_of_view = points.size() - seen.size();
  const auto is_before = [](const Seen& a, const Seen& b) {
    return std::tie(a.pixel, a.depth, a.point) < std::tie(b.pixel, b.depth, b.point);
  };
  // Points of the survey's own camera are already sorted.
  if (!std::ranges::is_sorted(seen, is_before)) std::ranges::sort(seen, is_before);
  const auto last = std::unique(seen.begin(), seen.end(),
                                [](const Seen& a, const Seen& b) { return a.pixel == b.pixel; });
  found.hidden = static_cast<std::size_t>(seen.end() - last);
  seen.erase(last, seen.end());
  found.scan.points.reserve(seen.size());
  found.scan.pixels.reserve(seen.size());
  for (const Seen& s : seen) {
    found.scan.points.push_back((found.scan.world_from_sensor * points[s.point]).cast<float>());
    found.scan.pixels.push_back(s.pixel);
  }
}

/// Inverts the distortion. Returns an empty value if the iteration does not converge.
std::optional<Vector2d> undistorted(const Vector2d& observed, const CameraIntrinsics& intrinsics) {
  Vector2d slope = observed;
  constexpr int max_rounds = 50;
  for (int round = 0; round < max_rounds; ++round) {
    const Vector2d error = observed - distorted(slope, intrinsics.distortion);
    // 0.001 pixel is far below the resolution of depth sensors.
    if (error.cwiseProduct(intrinsics.focal_length_px).norm() < 1e-3) return slope;
    slope += error;
  }
  return std::nullopt;
}

/// Reads the points of a cloud in the optical frame.
std::vector<Vector3d> points_in_sensor(const ScanInput& input) {
  const Isometry3d sensor_from_file =
      input.is_in_world ? input.world_from_sensor.inverse() : Isometry3d::Identity();
  std::vector<Vector3d> points;
  for (const Eigen::Vector3f& point : geometry::read_cloud(input.file).positions) {
    points.push_back(sensor_from_file * point.cast<double>());
  }
  return points;
}

/// Throws if the intrinsics are those of an image of another size. This is assumed if the principal
/// point is far from the image centre by the same factor in both directions.
void require_same_size(const geometry::DepthImage& image, const CameraIntrinsics& intrinsics) {
  const Vector2d middle(0.5 * (image.width - 1), 0.5 * (image.height - 1));
  const Vector2d factor = middle.cwiseQuotient(intrinsics.principal_point_px);
  constexpr double max = 1.4, same = 1.25;
  const double size = std::sqrt(factor.x() * factor.y()), skew = factor.x() / factor.y();
  const bool is_same_size = size < max && size > 1.0 / max;
  // Single rows or columns and cropped images do not permit a decision.
  if (!(size > 0.0) || is_same_size || !(skew < same && skew > 1.0 / same)) return;
  throw Error(
      ErrorKind::bad_file,
      fmt::format(
          "the intrinsics belong to an image of about {:.0f} x {:.0f} pixels (principal point "
          "{:g}, {:g}), but the image has {} x {} pixels; multiply fx fy cx cy by {:.3g}",
          2.0 * intrinsics.principal_point_px.x(), 2.0 * intrinsics.principal_point_px.y(),
          intrinsics.principal_point_px.x(), intrinsics.principal_point_px.y(), image.width,
          image.height, size));
}

}  // namespace

std::optional<Vector3d> CameraIntrinsics::ray(const Vector2d& pixel) const {
  const Vector2d observed = (pixel - principal_point_px).cwiseQuotient(focal_length_px);
  if (!observed.allFinite()) return std::nullopt;
  if (distortion == std::array<double, 5>{}) return observed.homogeneous();
  const std::optional<Vector2d> slope = undistorted(observed, *this);
  if (!slope) return std::nullopt;
  return slope->homogeneous();
}

std::vector<double> parse_numbers(const std::string& text, const std::string& what) {
  geometry::TextScanner scanner(what, text);
  std::vector<double> numbers;
  while (const auto word = scanner.word()) {
    numbers.push_back(scanner.number<double>(word, "a number"));
    if (!std::isfinite(numbers.back()) || numbers.size() > 36) {
      throw Error(ErrorKind::bad_file, what + ": must be a list of at most 36 finite numbers");
    }
  }
  return numbers;
}

CameraIntrinsics parse_intrinsics(const std::string& text, const std::string& what) {
  const std::vector<double> n = parse_numbers(text, what);
  if ((n.size() != 4 && n.size() != 9) || n[0] == 0.0 || n[1] == 0.0) {
    throw Error(ErrorKind::bad_usage, what +
                                          ": must be \"fx fy cx cy\" or \"fx fy cx cy k1 k2 p1 p2 "
                                          "k3\", with non-zero focal lengths");
  }
  CameraIntrinsics intrinsics{
      .focal_length_px = {n[0], n[1]}, .principal_point_px = {n[2], n[3]}, .distortion = {}};
  if (n.size() == 9) std::copy(n.begin() + 4, n.end(), intrinsics.distortion.begin());
  return intrinsics;
}

Isometry3d parse_pose_text(const std::string& text, const std::string& what) {
  std::vector<double> numbers = parse_numbers(text, what);
  if (numbers.size() == 8) numbers.erase(numbers.begin());
  if (numbers.size() == 7) return make_pose(numbers, what);
  if (numbers.size() == 16) {
    if (!std::equal(numbers.begin() + 12, numbers.end(), std::begin({0.0, 0.0, 0.0, 1.0}))) {
      throw Error(ErrorKind::bad_file,
                  what + ": the fourth row must be 0 0 0 1; write the matrix row by row");
    }
    numbers.resize(12);
  }
  if (numbers.size() == 12) return parse_pose(numbers, what);
  throw Error(ErrorKind::bad_file, what + ": has " + std::to_string(numbers.size()) +
                                       " numbers; it must be x y z qx qy qz qw, or a matrix of "
                                       "three or four rows with four numbers each");
}

std::vector<Vector3d> unproject_points(const geometry::DepthImage& image,
                                       const CameraIntrinsics& intrinsics, double unit,
                                       std::size_t& without_return) {
  constexpr std::uint16_t too_near = 0, too_far = 65535;
  std::vector<Vector3d> points;
  points.reserve(image.values.size());
  auto value = image.values.begin();
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column, ++value) {
      const bool is_return = *value != too_near && *value != too_far;
      const auto ray = is_return ? intrinsics.ray({column, row}) : std::nullopt;
      if (ray) {
        points.emplace_back(*ray * (unit * *value));
      } else {
        ++without_return;
      }
    }
  }
  return points;
}

ScanFound read_scan(const ScanInput& input, const flight::CaptureOptions& capture,
                    const LiveOptions& live) {
  if (input.file.extension() == ".png") {
    const geometry::DepthImage image = geometry::read_depth_png(input.file);
    try {
      return make_scan(image, input.intrinsics, input.depth_unit, input.world_from_sensor, capture,
                       live);
    } catch (const Error& error) {
      throw Error(error.kind(), input.file.string() + ": " + error.what());
    }
  }
  return make_scan(points_in_sensor(input), input.world_from_sensor, capture, live);
}

ScanFound make_scan(std::span<const Vector3d> points, const Isometry3d& world_from_sensor,
                    const flight::CaptureOptions& capture, const LiveOptions& live) {
  ScanFound found;
  found.scan.world_from_sensor = world_from_sensor;
  if (capture.is_scanner) {
    for (const Vector3d& point : points) {
      found.scan.points.push_back((world_from_sensor * point).cast<float>());
    }
  } else {
    organise(points, geometry::Camera(capture.camera), found);
  }
  found.left_out = filter(found.scan, capture.camera, live);
  return found;
}

ScanFound make_scan(const geometry::DepthImage& image,
                    const std::optional<CameraIntrinsics>& intrinsics, double unit,
                    const Isometry3d& world_from_sensor, const flight::CaptureOptions& capture,
                    const LiveOptions& live) {
  const geometry::Camera camera(capture.camera);
  ScanFound found;
  found.scan.world_from_sensor = world_from_sensor;
  const CameraIntrinsics used = intrinsics.value_or(to_intrinsics(camera));
  require_same_size(image, used);
  organise(unproject_points(image, used, unit, found.without_return), camera, found);
  found.left_out = filter(found.scan, capture.camera, live);
  return found;
}

LeftOut filter(geometry::Scan& scan, const geometry::CameraConfig& camera,
               const LiveOptions& live) {
  if (!live.removes_flying_pixels) return {};
  return remove_flying_pixels(scan, geometry::Camera(camera));
}

void require_usable(const geometry::Scan& scan, const flight::FlightOptions& flight) {
  geometry::require_usable(scan, flight.capture.camera);
  const bool needs_pixels = flight.has_vehicle() && !flight.capture.is_scanner;
  if (needs_pixels && scan.pixels.empty() && !scan.points.empty()) {
    throw Error(ErrorKind::bad_geometry,
                "the scan has no pixels; with flight.vehicle a depth image is required to "
                "establish free space");
  }
}

}  // namespace skycap::missions::online
