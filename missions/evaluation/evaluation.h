/// What could have been covered at all: what a survey's coverage is read against.
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

#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "sim/scene/scene.h"

namespace skycap::missions::evaluation {

/// Where a sensor may look at the scene from.
struct Admissible {
  double view_distance = 1.0;  ///< from the surface point looked at
  /// Whether the sensor may be there, on top of that; must be safe to call from several threads.
  /// Empty: anywhere.
  std::function<bool(const geometry::View&)> allows;
  std::size_t directions = 200;  ///< tried around a surface point, spread over the sphere
  double clearance = 1e-4;       ///< a sight line may end this far before the surface point
};

/// The first admissible position, trying `directions` from number `first` on and around, that has
/// a free line of sight to `target`; nothing if none has.
std::optional<Eigen::Vector3d> free_position(const Eigen::Vector3d& target,
                                             std::span<const Eigen::Vector3d> directions,
                                             std::size_t first, const sim::Scene& scene,
                                             const Admissible& admissible);

/// For each sample, 1 if some admissible sensor position has a free line of sight to it, else 0.
/// Ends early, of no use, when `stop` is requested.
std::vector<std::uint8_t> visible_samples(std::span<const Eigen::Vector3f> samples,
                                          const sim::Scene& scene, const Admissible& admissible,
                                          unsigned threads = 0, std::stop_token stop = {});

/// How the attainable coverage is measured.
struct CeilingConfig {
  std::size_t views = 100;
  double spacing = 0.003;                ///< epsilon, least distance of stored points
  double registration_distance = 0.005;  ///< r_d
  Eigen::AlignedBox3d box;               ///< measurements outside are dropped; empty: none is
  std::uint64_t seed = 1;
};

/// What the sensor measures from a view; `frame` numbers its scans, and the memory of `recycled`
/// may be used again.
using TakeScan = std::function<geometry::Scan(const geometry::View& view, std::uint64_t frame,
                                              geometry::Scan recycled)>;

/// For each sample, 1 if a survey could cover it at all, given sensor noise and the spacing of
/// stored points, else 0: what up to `views` admissible views cover together, each aimed at a
/// visible sample that the views before have left uncovered. Ends early when there is none left,
/// or, of no use, when `stop` is requested.
std::vector<std::uint8_t> attainable_samples(std::span<const Eigen::Vector3f> samples,
                                             std::span<const std::uint8_t> is_visible,
                                             const sim::Scene& scene, const TakeScan& take_scan,
                                             const Admissible& admissible,
                                             const CeilingConfig& config,
                                             const std::stop_token& stop = {});

}  // namespace skycap::missions::evaluation
