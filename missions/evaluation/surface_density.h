/// Point density of a cloud: points per square metre of surface around sample positions, and per
/// square metre of the map in a raster. All points of the cloud are counted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "geometry/points/point_grid.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::missions::evaluation {

/// Surface classes, by normal and by the object that the surface belongs to.
enum class SurfaceClass { roof, wall, underside, ground };
inline constexpr std::array surface_classes{SurfaceClass::roof, SurfaceClass::wall,
                                            SurfaceClass::underside, SurfaceClass::ground};
const char* to_string(SurfaceClass of);

/// Sample positions on a surface. Each represents a part of its area.
struct DensitySamples {
  std::vector<Eigen::Vector3f> positions;
  std::vector<double> areas;  ///< Area that each position represents [m^2].
  std::vector<SurfaceClass> classes;
  geometry::Mesh surface;  ///< All sampled surface, with ground.
};

/// Samples a model and its surroundings with about one position per square of side `spacing` [m],
/// at most one million each. Surroundings are sampled only within `margin` [m] of the model's
/// bounding box, and only surface that faces up with a slope below 45 degrees. These samples have
/// the class ground.
DensitySamples density_samples(const geometry::Mesh& model, const geometry::Mesh& surroundings,
                               double spacing, double margin);

/// Lower bounds of the histogram's bins [points per m^2]. The last bin has no upper bound.
inline constexpr std::array density_bins{0.0,   1.0,   2.0,   5.0,    10.0,   20.0,   50.0,
                                         100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0};

/// Density figures of the whole surface or of one class.
struct DensityFigures {
  double area = 0.0;          ///< Area of the surface [m^2].
  double mean = 0.0;          ///< Mean density [points per m^2].
  double percentile_5 = 0.0;  ///< Density that 95% of the area reaches [points per m^2].
  double median = 0.0;
  double share = 0.0;  ///< Fraction of the area with at least the required density.
  std::array<double, density_bins.size()> histogram{};  ///< Fractions of the area by bin.
};

/// Counts points in the neighbourhood of sample positions.
class DensityMeter {
 public:
  /// `radius` is the distance from a position within which points and surface are counted [m].
  /// `threads` 0: all processors.
  DensityMeter(DensitySamples samples, double radius, unsigned threads = 0);

  void add(std::span<const Eigen::Vector3f> points);

  /// Returns the density at each position: number of points within the radius divided by the area
  /// of surface within it [1/m^2]. The area is exact for the mesh.
  std::vector<double> densities() const;
  /// Returns the number of points within the radius of each position.
  std::vector<std::uint64_t> counts() const { return counts_; }
  const DensitySamples& samples() const { return samples_; }

  /// Returns the figures of all surface except ground, or nullopt if all surface is ground. `asked`
  /// is the required density [points per m^2].
  std::optional<DensityFigures> figures(double asked) const;
  /// Returns the figures of one class, or nullopt if the class has no surface.
  std::optional<DensityFigures> figures(double asked, SurfaceClass of) const;

 private:
  DensitySamples samples_;
  double radius_;
  unsigned threads_;
  geometry::PointGrid grid_;
  std::vector<double> areas_;  ///< Area of surface within the radius of each position [m^2].
  std::vector<std::uint64_t> counts_;
};

/// Number of points in each cell of a horizontal grid.
class DensityRaster {
 public:
  /// Creates square cells with side `cell` [m] that cover the box in the mission frame. The last
  /// row and column may extend beyond the box. Throws Error{bad_config} if the grid has no cells or
  /// more than 100 million.
  DensityRaster(const Eigen::AlignedBox2d& box, double cell);

  void add(std::span<const Eigen::Vector3f> points);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  /// Returns the counts row by row from north to south, each row from west to east.
  const std::vector<std::uint32_t>& counts() const { return counts_; }

  /// Returns a GeoTIFF with one band of 32-bit floats: points per square metre of horizontal area.
  /// With a site, a ModelTransformation maps the cells to UTM, rotated by the convergence of the
  /// meridians. Without a site, coordinates are in the mission frame, without a coordinate
  /// reference system.
  std::string geotiff(const std::optional<flight::Site>& site) const;

 private:
  Eigen::Vector2d north_west_;
  double cell_;
  std::size_t columns_, rows_;
  std::vector<std::uint32_t> counts_;
};

}  // namespace skycap::missions::evaluation
