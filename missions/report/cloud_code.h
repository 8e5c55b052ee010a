/// Clouds as whole numbers that deflate to two or three bytes per point.
///
/// Positions fall into the cells of a cubic grid; a cell's three indices, bit by bit in turn, are
/// its key (Morton, "A computer oriented geodetic data base", 1966). Points are sorted by key, so
/// that neighbours in space follow each other and keys grow by little. Written are the differences
/// of the keys, then the values of each attribute, as byte planes, lowest byte first; the whole is
/// deflated (zlib) by runs and frequencies. missions/report/page/cloud.js reads it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::missions::report {

/// An attribute of each point; written in one byte plane, or in two if a value needs them.
struct CloudAttribute {
  std::string name;
  std::span<const std::uint16_t> values;
};

/// A coded cloud and what it takes to read it.
struct CloudCode {
  std::size_t points = 0;                            ///< in the code
  std::size_t of = 0;                                ///< that there were
  int bits = 1;                                      ///< of each of a cell's three indices
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< the grid's lowest corner [m]
  double step = 1.0;     ///< a cell's side: a point reads back as its cell's middle [m]
  double spacing = 0.0;  ///< how far apart the points are, see spacing_of() [m]
  struct Attribute {
    std::string name;
    std::size_t values = 1;  ///< they are 0, 1, ...; more than 256 take two byte planes
  };
  std::vector<Attribute> attributes;
  std::string bytes;  ///< deflated
};

/// Of more than `most_points` an evenly spread choice: along the curve of the keys, each n-th. The
/// step is an eighth of the spacing, but at least 2^-16 of the cloud's longest side. Positions must
/// be finite.
CloudCode encode_cloud(std::span<const Eigen::Vector3f> positions,
                       std::span<const CloudAttribute> attributes, std::size_t most_points);

/// About how far apart the points of a surface are [m]; 0 of fewer than two.
double spacing_of(std::span<const Eigen::Vector3f> positions);

/// The side of the cubes that hold two points each on average, over the square root of two: about
/// the distance of neighbours on a surface. `keys` ascending, of `bits` bits a coordinate; in
/// cells.
double spacing_of_keys(std::span<const std::uint64_t> keys, int bits);

}  // namespace skycap::missions::report
