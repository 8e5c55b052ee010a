/// The measured surface as small patches ("surfels"), and how well each is covered so far.
///
/// A surfel is made from a block of measurements where there is none yet; later scans add the
/// hazard of their look to it (dose_model.h). Its covered share is 1 - exp(-hazard), so the
/// surface's predicted coverage is a sum over surfels.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/point_grid.h"
#include "survey/skycap/block_image.h"
#include "survey/skycap/dose_model.h"

namespace skycap::survey::skycap {

/// Structure of arrays; a surfel's index never changes.
struct Surfels {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< unit, towards the free side
  std::vector<float> areas;
  std::vector<float> hazards;          ///< sum of the hazards of all looks
  std::vector<float> blurred_hazards;  ///< the same, averaged as noise scatters the measurements
  std::vector<float> trusts;           ///< in (0, 1]: falls when a look gives far less than hoped
  std::vector<float> qualities;        ///< best Block::quality of a look
  std::vector<std::uint8_t> merges;    ///< looks averaged into position and normal, at most 8
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

/// Whether earlier scans have measured a place already.
using IsMeasured = std::function<bool(const Eigen::Vector3f&)>;

class DoseMap {
 public:
  /// Surfels lie about `spacing` (h) apart.
  explicit DoseMap(float spacing, unsigned threads = 1);

  /// Adds what the scan's blocks saw: looks at the surfels that are there, then surfels where there
  /// are none yet. `jump` is the J of BlockSettings. Blocks outside `region`, if given, make no
  /// surfels. New surfels where it `was_measured`, if that is given, only shape the surface: they
  /// stand for no area, since surface that was between surfels so far is no new surface.
  void add(const BlockImage& image, const DoseModel& dose, float jump,
           const std::optional<Eigen::AlignedBox3f>& region, const IsMeasured& was_measured = {});

  const Surfels& surfels() const { return surfels_; }
  float spacing() const { return spacing_; }

  bool has_surfel_near(const Eigen::Vector3f& point, float radius) const;

  /// Whether a surfel behind the edge that surfel `i` is at faces another way: as a rule, over a
  /// convex edge.
  bool has_other_face_near(std::size_t i) const;

  /// Area that the surfels from index `first` on within `radius` of a point stand for [m^2].
  double area_near(const Eigen::Vector3f& point, float radius, std::size_t first) const;

  /// Covered area of the surfels from index `first` on that have none of the earlier ones within
  /// two spacings: of new territory, and not of gaps in what was known [m^2].
  double new_territory(std::size_t first) const;

  /// Lowers the trust in surfel `i` by `factor`.
  void lower_trust(std::size_t i, float factor) { surfels_.trusts[i] *= factor; }

  double area() const;
  double covered_area() const;

 private:
  void add_looks(const BlockImage& image, const DoseModel& dose, float jump);
  void add_surfels(const BlockImage& image, const DoseModel& dose,
                   const std::optional<Eigen::AlignedBox3f>& region,
                   const IsMeasured& was_measured);
  void close_directions(std::size_t added);
  void blur_hazards(double sigma);
  bool is_taken(const Block& block);

  float spacing_;
  unsigned threads_;
  geometry::PointGrid grid_;  ///< of the surfels where they were made
  Surfels surfels_;
  /// Two surfels near enough to share measurements.
  struct Pair {
    std::uint32_t first, second;
    float squared_distance;
  };
  std::vector<Pair> pairs_;
  std::vector<geometry::Neighbour> found_;  // kept for its memory
};

}  // namespace skycap::survey::skycap
