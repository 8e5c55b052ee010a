#include "sim/photos/simulated_photo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "geometry/parallel.h"
#include "geometry/pose/brown_distortion.h"
#include "geometry/random_numbers.h"
#include "geometry/requirement.h"
#include "geometry/split_mix.h"
#include "sim/scene/render.h"

namespace skycap::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double sky_grey = 0.75;      ///< Grey value of pixels without a surface.
constexpr double ground_level = 0.75;  ///< Albedo of the ground relative to the scene.

/// Returns a random number in [-1, 1) for a corner of the grid.
double corner_value(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t octave) {
  std::uint64_t bits = geometry::split_mix(static_cast<std::uint64_t>(x) + octave * 0x9e3779b9ULL);
  bits = geometry::split_mix(bits ^ static_cast<std::uint64_t>(y));
  bits = geometry::split_mix(bits ^ static_cast<std::uint64_t>(z));
  return 2.0 * geometry::unit_number(bits) - 1.0;
}

double smooth_step(double t) { return t * t * (3.0 - 2.0 * t); }

class Photographer {
 public:
  Photographer(const Scene& scene, const geometry::PhotoCamera& camera, const geometry::View& view,
               const PhotoOptions& options)
      : scene_(scene),
        camera_(camera),
        options_(options),
        position_(view.position),
        world_from_camera_(geometry::camera_pose(view).linear()),
        to_sun_(options.to_sun.normalized()) {}

  std::uint8_t pixel(int column, int row, std::uint64_t number) const {
    geometry::ShortRandomNumbers random(options_.seed ^ (number << 20U));
    const int side = options_.samples_per_side;
    double sum = 0.0;
    for (int i = 0; i < side * side; ++i) {
      const Vector2d offset((i % side + 0.5) / side - 0.5, (i / side + 0.5) / side - 0.5);
      const double moment = (i + 0.5) / (side * side) - 0.5;
      sum += light_along(position_ + moment * options_.motion,
                         direction({column + offset.x(), row + offset.y()}));
    }
    // The sum of twelve uniform numbers has a variance of 1.
    double noise = -6.0;
    for (int i = 0; i < 12; ++i) noise += random.uniform();
    const double grey = 255.0 * sum / (side * side) + options_.noise * noise;
    return static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
  }

 private:
  Vector3d direction(const Vector2d& pixel) const {
    Vector2d slope = (pixel - camera_.principal_point_px()) / camera_.focal_length_px();
    const auto& intrinsics = camera_.config().distortion;
    if (intrinsics) slope = geometry::undistort(*intrinsics, slope);
    return world_from_camera_ * Vector3d(slope.x(), slope.y(), 1.0);
  }

  double light_along(const Vector3d& from, const Vector3d& direction) const {
    const std::optional<Hit> hit = scene_.first_hit(from, direction);
    double distance = hit ? hit->distance : std::numeric_limits<double>::infinity();
    if (direction.z() < 0.0 && from.z() > options_.ground) {
      const double to_ground = (options_.ground - from.z()) / direction.z();
      if (to_ground < distance) {
        return ground_level * lit(from + to_ground * direction, Vector3d::UnitZ());
      }
    }
    if (!hit) return sky_grey;
    const Vector3d normal = hit->normal.dot(direction) > 0.0 ? -hit->normal : hit->normal;
    return lit(from + distance * direction, normal);
  }

  double lit(const Vector3d& point, const Vector3d& normal) const {
    constexpr double off_surface = 1e-3, far = 1e4;  // [m]
    double cosine = std::max(0.0, normal.dot(to_sun_));
    const Vector3d start = point + off_surface * normal;
    if (cosine > 0.0 && scene_.is_blocked(start, start + far * to_sun_)) cosine = 0.0;
    return textured_albedo(point, options_.gsd, options_.contrast) * (0.5 + 0.5 * cosine);
  }

  const Scene& scene_;
  const geometry::PhotoCamera& camera_;
  const PhotoOptions& options_;
  Vector3d position_;
  Eigen::Matrix3d world_from_camera_;
  Vector3d to_sun_;
};

}  // namespace

double value_noise(const Vector3d& point, std::uint32_t octave) {
  std::array<std::int64_t, 3> corner{};
  std::array<double, 3> weight{};
  for (int axis = 0; axis < 3; ++axis) {
    const double below = std::floor(point[axis]);
    corner[axis] = static_cast<std::int64_t>(below);
    weight[axis] = smooth_step(point[axis] - below);
  }
  double value = 0.0;
  for (int i = 0; i < 8; ++i) {
    const int dx = i & 1, dy = (i >> 1) & 1, dz = (i >> 2) & 1;
    value += (dx ? weight[0] : 1.0 - weight[0]) * (dy ? weight[1] : 1.0 - weight[1]) *
             (dz ? weight[2] : 1.0 - weight[2]) *
             corner_value(corner[0] + dx, corner[1] + dy, corner[2] + dz, octave);
  }
  return value;
}

double textured_albedo(const Vector3d& point, double gsd, double contrast) {
  struct Octave {
    double wavelength, weight;
  };
  constexpr std::array octaves{Octave{1.7, 0.22}, Octave{4.3, 0.20}, Octave{13.0, 0.16},
                               Octave{60.0, 0.12}};
  double albedo = 0.5;
  for (std::uint32_t i = 0; i < octaves.size(); ++i) {
    albedo += contrast * octaves[i].weight * value_noise(point / (octaves[i].wavelength * gsd), i);
  }
  return std::clamp(albedo, 0.0, 1.0);
}

void PhotoOptions::validate() const {
  require(gsd > 0.0, "gsd", gsd, "above 0 m");
  require(contrast >= 0.0, "contrast", contrast, "at least 0");
  require(to_sun.norm() > 0.0, "to_sun", to_sun.norm(), "a direction");
  require(noise >= 0.0, "noise", noise, "at least 0");
  require(samples_per_side >= 1 && samples_per_side <= 16, "samples_per_side", samples_per_side,
          "from 1 to 16");
}

GreyImage simulate_photo(const Scene& scene, const geometry::PhotoCamera& camera,
                         const geometry::View& view, const PhotoOptions& options) {
  options.validate();
  GreyImage image{camera.width(), camera.height(), {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) * image.height);
  const Photographer photographer(scene, camera, view, options);
  geometry::parallel_for(
      static_cast<std::size_t>(image.height), options.threads, [&](std::size_t row) {
        for (int column = 0; column < image.width; ++column) {
          const std::size_t number = row * image.width + column;
          image.pixels[number] = photographer.pixel(column, static_cast<int>(row), number);
        }
      });
  return image;
}

void write_png(const GreyImage& image, const std::filesystem::path& path) {
  Image coloured{image.width, image.height, {}};
  coloured.pixels.reserve(image.pixels.size());
  for (const std::uint8_t grey : image.pixels) coloured.pixels.push_back({grey, grey, grey});
  write_png(coloured, path);
}

}  // namespace skycap::sim
