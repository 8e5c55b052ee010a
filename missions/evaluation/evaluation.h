/// Visible and attainable surface: upper bounds for the coverage of a survey.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/scan.h"
#include "geometry/pose/pose.h"
#include "sim/scene/scene.h"

namespace skycap::missions::evaluation {

/// Permitted sensor poses for observing the scene.
struct Admissible {
  double view_distance = 1.0;  ///< distance from the target point on the surface [m]
  /// Additional condition for a view. It is called concurrently from several threads. Empty: every
  /// view is permitted.
  std::function<bool(const geometry::View&)> allows;
  /// Directions tested around a surface point, distributed over the sphere.
  std::size_t directions = 200;
  double clearance = 1e-4;  ///< distance from the surface point at which a sight line may end [m]
};

/// Returns the first admissible position with a free line of sight to `target`. `directions` are
/// tested cyclically, starting at index `first`. Returns nullopt if no direction has a free line of
/// sight.
std::optional<Eigen::Vector3d> free_position(const Eigen::Vector3d& target,
                                             std::span<const Eigen::Vector3d> directions,
                                             std::size_t first, const sim::Scene& scene,
                                             const Admissible& admissible);

/// Returns 1 for each sample with a free line of sight from an admissible position, and 0 for the
/// others. Computed in parallel; the result is invalid after a stop request.
std::vector<std::uint8_t> visible_samples(std::span<const Eigen::Vector3f> samples,
                                          const sim::Scene& scene, const Admissible& admissible,
                                          unsigned threads = 0, std::stop_token stop = {});

/// Settings for computing the attainable coverage.
struct AttainableConfig {
  std::size_t views = 100;
  double spacing = 0.003;                ///< epsilon, minimum distance between stored points [m]
  double registration_distance = 0.005;  ///< r_d, coverage distance [m]
  Eigen::AlignedBox3d box;               ///< measurements outside are discarded; empty: unlimited
  std::uint64_t seed = 1;
};

/// Simulates a scan from a view. `frame` is the scan's number in the noise sequence; the memory of
/// `buffer` may be reused.
using CaptureScan = std::function<geometry::Scan(const geometry::View& view, std::uint64_t frame,
                                                 geometry::Scan buffer)>;

/// Returns 1 for each sample that a survey could cover despite sensor noise and point spacing, and
/// 0 for the others. These are the samples covered by up to `views` admissible views, each aimed at
/// a visible sample not covered by previous views. Ends early if all visible samples are covered.
/// The result is invalid after a stop request.
std::vector<std::uint8_t> attainable_samples(
    std::span<const Eigen::Vector3f> samples, std::span<const std::uint8_t> is_visible,
    const sim::Scene& scene, const CaptureScan& capture_scan, const Admissible& admissible,
    const AttainableConfig& config, const std::stop_token& stop = {});

}  // namespace skycap::missions::evaluation
