/// Compact encoding of clouds as integers that compress to two or three bytes per point.
///
/// Positions are quantised to a cubic grid. The interleaved bits of a cell's three indices form its
/// Morton key (Morton, "A computer oriented geodetic data base", 1966). Points are sorted by key,
/// so that spatial neighbours are adjacent and key differences are small. The key differences,
/// followed by the values of each attribute, are written as byte planes, lowest byte first. The
/// result is compressed with zlib, with runs and frequencies only. missions/report/page/cloud.js
/// decodes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::missions::report {

/// Point attribute, written in one byte plane, or two if a value exceeds 255.
struct CloudAttribute {
  std::string name;
  std::span<const std::uint16_t> values;
};

/// Encoded cloud with the parameters for decoding.
struct CloudCode {
  std::size_t points = 0;                            ///< encoded points
  std::size_t of = 0;                                ///< points before downsampling
  int bits = 1;                                      ///< bits per index of a cell
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< minimum corner of the grid [m]
  double step = 1.0;     ///< cell size; a decoded point is the centre of its cell [m]
  double spacing = 0.0;  ///< distance between points, see compute_spacing() [m]
  struct Attribute {
    std::string name;
    /// Number of distinct values 0, 1, ...; more than 256 require two byte planes.
    std::size_t values = 1;
  };
  std::vector<Attribute> attributes;
  std::string bytes;  ///< compressed data
};

/// Encodes a cloud. If it exceeds `max_points`, every n-th point in key order is encoded, which is
/// evenly distributed in space. The step is an eighth of the spacing, but at least 2^-16 of the
/// cloud's longest side. Positions must be finite.
CloudCode encode_cloud(std::span<const Eigen::Vector3f> positions,
                       std::span<const CloudAttribute> attributes, std::size_t max_points);

/// Estimates the distance between neighbouring points on a surface [m]. Returns 0 for fewer than
/// two points.
double compute_spacing(std::span<const Eigen::Vector3f> positions);

/// Estimates the distance between neighbouring points on a surface, in cells. It is the side of
/// cubes that contain two points on average, divided by the square root of two. `keys` are
/// ascending, with `bits` bits per coordinate.
double compute_key_spacing(std::span<const std::uint64_t> keys, int bits);

}  // namespace skycap::missions::report
