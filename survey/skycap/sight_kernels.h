/// The arithmetic that every surfel and every target goes through for each candidate view: plain
/// arrays, compiled for several vector instruction sets, of which the processor's best runs. All
/// give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::survey::skycap {

/// A view and the raster in which it decides visibility. The raster has a border of one pixel, and
/// behind its last row a spare pixel that takes what falls outside.
struct RasterView {
  float position[3];              ///< of the sensor, world frame
  float right[3];                 ///< the camera's axes, world frame
  float down[3];                  ///< of it
  float forward[3];               ///< of it
  float focal_length;             ///< [px]
  float width, height;            ///< without the border [px]
  std::int32_t stride;            ///< width with the border [px]
  std::uint32_t outside;          ///< number of the spare pixel
  float half_slope[2];            ///< tangents of half the angles of view, right and down
  float least_range, most_range;  ///< along the optical axis
  float least_cosine;             ///< of the angle of incidence
};

/// Points as a structure of arrays.
struct PointArrays {
  const float *x, *y, *z;
};

/// For each point the top left one of the four pixels nearest to it, and its depth.
void project_points(const RasterView& view, std::size_t count, const PointArrays& points,
                    std::uint32_t* pixels, float* depths);

/// What the visibility of a target is decided by.
struct TargetArrays {
  std::uint32_t* in_view;  ///< 1 if it faces the sensor inside the frustum, else 0
  std::uint32_t* pixels;   ///< that it falls into; the spare one if not in view
  float* depths;           ///< along the optical axis
  float* distances;        ///< from the sensor
  float* cosines;          ///< of the angle of incidence
};

void project_targets(const RasterView& view, std::size_t count, const PointArrays& positions,
                     const PointArrays& normals, const TargetArrays& projected);

}  // namespace skycap::survey::skycap
