/// Measured surface as small patches ("surfels") with the coverage of each.
///
/// A surfel is created from a block of measurements where no surfel exists. Later scans add the
/// hazard of their observation to it (dose_model.h). The covered fraction of a surfel is 1 -
/// exp(-hazard), so the predicted coverage of the surface is a sum over surfels.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/point_grid.h"
#include "survey/surfel/block_image.h"
#include "survey/surfel/coverage_model.h"

namespace skycap::survey::surfel {

/// Surfels as a structure of arrays. Surfel indices never change.
struct Surfels {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< unit vectors towards the free side
  std::vector<float> areas;
  std::vector<float> hazards;          ///< sum of the hazards of all observations
  std::vector<float> blurred_hazards;  ///< `hazards`, averaged over the area in which noise
                                       ///< scatters the measurements
  std::vector<float>
      trusts;  ///< in (0, 1]; reduced when an observation yields far less than predicted
  std::vector<float> qualities;  ///< maximum Block::quality of all observations
  std::vector<std::uint8_t>
      merges;  ///< number of observations averaged into position and normal, at most 8
  /// Bit mask over six tangent directions (60 degrees apart, starting at tangent()). Bit i is set
  /// if the surfel has no neighbour in direction i, where the surface may continue unobserved.
  std::vector<std::uint8_t> open_directions;
  std::vector<Eigen::Vector3f> first_tangents;  ///< first of the six directions; unit vector

  std::size_t size() const { return positions.size(); }
  float covered_share(std::size_t i) const;
  /// Returns the area that is expected to lack a measurement [m^2].
  float deficit(std::size_t i) const;
};

/// Returns tangent direction `k` (0 to 5) of surfel `i`.
Eigen::Vector3f open_direction(const Surfels& surfels, std::size_t i, int k);

/// Returns whether earlier scans have measured a position.
using IsMeasured = std::function<bool(const Eigen::Vector3f&)>;

class SurfelMap {
 public:
  /// `spacing` (h) is the approximate distance between surfels [m].
  explicit SurfelMap(float spacing, unsigned threads = 1);

  /// Adds the blocks of a scan. First adds observations to existing surfels, then creates surfels
  /// in uncovered places. `jump` is J of BlockSettings. Blocks outside `region`, if given, create
  /// no surfels. New surfels at positions for which `was_measured` returns true have no area. They
  /// only refine the shape, because surface between existing surfels is not new surface.
  void add(const BlockImage& image, const CoverageModel& coverage_model, float jump,
           const std::optional<Eigen::AlignedBox3f>& region, const IsMeasured& was_measured = {});

  const Surfels& surfels() const { return surfels_; }
  float spacing() const { return spacing_; }

  bool has_surfel_near(const Eigen::Vector3f& point, float radius) const;

  /// Returns whether a surfel beyond the edge at surfel `i` has a different orientation, which
  /// usually indicates a convex edge.
  bool has_other_face_near(std::size_t i) const;

  /// Returns the total area of the surfels with index >= `first` within `radius` of a point [m^2].
  double area_near(const Eigen::Vector3f& point, float radius, std::size_t first) const;

  /// Returns the covered area of new territory [m^2]: of the surfels with index >= `first` that
  /// have no earlier surfel within two spacings. Filled gaps in the known surface are excluded.
  double new_territory(std::size_t first) const;

  /// Multiplies the trust in surfel `i` by `factor`.
  void lower_trust(std::size_t i, float factor) { surfels_.trusts[i] *= factor; }

  double area() const;
  double covered_area() const;

 private:
  void add_observations(const BlockImage& image, const CoverageModel& coverage_model, float jump);
  void add_surfels(const BlockImage& image, const CoverageModel& coverage_model,
                   const std::optional<Eigen::AlignedBox3f>& region,
                   const IsMeasured& was_measured);
  void close_directions(std::size_t added);
  void blur_hazards(double sigma);
  bool is_occupied(const Block& block);

  float spacing_;
  unsigned threads_;
  geometry::PointGrid grid_;  ///< surfel positions at creation
  Surfels surfels_;
  /// Two surfels that are close enough to share measurements.
  struct Pair {
    std::uint32_t first, second;
    float squared_distance;
  };
  std::vector<Pair> pairs_;
  std::vector<geometry::Neighbour> found_;  // scratch array
};

}  // namespace skycap::survey::surfel
