#include "sim/scene/render.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>

#include "geometry/angle.h"
#include "geometry/parallel.h"
#include "geometry/random_numbers.h"
#include "geometry/requirement.h"
#include "sim/scene/scene.h"

namespace skycap::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

// Linear colours of sandstone and paving, and the light of sun, zenith, horizon and ground.
const Vector3d stone(0.80, 0.71, 0.55);
const Vector3d paving(0.42, 0.42, 0.38);
const Vector3d sunlight(1.55, 1.42, 1.15);
const Vector3d zenith(0.20, 0.36, 0.66);
const Vector3d horizon(0.66, 0.76, 0.88);

constexpr int rows_at_a_time = 25;  ///< About 0.1 s of work for large scenes.

/// Seeded with the position of the sample, so that any thread may compute it.
using Rng = geometry::ShortRandomNumbers;

/// Returns a random unit vector around `normal` with cosine-weighted probability.
Vector3d cosine_direction(const Vector3d& normal, double u, double v) {
  const Vector3d right = geometry::any_orthogonal(normal), ahead = normal.cross(right);
  const double angle = 2.0 * pi * u, radius = std::sqrt(v);
  return radius * std::cos(angle) * right + radius * std::sin(angle) * ahead +
         std::sqrt(1.0 - v) * normal;
}

Vector3d sky(const Vector3d& direction) {
  const double height = std::clamp(direction.z(), 0.0, 1.0);
  return horizon + std::sqrt(height) * (zenith - horizon);
}

/// Returns the displayed colour: highlights are compressed, then the sRGB curve is applied.
Rgb display(const Vector3d& light) {
  Rgb pixel;
  for (int i = 0; i < 3; ++i) {
    const double value = 1.0 - std::exp(-1.25 * light[i]);
    const double coded =
        value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
    pixel[i] = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(coded, 0.0, 1.0)));
  }
  return pixel;
}

/// Returns the shading normal of every triangle corner. It is the area-weighted mean over the
/// triangles around the vertex whose angle to this triangle is within the smoothing angle.
std::vector<Eigen::Vector3f> corner_normals(const Mesh& mesh, double smoothing_angle) {
  const std::size_t count = mesh.triangles.size();
  std::vector<Eigen::Vector3f> areas(count);
  std::vector<std::uint32_t> first(mesh.vertices.size() + 1, 0);
  for (std::size_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    areas[t] = (mesh.vertices[b] - mesh.vertices[a])
                   .cross(mesh.vertices[c] - mesh.vertices[a])
                   .cast<float>();
    for (const std::uint32_t v : mesh.triangles[t]) ++first[v + 1];
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) first[v + 1] += first[v];
  std::vector<std::uint32_t> around(3 * count), fill(first.begin(), first.end() - 1);
  for (std::size_t t = 0; t < count; ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      around[fill[v]++] = static_cast<std::uint32_t>(t);
    }
  }
  const auto min_cosine = static_cast<float>(std::cos(smoothing_angle));
  std::vector<Eigen::Vector3f> normals(3 * count);
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = mesh.triangles[t][corner];
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (std::uint32_t i = first[v]; i < first[v + 1]; ++i) {
        const Eigen::Vector3f& area = areas[around[i]];
        if (area.dot(areas[t]) >= min_cosine * area.norm() * areas[t].norm()) sum += area;
      }
      normals[3 * t + corner] = sum.normalized();
    }
  }
  return normals;
}

/// Scene with its shading data.
class Renderer {
 public:
  Renderer(const Mesh& mesh, const RenderOptions& options)
      : mesh_(mesh),
        options_(options),
        scene_(mesh, options.threads),
        normals_(corner_normals(mesh, options.smoothing_angle)) {
    const Eigen::AlignedBox3d box = bounding_box(mesh);
    size_ = box.diagonal().norm();
    centre_ = box.center();
    floor_ = box.min().z() - 1e-4 * size_;  // Below a ground sheet of the mesh itself.
  }

  /// Draws a view. `report` receives the number of completed rows.
  void draw(const RenderView& view, int left, int top, Image& image,
            const std::function<void(int rows)>& report) {
    const Eigen::Isometry3d world_from_camera = camera_pose(view.view);
    to_sun_ = compute_sun_direction(world_from_camera);
    const double slope = std::tan(0.5 * view.horizontal_fov) / (0.5 * options_.width);
    const auto draw_row = [&](std::size_t row) {
      for (int column = 0; column < options_.width; ++column) {
        const auto pixel = [&](double du, double dv) {
          const Vector3d ray((column + du - 0.5 * options_.width) * slope,
                             (static_cast<double>(row) + dv - 0.5 * options_.height) * slope, 1.0);
          return Vector3d((world_from_camera.linear() * ray).normalized());
        };
        Rng rng(row * static_cast<std::uint64_t>(options_.width) + column);
        const int side = options_.samples_per_side;
        Vector3d sum = Vector3d::Zero();
        for (int i = 0; i < side * side; ++i) {
          const int row_in_pixel = i / side;
          const double down = (row_in_pixel + rng.uniform()) / side,
                       across = (i % side + rng.uniform()) / side;
          const Vector3d direction = pixel(across, down);
          // Clipped before averaging, so that one bright sample does not dominate an edge.
          sum += light_along(view.view.position, direction, rng).cwiseMin(2.5);
        }
        image.at(left + column, top + static_cast<int>(row)) = display(sum / (side * side));
      }
    };
    for (int begin = 0; begin < options_.height; begin += rows_at_a_time) {
      const int rows = std::min(rows_at_a_time, options_.height - begin);
      geometry::parallel_for(static_cast<std::size_t>(rows), options_.threads,
                             [&](std::size_t row) { draw_row(begin + row); });
      report(begin + rows);
    }
  }

 private:
  Vector3d compute_sun_direction(const Eigen::Isometry3d& world_from_camera) const {
    // The right axis of the image is level, so right x up is the forward direction on the ground.
    const Vector3d right = world_from_camera.linear().col(0), up = Vector3d::UnitZ();
    const Vector3d back = right.cross(up);
    const Vector3d on_ground =
        std::cos(options_.sun_to_the_left) * back - std::sin(options_.sun_to_the_left) * right;
    return std::cos(options_.sun_elevation) * on_ground + std::sin(options_.sun_elevation) * up;
  }

  Vector3d light_along(const Vector3d& origin, const Vector3d& direction, Rng& rng) const {
    const std::optional<Hit> hit = scene_.first_hit(origin, direction);
    if (options_.has_floor && direction.z() < -1e-6 && origin.z() > floor_) {
      const double distance = (floor_ - origin.z()) / direction.z();
      if (!hit || distance < hit->distance) return floor_light(origin, direction, distance, rng);
    }
    if (!hit) return sky(direction);
    const Vector3d point = origin + hit->distance * direction;
    Vector3d normal = hit->normal;
    if (normal.dot(direction) > 0.0) normal = -normal;  // Inner side of an open mesh.
    Vector3d smooth = smooth_normal(hit->triangle, point);
    if (smooth.dot(normal) < 0.0) smooth = -smooth;
    const Vector3d colour =
        options_.colours.empty() ? stone : options_.colours[hit->triangle].cast<double>();
    return colour.cwiseProduct(incoming(point, normal, smooth, rng));
  }

  Vector3d floor_light(const Vector3d& origin, const Vector3d& direction, double distance,
                       Rng& rng) const {
    const Vector3d point = origin + distance * direction;
    const Vector3d up = Vector3d::UnitZ();
    // The floor has no edge and fades into the haze of the horizon.
    const double away = (point - centre_).norm() / size_;
    const double haze = 1.0 - std::exp(-0.01 * away * away);
    if (haze > 0.99) return horizon;
    return (1.0 - haze) * paving.cwiseProduct(incoming(point, up, up, rng)) + haze * horizon;
  }

  Vector3d smooth_normal(std::uint32_t triangle, const Vector3d& point) const {
    const auto& [ia, ib, ic] = mesh_.triangles[triangle];
    const Vector3d &a = mesh_.vertices[ia], &b = mesh_.vertices[ib], &c = mesh_.vertices[ic];
    const Vector3d area = (b - a).cross(c - a);
    // Barycentric weights, clamped to the triangle because of rounding.
    const double wb = std::clamp((point - a).cross(c - a).dot(area) / area.squaredNorm(), 0.0, 1.0);
    const double wc = std::clamp((b - a).cross(point - a).dot(area) / area.squaredNorm(), 0.0, 1.0);
    const std::size_t first = 3 * static_cast<std::size_t>(triangle);
    const Eigen::Vector3f normal = static_cast<float>(1.0 - wb - wc) * normals_[first] +
                                   static_cast<float>(wb) * normals_[first + 1] +
                                   static_cast<float>(wc) * normals_[first + 2];
    return normal.cast<double>().normalized();
  }

  /// Returns the light that reaches a surface: direct sunlight unless blocked, light of the open
  /// sky, and some reflected light from the blocked part of the sky.
  Vector3d incoming(const Vector3d& point, const Vector3d& normal, const Vector3d& smooth,
                    Rng& rng) const {
    const Vector3d start = point + 2e-5 * size_ * normal;
    const double sine = smooth.dot(to_sun_);
    Vector3d light = Vector3d::Zero();
    if (sine > 0.0 && normal.dot(to_sun_) > 0.0) {
      // The sun is a disc of about one degree, for soft shadow edges.
      const Vector3d wobble{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5};
      const Vector3d to_sun = to_sun_ + 0.015 * wobble;
      if (!scene_.is_blocked(start, start + 2.0 * size_ * to_sun)) light += sine * sunlight;
    }
    for (int i = 0; i < options_.sky_rays; ++i) {
      // Strata in u separate the few rays.
      const double u = (i + rng.uniform()) / options_.sky_rays, v = rng.uniform();
      const Vector3d direction = cosine_direction(smooth, u, v);
      const bool is_open = direction.dot(normal) > 0.0 &&
                           (direction.z() > 0.0 || !options_.has_floor) &&
                           !scene_.is_blocked(start, start + 2.0 * size_ * direction);
      const Vector3d from_there = is_open ? sky(direction) : 0.18 * stone;
      light += from_there / options_.sky_rays;
    }
    return light;
  }

  const Mesh& mesh_;
  const RenderOptions& options_;
  Scene scene_;
  std::vector<Eigen::Vector3f> normals_;
  Vector3d to_sun_ = Vector3d::UnitZ();
  Vector3d centre_;
  double size_, floor_;
};

/// Returns the view along `direction` from the minimum distance at which all vertices are in the
/// image.
RenderView make_overview(const Mesh& mesh, const Vector3d& direction, double horizontal_fov,
                         double aspect) {
  const Vector3d centre = bounding_box(mesh).center();
  const Eigen::Matrix3d camera_from_world =
      geometry::camera_pose({centre, direction.normalized()}).linear().transpose();
  const double slope = 0.95 * std::tan(0.5 * horizontal_fov);  // Leaves a margin.
  double distance = 0.0;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      const Vector3d point = camera_from_world * (mesh.vertices[v] - centre);
      const double width = std::max(std::abs(point.x()), aspect * std::abs(point.y()));
      distance = std::max(distance, width / slope - point.z());
    }
  }
  return {{centre - distance * direction.normalized(), direction.normalized()}, horizontal_fov};
}

}  // namespace

void RenderOptions::validate() const {
  const auto in_range = [](int value, int max) { return value >= 1 && value <= max; };
  require(in_range(width, 16384), "width", width, "from 1 to 16384 pixels");
  require(in_range(height, 16384), "height", height, "from 1 to 16384 pixels");
  require(in_range(columns, 16), "columns", columns, "from 1 to 16");
  require(in_range(samples_per_side, 64), "samples_per_side", samples_per_side, "from 1 to 64");
  require(in_range(sky_rays, 1024), "sky_rays", sky_rays, "from 1 to 1024");
  require(sun_elevation > 0.0 && sun_elevation < 0.5 * pi, "sun_elevation", sun_elevation,
          "between 0 and pi/2 radians");
}

std::vector<RenderView> standard_views(const Mesh& mesh, double aspect) {
  geometry::validate(mesh);
  const double fov = 35.0 * geometry::radians_per_degree;
  std::vector<RenderView> views{make_overview(mesh, {0.0, -1.0, -0.04}, fov, aspect),
                                make_overview(mesh, {0.80, 0.60, -0.25}, fov, aspect),
                                make_overview(mesh, {0.62, 0.70, -0.85}, fov, aspect)};
  // Detail: the second view with a longer focal length, at a third of the height.
  RenderView detail = views[1];
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  Vector3d target = box.center();
  target.z() = box.min().z() + 0.36 * box.sizes().z();
  detail.view = geometry::look_at(detail.view.position, target);
  detail.horizontal_fov = fov / 2.8;
  views.push_back(detail);
  return views;
}

Image render(const Mesh& mesh, std::span<const RenderView> views, const RenderOptions& options) {
  options.validate();
  require(options.colours.empty() || options.colours.size() == mesh.triangles.size(), "colours",
          static_cast<double>(options.colours.size()), "none, or one for each triangle");
  Renderer renderer(mesh, options);
  const int count = static_cast<int>(views.size());
  const int columns = std::min(options.columns, count);
  const int rows = columns == 0 ? 0 : (count + columns - 1) / columns;
  Image image{columns * options.width, rows * options.height, {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) * image.height, Rgb{255, 255, 255});
  for (int i = 0; i < count; ++i) {
    const auto report = [&](int drawn) {
      const double finished_images = i + static_cast<double>(drawn) / options.height;
      if (options.report) options.report(finished_images / count);
    };
    renderer.draw(views[i], i % columns * options.width, i / columns * options.height, image,
                  report);
  }
  return image;
}

Image render(const Mesh& mesh, const RenderOptions& options) {
  options.validate();
  const double aspect = static_cast<double>(options.width) / options.height;
  return render(mesh, standard_views(mesh, aspect), options);
}

}  // namespace skycap::sim
