/// How much of the scene's surface a cloud covers. The evaluation alone knows the truth; planners
/// never see any of this. Definitions: docs/explanation/coverage.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/hash_grid.h"

namespace skycap::missions::evaluation {

/// Keeps count of the surface samples that have a measurement within the registration distance
/// r_d, while measurements come in. A measurement costs constant time: covered samples are taken
/// out of the search.
class CoverageMeter {
 public:
  CoverageMeter(std::span<const Eigen::Vector3f> samples, double registration_distance);

  /// Takes in further measurements.
  void add(std::span<const Eigen::Vector3f> points);

  /// For each sample, 1 if it is covered, else 0.
  const std::vector<std::uint8_t>& is_covered() const { return is_covered_; }
  /// The covered share of all samples.
  double share() const;

 private:
  using Cell = std::uint64_t;
  /// What is left of a cell's samples.
  struct Range {
    std::uint32_t begin = 0, end = 0;  ///< of samples_
  };
  struct Sample {
    Eigen::Vector3f position;
    std::uint32_t index;
  };

  static Cell cell_at(std::int64_t x, std::int64_t y, std::int64_t z);
  Cell cell_of(const Eigen::Vector3f& sample) const;
  void cover_cell(Cell cell, const Eigen::Vector3f& point);

  double cell_size_;
  float squared_distance_;
  std::size_t covered_ = 0;
  std::vector<std::uint8_t> is_covered_;
  geometry::HashGrid<Range> ranges_;
  std::vector<Sample> samples_;  ///< cell by cell
};

/// The covered share of those samples that `counts` marks; nothing if it marks none.
std::optional<double> covered_share(std::span<const std::uint8_t> is_covered,
                                    std::span<const std::uint8_t> counts);

/// The share of samples that are marked; zero of none.
double marked_share(std::span<const std::uint8_t> marks);

/// `count` unit vectors, spread evenly over the sphere: the points of a Fibonacci lattice.
std::vector<Eigen::Vector3d> fibonacci_directions(std::size_t count);

}  // namespace skycap::missions::evaluation
