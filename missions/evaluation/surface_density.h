/// How densely a cloud covers a surface, from all of its points: points for each square metre of
/// surface around places of it, and of the plan in a raster.
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

/// Kinds of surface, by their normals and by what they belong to.
enum class SurfaceClass { roof, wall, underside, ground };
inline constexpr std::array surface_classes{SurfaceClass::roof, SurfaceClass::wall,
                                            SurfaceClass::underside, SurfaceClass::ground};
const char* to_string(SurfaceClass of);

/// Places that stand for equal or unequal parts of a surface.
struct DensityPlaces {
  std::vector<Eigen::Vector3f> positions;
  std::vector<double> areas;  ///< that each stands for [m^2]
  std::vector<SurfaceClass> classes;
};

/// Of a model, about one in a square of `spacing`, and of what stands `surroundings` it within
/// `margin` of its bounding box, level parts of which are ground and others are left out. At most a
/// million of each.
DensityPlaces density_places(const geometry::Mesh& model, const geometry::Mesh& surroundings,
                             double spacing, double margin);

/// Lower bounds of the histogram's bins [points per m^2]; the first is zero, the last has no upper
/// bound.
inline constexpr std::array density_bins{0.0,   1.0,   2.0,   5.0,    10.0,   20.0,   50.0,
                                         100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0};

/// Of all surface, or of one class.
struct DensityFigures {
  double area = 0.0;          ///< [m^2]
  double mean = 0.0;          ///< [points per m^2], as all below
  double percentile_5 = 0.0;  ///< a twentieth of the area has less
  double median = 0.0;
  double share = 0.0;  ///< of the area that has at least the density asked for
  std::array<double, density_bins.size()> histogram{};  ///< shares of the area
};

/// Counts points around places.
class DensityMeter {
 public:
  /// `radius` is how far around a place points and surface are counted [m].
  DensityMeter(DensityPlaces positions, double radius, unsigned threads = 0);

  void add(std::span<const Eigen::Vector3f> points);

  /// For each place, points within the radius of it over the area of surface within it [1/m^2].
  std::vector<double> densities() const;
  /// For each place, points within the radius of it.
  std::vector<std::uint64_t> counts() const { return counts_; }
  const DensityPlaces& positions() const { return positions_; }

  /// Of all surface but the ground; nothing if there is none.
  std::optional<DensityFigures> figures(double asked) const;
  /// Of one class; nothing if there is none.
  std::optional<DensityFigures> figures(double asked, SurfaceClass of) const;

 private:
  DensityPlaces positions_;
  double radius_;
  unsigned threads_;
  geometry::PointGrid grid_;
  std::vector<double> areas_;  ///< of surface within the radius
  std::vector<std::uint64_t> counts_;
};

/// Points by cells of the plan.
class DensityRaster {
 public:
  /// Square cells of `cell` metres that cover the box of the mission's frame; the last ones may
  /// reach beyond it. Throws Error{bad_config} if they are none, or more than 100 million.
  DensityRaster(const Eigen::AlignedBox2d& box, double cell);

  void add(std::span<const Eigen::Vector3f> points);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  /// Row by row from the north, and in each from the west.
  const std::vector<std::uint32_t>& counts() const { return counts_; }

  /// A GeoTIFF of one band of 32-bit floats, points per square metre of the plan. With a site its
  /// cells are placed in UTM by a ModelTransformation, which turns them by the convergence of the
  /// meridians; else they have coordinates of the mission's frame and no reference system.
  std::string geotiff(const std::optional<flight::Site>& site) const;

 private:
  Eigen::Vector2d north_west_;
  double cell_;
  std::size_t columns_, rows_;
  std::vector<std::uint32_t> counts_;
};

}  // namespace skycap::missions::evaluation
