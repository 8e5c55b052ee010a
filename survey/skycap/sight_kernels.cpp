#include "survey/skycap/sight_kernels.h"

#include <cmath>

#include "survey/vector_clones.h"

namespace skycap::survey::skycap {
namespace {

constexpr float largest_square = 1e4F;  // wider than any raster [px]

[[gnu::always_inline]] inline void project_points_body(const RasterView& given, std::size_t count,
                                                       const PointArrays& points, float spacing,
                                                       const PointPixels& projected) {
  const RasterView view = given;  // copies of our own: nothing that is written can alias them
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
    const float wanted = is_inside ? one_pixel_at / forward : 2.0F;
    const float at_most = wanted < largest_square ? wanted : largest_square;
    const float width = at_most > 2.0F ? at_most : 2.0F;
    const auto whole = static_cast<std::int32_t>(width);
    out.pixels[i] = is_inside ? static_cast<std::uint32_t>(pixel) : view.outside;
    out.depths[i] = forward;
    out.sizes[i] = whole + (static_cast<float>(whole) < width ? 1 : 0);
  }
}

[[gnu::always_inline]] inline void project_targets_body(const RasterView& given, std::size_t count,
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
        (facing > 0.0F) & (forward >= view.least_range) & (forward <= view.most_range) &
        (std::abs(right) <= view.half_slope[0] * forward) &
        (std::abs(down) <= view.half_slope[1] * forward) & (cosine >= view.least_cosine);
    const float scale = view.focal_length / forward;
    const float column = right * scale + first_column, row = down * scale + first_row;
    const std::int32_t pixel = static_cast<std::int32_t>(is_inside ? row : 0.0F) * view.stride +
                               static_cast<std::int32_t>(is_inside ? column : 0.0F);
    out.in_view[i] = is_inside ? 1 : 0;
    out.pixels[i] = is_inside ? static_cast<std::uint32_t>(pixel) : view.outside;
    out.depths[i] = forward;
    out.distances[i] = distance;
    out.cosines[i] = cosine;
  }
}

[[gnu::always_inline]] inline void least_in_windows_body(int first, int last, int step,
                                                         std::size_t count, const float* values,
                                                         float* least) {
  for (int k = first; k <= last; ++k) {
    const float* const shifted = values + static_cast<std::ptrdiff_t>(k) * step;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
      least[i] = shifted[i] < least[i] ? shifted[i] : least[i];
    }
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

void least_in_windows_anywhere(int first, int last, int step, std::size_t count,
                               const float* values, float* least) {
  least_in_windows_body(first, last, step, count, values, least);
}
SKYCAP_FOR_AVX2 void least_in_windows_with_avx2(int first, int last, int step, std::size_t count,
                                                const float* values, float* least) {
  least_in_windows_body(first, last, step, count, values, least);
}

void project_targets_anywhere(const RasterView& view, std::size_t count,
                              const PointArrays& positions, const PointArrays& normals,
                              const TargetArrays& projected) {
  project_targets_body(view, count, positions, normals, projected);
}
SKYCAP_FOR_AVX2 void project_targets_with_avx2(const RasterView& view, std::size_t count,
                                               const PointArrays& positions,
                                               const PointArrays& normals,
                                               const TargetArrays& projected) {
  project_targets_body(view, count, positions, normals, projected);
}

}  // namespace

void project_points(const RasterView& view, std::size_t count, const PointArrays& points,
                    float spacing, const PointPixels& projected) {
  const auto project = has_avx2() ? project_points_with_avx2 : project_points_anywhere;
  project(view, count, points, spacing, projected);
}

void least_in_windows(int first, int last, int step, std::size_t count, const float* values,
                      float* least) {
  const auto take_least = has_avx2() ? least_in_windows_with_avx2 : least_in_windows_anywhere;
  take_least(first, last, step, count, values, least);
}

void project_targets(const RasterView& view, std::size_t count, const PointArrays& positions,
                     const PointArrays& normals, const TargetArrays& projected) {
  const auto project = has_avx2() ? project_targets_with_avx2 : project_targets_anywhere;
  project(view, count, positions, normals, projected);
}

}  // namespace skycap::survey::skycap
