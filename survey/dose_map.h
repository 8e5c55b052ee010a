/// The measured surface as small patches ("surfels"), and how well each is covered so far.
///
/// A surfel is made from a block of measurements where there is none yet; later scans add the
/// hazard of their look to it (dose_model.h). Its covered share is 1 - exp(-hazard), so the
/// surface's predicted coverage is a sum over surfels.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "survey/block_image.h"
#include "survey/cell_grid.h"
#include "survey/dose_model.h"

namespace skycap::survey {

/// Structure of arrays; a surfel's index never changes.
struct Surfels {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;   ///< unit, towards the free side
  std::vector<float> areas;
  std::vector<float> hazards;             ///< sum of the hazards of all looks
  std::vector<float> trusts;              ///< in (0, 1]: falls when a look gives far less than hoped
  std::vector<std::uint8_t> merges;       ///< looks averaged into position and normal, at most 8
  /// Of the six directions in the surface plane, 60 degrees apart from tangent() on, those in which
  /// no other surfel follows: bit i set. The surface may go on there, unseen.
  std::vector<std::uint8_t> open_directions;
  std::vector<Eigen::Vector3f> first_tangents;  ///< of the six; unit

  std::size_t size() const { return positions.size(); }
  float covered_share(std::size_t i) const;
  /// Area that is expected to lack a measurement.
  float deficit(std::size_t i) const;
};

/// Direction `k` (0 to 5) in the plane of surfel `i`.
Eigen::Vector3f open_direction(const Surfels& surfels, std::size_t i, int k);

class DoseMap {
 public:
  /// Surfels lie about `spacing` (h) apart.
  explicit DoseMap(float spacing);

  /// Adds what the scan's blocks saw. Blocks outside `region`, if given, make no surfels. Neither
  /// the number of threads nor the order of equal inputs matters.
  void add(const BlockImage& image, const DoseModel& dose, float jump,
           const std::optional<Eigen::AlignedBox3f>& region);

  const Surfels& surfels() const { return surfels_; }
  float spacing() const { return spacing_; }

  /// Whether a surfel of index `first` or above lies within `radius`.
  bool has_surfel_near(const Eigen::Vector3f& point, float radius, std::size_t first) const;

  /// Lowers the trust in surfel `i` by `factor`.
  void lower_trust(std::size_t i, float factor) { surfels_.trusts[i] *= factor; }

  double area() const;
  double covered_area() const;

 private:
  void add_looks(const BlockImage& image, const DoseModel& dose, float jump);
  void add_surfels(const BlockImage& image, const DoseModel& dose,
                   const std::optional<Eigen::AlignedBox3f>& region);
  void close_directions(std::size_t added);

  float spacing_;
  CellGrid grid_;
  Surfels surfels_;
};

}  // namespace skycap::survey
