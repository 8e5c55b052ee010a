#include "sim/photos/photo_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "geometry/parallel.h"
#include "geometry/pose/brown_distortion.h"

namespace skycap::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Photo in the form that the matcher uses.
struct MatchedPhoto {
  const GreyImage* image;
  Vector3d position;
  Eigen::Matrix3d camera_from_world;
};

/// Geometry of a sample in one photo.
struct PhotoObservation {
  std::size_t capture;
  Vector3d ray;     ///< Unit vector from the sample to the camera.
  double distance;  ///< Distance from the camera [m].
  double cosine;    ///< Cosine of the angle of incidence.
};

/// Grey values of a patch. Empty if a part of it is outside the image.
using Patch = std::vector<double>;

class Matcher {
 public:
  Matcher(std::span<const GreyImage> images, std::span<const geometry::View> views,
          const geometry::PhotoCamera& camera, const MatchOptions& options)
      : camera_(camera), options_(options) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      photos_.push_back(
          {&images[i], views[i].position, geometry::camera_pose(views[i]).linear().transpose()});
    }
  }

  std::vector<PhotoObservation> observations(const MatchSample& sample,
                                             std::span<const geometry::View> views,
                                             const auto& is_visible) const {
    std::vector<PhotoObservation> found;
    const double min_cosine = std::cos(options_.max_incidence);
    for (std::size_t i = 0; i < photos_.size(); ++i) {
      const Vector3d to_camera = photos_[i].position - sample.point;
      const double distance = to_camera.norm();
      const double cosine = sample.normal.dot(to_camera) / distance;
      if (cosine < min_cosine || !project(photos_[i], sample.point)) continue;
      if (!is_visible(views[i], sample)) continue;
      found.push_back({i, to_camera / distance, distance, cosine});
    }
    std::ranges::stable_sort(found, {}, [](const PhotoObservation& observation) {
      return observation.distance / observation.cosine;
    });
    return found;
  }

  std::uint8_t right_depths(const MatchSample& sample,
                            const std::vector<PhotoObservation>& observations) const {
    std::uint8_t right = 0;
    for (std::size_t i = 0; i < std::min(options_.references, observations.size()); ++i) {
      if (is_right(sample, observations[i], find_partners(observations[i], observations))) ++right;
    }
    return right;
  }

 private:
  std::optional<Vector2d> project(const MatchedPhoto& capture, const Vector3d& point) const {
    const Vector3d local = capture.camera_from_world * (point - capture.position);
    if (!(local.z() > 0.0)) return std::nullopt;
    Vector2d slope = local.head<2>() / local.z();
    if (const auto& intrinsics = camera_.config().distortion)
      slope = geometry::distort(*intrinsics, slope);
    const Vector2d pixel = camera_.focal_length_px() * slope + camera_.principal_point_px();
    if (!(pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= camera_.width() - 1.0 &&
          pixel.y() <= camera_.height() - 1.0)) {
      return std::nullopt;
    }
    return pixel;
  }

  static double grey_at(const GreyImage& image, const Vector2d& pixel) {
    const int column = std::min(static_cast<int>(pixel.x()), image.width - 2);
    const int row = std::min(static_cast<int>(pixel.y()), image.height - 2);
    const double u = pixel.x() - column, v = pixel.y() - row;
    return (1.0 - v) * ((1.0 - u) * image.at(column, row) + u * image.at(column + 1, row)) +
           v * ((1.0 - u) * image.at(column, row + 1) + u * image.at(column + 1, row + 1));
  }

  std::vector<PhotoObservation> find_partners(
      const PhotoObservation& reference, const std::vector<PhotoObservation>& observations) const {
    std::vector<PhotoObservation> partners;
    for (const PhotoObservation& other : observations) {
      if (other.capture == reference.capture) continue;
      const double parallax = compute_parallax(reference, other);
      const double scale = std::max(reference.distance, other.distance) /
                           std::min(reference.distance, other.distance);
      if (parallax < options_.min_parallax || parallax > options_.max_parallax) continue;
      if (scale < options_.max_scale) partners.push_back(other);
    }
    std::ranges::stable_sort(partners, {}, [&](const PhotoObservation& other) {
      return std::abs(compute_parallax(reference, other) - options_.ideal_parallax);
    });
    if (partners.size() > options_.partners) partners.resize(options_.partners);
    return partners;
  }

  static double compute_parallax(const PhotoObservation& a, const PhotoObservation& b) {
    return std::atan2(a.ray.cross(b.ray).norm(), a.ray.dot(b.ray));
  }

  /// Returns the directions of the rays through the patch's pixels in the reference photo.
  std::vector<Vector3d> patch_rays(const MatchedPhoto& capture, const Vector2d& centre) const {
    std::vector<Vector3d> rays;
    for (int dv = -options_.patch_radius; dv <= options_.patch_radius; ++dv) {
      for (int du = -options_.patch_radius; du <= options_.patch_radius; ++du) {
        Vector2d slope =
            (centre + Vector2d(du, dv) - camera_.principal_point_px()) / camera_.focal_length_px();
        if (const auto& intrinsics = camera_.config().distortion) {
          slope = geometry::undistort(*intrinsics, slope);
        }
        rays.emplace_back(capture.camera_from_world.transpose() *
                          Vector3d(slope.x(), slope.y(), 1.0));
      }
    }
    return rays;
  }

  Patch reference_patch(const MatchedPhoto& capture, const Vector2d& centre) const {
    const double r = options_.patch_radius;
    if (centre.x() < r || centre.y() < r || centre.x() > camera_.width() - 1.0 - r ||
        centre.y() > camera_.height() - 1.0 - r) {
      return {};
    }
    Patch patch;
    for (int dv = -options_.patch_radius; dv <= options_.patch_radius; ++dv) {
      for (int du = -options_.patch_radius; du <= options_.patch_radius; ++du) {
        patch.push_back(grey_at(*capture.image, centre + Vector2d(du, dv)));
      }
    }
    return patch;
  }

  /// Returns the patch in a partner's image under the assumption that it is on the plane through
  /// `point`.
  Patch partner_patch(const MatchedPhoto& capture, const Vector3d& origin,
                      const std::vector<Vector3d>& rays, const Vector3d& point,
                      const Vector3d& normal) const {
    Patch patch;
    const double offset = normal.dot(point - origin);
    for (const Vector3d& ray : rays) {
      const double slope = normal.dot(ray);
      if (!(slope * offset > 0.0))
        return {};  // The plane is parallel to the ray, or behind the camera.
      const auto pixel = project(capture, origin + offset / slope * ray);
      if (!pixel) return {};
      patch.push_back(grey_at(*capture.image, *pixel));
    }
    return patch;
  }

  /// Returns the normalised cross-correlation in [-1, 1], or -1 without texture.
  static double correlation(const Patch& a, const Patch& b) {
    double mean_a = 0.0, mean_b = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i], mean_b += b[i];
    mean_a /= static_cast<double>(a.size()), mean_b /= static_cast<double>(b.size());
    double ab = 0.0, aa = 0.0, bb = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      ab += (a[i] - mean_a) * (b[i] - mean_b);
      aa += (a[i] - mean_a) * (a[i] - mean_a);
      bb += (b[i] - mean_b) * (b[i] - mean_b);
    }
    constexpr double min_variance = 1.0;  // Minimum variance of the grey levels in the patch.
    if (aa < min_variance || bb < min_variance) return -1.0;
    return ab / std::sqrt(aa * bb);
  }

  bool is_right(const MatchSample& sample, const PhotoObservation& reference,
                const std::vector<PhotoObservation>& partners) const {
    if (partners.empty()) return false;
    const MatchedPhoto& capture = photos_[reference.capture];
    const auto centre = project(capture, sample.point);
    if (!centre) return false;
    const Patch own = reference_patch(capture, *centre);
    if (own.empty()) return false;
    const std::vector<Vector3d> rays = patch_rays(capture, *centre);
    const double gsd = reference.distance / camera_.focal_length_px();
    // Each step moves the point by at most half a pixel in any partner.
    double max_move = 0.0;  // Image motion per depth [px/m].
    for (const PhotoObservation& partner : partners) {
      max_move = std::max(max_move, camera_.focal_length_px() *
                                        reference.ray.cross(partner.ray).norm() / partner.distance);
    }
    const double step = 0.5 / max_move, range = options_.search * gsd;
    const int steps = static_cast<int>(std::ceil(range / step));
    double best_score = -1.0, best_depth = 0.0;
    for (int i = -steps; i <= steps; ++i) {
      const double depth = i * step;
      const Vector3d point = sample.point - depth * reference.ray;
      const double found = score(own, capture.position, rays, point, sample.normal, partners);
      if (found > best_score) best_score = found, best_depth = depth;
    }
    return best_score > options_.min_score && std::abs(best_depth) <= options_.tolerance * gsd;
  }

  /// Returns the mean of the three best correlations, or of all if there are fewer partners.
  double score(const Patch& own, const Vector3d& origin, const std::vector<Vector3d>& rays,
               const Vector3d& point, const Vector3d& normal,
               const std::vector<PhotoObservation>& partners) const {
    std::array<double, 3> best{-1.0, -1.0, -1.0};
    for (const PhotoObservation& partner : partners) {
      const Patch other = partner_patch(photos_[partner.capture], origin, rays, point, normal);
      if (other.empty()) continue;
      double value = correlation(own, other);
      for (double& kept : best) {
        if (value > kept) std::swap(value, kept);
      }
    }
    const std::size_t count = std::min(best.size(), partners.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += best[i];
    return sum / static_cast<double>(count);
  }

  const geometry::PhotoCamera& camera_;
  const MatchOptions& options_;
  std::vector<MatchedPhoto> photos_;
};

}  // namespace

std::vector<std::uint8_t> right_depths(
    std::span<const MatchSample> samples, std::span<const GreyImage> images,
    std::span<const geometry::View> views, const geometry::PhotoCamera& camera,
    const std::function<bool(const geometry::View& view, const MatchSample& sample)>& is_visible,
    const MatchOptions& options) {
  const Matcher matcher(images, views, camera, options);
  std::vector<std::uint8_t> right(samples.size(), 0);
  geometry::parallel_for(samples.size(), options.threads, [&](std::size_t i) {
    right[i] =
        matcher.right_depths(samples[i], matcher.observations(samples[i], views, is_visible));
  });
  return right;
}

double completeness(std::span<const std::uint8_t> right, std::uint8_t depths) {
  if (right.empty()) return 0.0;
  const auto count = std::ranges::count_if(right, [&](std::uint8_t n) { return n >= depths; });
  return static_cast<double>(count) / static_cast<double>(right.size());
}

}  // namespace skycap::sim
