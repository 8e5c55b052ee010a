/// Surface coverage of a point cloud with respect to the ground truth. Only the evaluation uses the
/// ground truth; planners have no access to it. Definitions: docs/explanation/coverage.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/hash_grid.h"

namespace skycap::missions::evaluation {

/// Counts surface samples that have a measurement within the coverage distance r_d. Each
/// measurement takes constant time, because covered samples are removed from the search structure.
class CoverageMeter {
 public:
  CoverageMeter(std::span<const Eigen::Vector3f> samples, double registration_distance);

  /// Adds measurements.
  void add(std::span<const Eigen::Vector3f> points);

  /// Returns 1 for each covered sample and 0 for the others.
  const std::vector<std::uint8_t>& is_covered() const { return is_covered_; }
  /// Returns the covered fraction of all samples.
  double share() const;

 private:
  using Cell = std::uint64_t;
  /// Uncovered samples of a grid cell.
  struct Range {
    std::uint32_t begin = 0, end = 0;  ///< range in samples_
  };
  struct Sample {
    Eigen::Vector3f position;
    std::uint32_t index;
  };

  static Cell cell_at(std::int64_t x, std::int64_t y, std::int64_t z);
  Cell sample_cell(const Eigen::Vector3f& sample) const;
  void cover_cell(Cell cell, const Eigen::Vector3f& point);

  double cell_size_;
  float squared_distance_;
  std::size_t covered_ = 0;
  std::vector<std::uint8_t> is_covered_;
  geometry::HashGrid<Range> ranges_;
  std::vector<Sample> samples_;  ///< grouped by cell
};

/// Returns the covered fraction of the samples marked in `counts`, or nullopt if no sample is
/// marked.
std::optional<double> covered_share(std::span<const std::uint8_t> is_covered,
                                    std::span<const std::uint8_t> counts);

/// Returns the fraction of marked samples, or zero for an empty list.
double marked_share(std::span<const std::uint8_t> marks);

/// Returns `count` unit vectors evenly distributed on the sphere (Fibonacci lattice).
std::vector<Eigen::Vector3d> fibonacci_directions(std::size_t count);

}  // namespace skycap::missions::evaluation
