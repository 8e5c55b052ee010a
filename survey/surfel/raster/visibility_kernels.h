/// Inner loops over all surfels and targets of a candidate view. They use plain arrays and are
/// compiled for several vector instruction sets, of which the best available one is used. All give
/// bit-identical results.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::survey::surfel {

/// Maximum width of a square that is drawn by windows [px], and reach of the windows. Each row has
/// as many spare pixels at its right end.
constexpr int largest_window = 8, row_margin = largest_window / 2;

/// View and its raster for the visibility test, with a border of one pixel and the margin.
struct RasterView {
  float position[3];           ///< sensor position, world frame [m]
  float right[3];              ///< camera axis, world frame
  float down[3];               ///< camera axis, world frame
  float forward[3];            ///< camera axis, world frame
  float focal_length;          ///< [px]
  float width, height;         ///< without border [px]
  std::int32_t stride;         ///< width with border and margin [px]
  std::uint32_t outside;       ///< number of all pixels; index of points outside the image
  float half_slope[2];         ///< tangents of half the field of view, right and down
  float min_range, max_range;  ///< along the optical axis [m]
  float min_cosine;            ///< minimum cosine of the angle of incidence
};

/// Points as a structure of arrays.
struct PointArrays {
  const float *x, *y, *z;
};

/// Raster positions of points.
struct PointPixels {
  std::uint32_t* pixels;  ///< top-left of the four nearest pixels; `outside` if not in view
  float* depths;          ///< along the optical axis [m]
  std::int32_t* sizes;    ///< width of the occluding squares, at least 2 [px]
};

/// Projects points that represent squares with the edge length 2 * `spacing`. A square has a width
/// of two pixels at depths of at least focal length * spacing, and more pixels at smaller depths.
void project_points(const RasterView& view, std::size_t count, const PointArrays& points,
                    float spacing, const PointPixels& projected);

/// Returns the offset between the first pixel of a square of this size and the top-left of the four
/// pixels nearest to its point.
constexpr int pixels_before_square(int size) { return (size - 2) / 2; }

/// Draws squares of one width, at most `largest_window`, into the raster `depths`. `nearest`
/// contains the minimum depth of the squares per point pixel and is reset to infinity. The arrays
/// `nearest` and `row_wise` need `row_margin` rows of infinite depth before and after them. The
/// content of `row_wise` is ignored.
void draw_squares(const RasterView& view, int size, float* nearest, float* row_wise, float* depths);

/// Projected targets for the visibility test.
struct TargetArrays {
  std::uint32_t*
      in_view;  ///< 1 if the target faces the sensor and is inside the frustum, otherwise 0
  std::uint32_t* pixels;  ///< pixel of the target; `outside` if not in view
  float* depths;          ///< along the optical axis [m]
  float* cosines;         ///< cosine of the angle of incidence
  float* densities;       ///< rays per m^2 of the target
  float* slopes;          ///< depth increase per metre perpendicular to the ray, at most 4
};

/// Projects targets into a camera with `rays` rays per square of one radian.
void project_targets(const RasterView& view, float rays, std::size_t count,
                     const PointArrays& positions, const PointArrays& normals,
                     const TargetArrays& projected);

}  // namespace skycap::survey::surfel
