#include "survey/surfel/raster/visibility_kernels.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "survey/vector_clones.h"

namespace skycap::survey::surfel {
namespace {

constexpr float largest_square = 1e4F;  // larger than any raster [px]

[[gnu::always_inline]] inline void project_points_body(const RasterView& given, std::size_t count,
                                                       const PointArrays& points, float spacing,
                                                       const PointPixels& projected) {
  const RasterView view = given;  // local copy, so that no output can alias it
  const PointPixels out = projected;
  const float *const x = points.x, *const y = points.y, *const z = points.z;
  const float centre_column = 0.5F * view.width, centre_row = 0.5F * view.height;
  const float one_pixel_at = 2.0F * (view.focal_length * spacing);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - view.position[0], dy = y[i] - view.position[1],
                dz = z[i] - view.position[2];
    const float right = view.right[0] * dx + view.right[1] * dy + view.right[2] * dz;
    const float down = view.down[0] * dx + view.down[1] * dy + view.down[2] * dz;
    const float forward = view.forward[0] * dx + view.forward[1] * dy + view.forward[2] * dz;
    const float scale = view.focal_length / forward;
    const float column = right * scale + centre_column, row = down * scale + centre_row;
    const bool is_inside = (forward > 0.0F) & (column >= 0.0F) & (row >= 0.0F) &
                           (column < view.width) & (row < view.height);
    const std::int32_t pixel =
        static_cast<std::int32_t>(is_inside ? row + 0.5F : 0.0F) * view.stride +
        static_cast<std::int32_t>(is_inside ? column + 0.5F : 0.0F);
    const float square = is_inside ? one_pixel_at / forward : 2.0F;
    const float at_most = square < largest_square ? square : largest_square;
    const float width = at_most > 2.0F ? at_most : 2.0F;
    const auto whole = static_cast<std::int32_t>(width);
    out.pixels[i] = is_inside ? static_cast<std::uint32_t>(pixel) : view.outside;
    out.depths[i] = forward;
    out.sizes[i] = whole + (static_cast<float>(whole) < width ? 1 : 0);
  }
}

[[gnu::always_inline]] inline void project_targets_body(const RasterView& given, float rays,
                                                        std::size_t count,
                                                        const PointArrays& positions,
                                                        const PointArrays& normals,
                                                        const TargetArrays& projected) {
  const RasterView view = given;
  const TargetArrays out = projected;
  const float *const x = positions.x, *const y = positions.y, *const z = positions.z;
  const float *const nx = normals.x, *const ny = normals.y, *const nz = normals.z;
  const float first_column = 0.5F * view.width + 1.0F, first_row = 0.5F * view.height + 1.0F;
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - view.position[0], dy = y[i] - view.position[1],
                dz = z[i] - view.position[2];
    const float facing = -(dx * nx[i] + (dy * ny[i] + dz * nz[i]));
    const float right = view.right[0] * dx + (view.right[1] * dy + view.right[2] * dz);
    const float down = view.down[0] * dx + (view.down[1] * dy + view.down[2] * dz);
    const float forward = view.forward[0] * dx + (view.forward[1] * dy + view.forward[2] * dz);
    const float distance = std::sqrt(dx * dx + (dy * dy + dz * dz));
    const float cosine = facing / distance;
    const bool is_inside =
        (facing > 0.0F) & (forward >= view.min_range) & (forward <= view.max_range) &
        (std::abs(right) <= view.half_slope[0] * forward) &
        (std::abs(down) <= view.half_slope[1] * forward) & (cosine >= view.min_cosine);
    const float scale = view.focal_length / forward;
    const float column = right * scale + first_column, row = down * scale + first_row;
    const std::int32_t pixel = static_cast<std::int32_t>(is_inside ? row : 0.0F) * view.stride +
                               static_cast<std::int32_t>(is_inside ? column : 0.0F);
    out.in_view[i] = is_inside ? 1 : 0;
    out.pixels[i] = is_inside ? static_cast<std::uint32_t>(pixel) : view.outside;
    out.depths[i] = forward;
    out.cosines[i] = cosine;
    out.densities[i] = rays * cosine * distance / (forward * forward * forward);
    const float squared_sine = 1.0F - cosine * cosine;
    const float slope = std::sqrt(squared_sine > 0.0F ? squared_sine : 0.0F) / cosine;
    out.slopes[i] = slope < 4.0F ? slope : 4.0F;
  }
}

/// Returns the minimum of `size` values with stride `step` around `at`.
template <int size>
[[gnu::always_inline]] inline float min_along(const float* at, std::ptrdiff_t step) {
  const float* value = at - (size - 1 - pixels_before_square(size)) * step;
  float min = *value;
#pragma GCC unroll 8
  for (int k = 1; k < size; ++k) {
    value += step;
    min = *value < min ? *value : min;
  }
  return min;
}

/// A pixel is covered by the squares whose points are in a window of the same size around it. The
/// minimum is computed along rows, then along columns.
template <int size>
[[gnu::always_inline]] inline void draw_squares_impl(const RasterView& view, float* nearest,
                                                     float* row_wise, float* depths) {
  const std::size_t count = view.outside;
  const std::ptrdiff_t stride = view.stride;
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) row_wise[i] = min_along<size>(nearest + i, 1);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const float min = min_along<size>(row_wise + i, stride);
    depths[i] = min < depths[i] ? min : depths[i];
    nearest[i] = std::numeric_limits<float>::infinity();
  }
}

[[gnu::always_inline]] inline void draw_squares_body(const RasterView& view, int size,
                                                     float* nearest, float* row_wise,
                                                     float* depths) {
  switch (size) {
    case 2:
      return draw_squares_impl<2>(view, nearest, row_wise, depths);
    case 3:
      return draw_squares_impl<3>(view, nearest, row_wise, depths);
    case 4:
      return draw_squares_impl<4>(view, nearest, row_wise, depths);
    case 5:
      return draw_squares_impl<5>(view, nearest, row_wise, depths);
    case 6:
      return draw_squares_impl<6>(view, nearest, row_wise, depths);
    case 7:
      return draw_squares_impl<7>(view, nearest, row_wise, depths);
    default:
      return draw_squares_impl<largest_window>(view, nearest, row_wise, depths);
  }
}

void project_points_anywhere(const RasterView& view, std::size_t count, const PointArrays& points,
                             float spacing, const PointPixels& projected) {
  project_points_body(view, count, points, spacing, projected);
}
SKYCAP_FOR_AVX2 void project_points_with_avx2(const RasterView& view, std::size_t count,
                                              const PointArrays& points, float spacing,
                                              const PointPixels& projected) {
  project_points_body(view, count, points, spacing, projected);
}

void draw_squares_anywhere(const RasterView& view, int size, float* nearest, float* row_wise,
                           float* depths) {
  draw_squares_body(view, size, nearest, row_wise, depths);
}
SKYCAP_FOR_AVX2 void draw_squares_with_avx2(const RasterView& view, int size, float* nearest,
                                            float* row_wise, float* depths) {
  draw_squares_body(view, size, nearest, row_wise, depths);
}

void project_targets_anywhere(const RasterView& view, float rays, std::size_t count,
                              const PointArrays& positions, const PointArrays& normals,
                              const TargetArrays& projected) {
  project_targets_body(view, rays, count, positions, normals, projected);
}
SKYCAP_FOR_AVX2 void project_targets_with_avx2(const RasterView& view, float rays,
                                               std::size_t count, const PointArrays& positions,
                                               const PointArrays& normals,
                                               const TargetArrays& projected) {
  project_targets_body(view, rays, count, positions, normals, projected);
}

}  // namespace

void project_points(const RasterView& view, std::size_t count, const PointArrays& points,
                    float spacing, const PointPixels& projected) {
  const auto project = has_avx2() ? project_points_with_avx2 : project_points_anywhere;
  project(view, count, points, spacing, projected);
}

void draw_squares(const RasterView& view, int size, float* nearest, float* row_wise,
                  float* depths) {
  const auto draw = has_avx2() ? draw_squares_with_avx2 : draw_squares_anywhere;
  draw(view, size, nearest, row_wise, depths);
}

void project_targets(const RasterView& view, float rays, std::size_t count,
                     const PointArrays& positions, const PointArrays& normals,
                     const TargetArrays& projected) {
  const auto project = has_avx2() ? project_targets_with_avx2 : project_targets_anywhere;
  project(view, rays, count, positions, normals, projected);
}

}  // namespace skycap::survey::surfel
