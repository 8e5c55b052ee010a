/// The arithmetic that every surfel and every target goes through for each candidate view: plain
/// arrays, compiled for several vector instruction sets, of which the processor's best runs. All
/// give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::survey::skycap {

/// The widest square that is drawn by windows [px], and how far they reach: so many pixels to the
/// right of each row are spare.
constexpr int largest_window = 8, row_margin = largest_window / 2;

/// A view and the raster in which it decides visibility, with a border of one pixel and the margin.
struct RasterView {
  float position[3];              ///< of the sensor, world frame
  float right[3];                 ///< the camera's axes, world frame
  float down[3];                  ///< of it
  float forward[3];               ///< of it
  float focal_length;             ///< [px]
  float width, height;            ///< without the border [px]
  std::int32_t stride;            ///< width with border and margin [px]
  std::uint32_t outside;          ///< of all pixels; the number of what falls outside
  float half_slope[2];            ///< tangents of half the angles of view, right and down
  float least_range, most_range;  ///< along the optical axis
  float least_cosine;             ///< of the angle of incidence
};

/// Points as a structure of arrays.
struct PointArrays {
  const float *x, *y, *z;
};

/// Where points are in the raster.
struct PointPixels {
  std::uint32_t* pixels;  ///< the top left one of the four nearest; `outside` if not in view
  float* depths;          ///< along the optical axis
  std::int32_t* sizes;    ///< of the squares that they hide, 2 and more [px]
};

/// Points that stand for squares of twice `spacing`: of two pixels where it is at least as deep as
/// the focal length times the spacing, of more where it is nearer.
void project_points(const RasterView& view, std::size_t count, const PointArrays& points,
                    float spacing, const PointPixels& projected);

/// A square that wide about the four pixels nearest to its point begins so far before the first
/// one.
constexpr int pixels_before_square(int size) { return (size - 2) / 2; }

/// Draws squares of one width, at most `largest_window`, into the raster's `depths`, given the
/// depth of the nearest in each of their points' pixels, which is infinite afterwards. Before and
/// behind `nearest` and `row_wise`, whose content does not matter, are `row_margin` rows of
/// infinite depth.
void draw_squares(const RasterView& view, int size, float* nearest, float* row_wise, float* depths);

/// What the visibility of a target is decided by.
struct TargetArrays {
  std::uint32_t* in_view;  ///< 1 if it faces the sensor inside the frustum, else 0
  std::uint32_t* pixels;   ///< that it falls into; `outside` if not in view
  float* depths;           ///< along the optical axis
  float* cosines;          ///< of the angle of incidence
  float* densities;        ///< rays a square metre of it
  float* slopes;           ///< how much deeper it gets per metre across the look, at most 4
};

/// Seen by a camera with `rays` a square of one radian.
void project_targets(const RasterView& view, float rays, std::size_t count,
                     const PointArrays& positions, const PointArrays& normals,
                     const TargetArrays& projected);

}  // namespace skycap::survey::skycap
