#include "survey/surfel/block_image.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <Eigen/Eigenvalues>

#include "geometry/parallel.h"

namespace skycap::survey::surfel {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// Sums over the returns of a block in the sensor frame. Raw moments allow pooling with
/// neighbouring blocks. They need double precision, because they are subtracted from each other.
struct Moments {
  double count = 0.0;
  Vector3d sum = Vector3d::Zero();
  std::array<double, 6> squares = {};  // xx xy xz yy yz zz

  void add(const Vector3f& point) {
    const double x = point.x(), y = point.y(), z = point.z();
    count += 1.0;
    sum += Vector3d(x, y, z);
    squares[0] += x * x;
    squares[1] += x * y;
    squares[2] += x * z;
    squares[3] += y * y;
    squares[4] += y * z;
    squares[5] += z * z;
  }
  void add(const Moments& other) {
    count += other.count;
    sum += other.sum;
    for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += other.squares[i];
  }
  Matrix3d covariance() const {
    const Vector3d mean = sum / count;
    Matrix3d second;
    second << squares[0], squares[1], squares[2],  //
        squares[1], squares[3], squares[4],        //
        squares[2], squares[4], squares[5];
    return second / count - mean * mean.transpose();
  }
};

/// Return in the sensor frame and the number of its block.
struct Return {
  std::uint32_t block;
  Vector3f point;
};

class Reducer {
 public:
  Reducer(BlockImage& image, const BlockSettings& settings)
      : image_(image), settings_(settings), moments_(image.blocks.size()) {}

  /// `row_returns(row)` provides the returns of a row of blocks. It is called from several threads;
  /// each thread finishes a row before it requests the next one.
  template <typename RowReturns>
  void reduce(RowReturns row_returns) {
    const std::size_t rows = static_cast<std::size_t>(image_.projection.rows);
    geometry::parallel_for(rows, settings_.threads,
                           [&](std::size_t row) { gather_row(row_returns(row), row); });
    geometry::parallel_for(rows, settings_.threads, [&](std::size_t row) { fit_row(row); });
  }

 private:
  void gather_row(std::span<const Return> returns, std::size_t row) {
    const auto columns = static_cast<std::size_t>(image_.projection.columns);
    const std::size_t first = row * columns;
    std::vector<float> farthest(columns, 0.0F);
    for (std::size_t i = 0; i < returns.size();) {
      const std::uint32_t number = returns[i].block;
      float nearest = image_.blocks[number].min_depth, deepest = farthest[number - first];
      for (; i < returns.size() && returns[i].block == number; ++i) {
        nearest = std::min(nearest, returns[i].point.z());
        deepest = std::max(deepest, returns[i].point.z());
      }
      image_.blocks[number].min_depth = nearest;
      farthest[number - first] = deepest;
    }
    for (std::size_t i = 0; i < returns.size();) {
      const std::uint32_t number = returns[i].block;
      Block& block = image_.blocks[number];
      const float farthest_depth = farthest[number - first];
      block.is_edge = farthest_depth - block.min_depth > settings_.jump;
      const float behind = block.is_edge ? 0.5F * (block.min_depth + farthest_depth)
                                         : std::numeric_limits<float>::infinity();
      // Consecutive returns of a block are summed in registers.
      Moments moments = moments_[number];
      for (; i < returns.size() && returns[i].block == number; ++i) {
        if (returns[i].point.z() <= behind) moments.add(returns[i].point);
      }
      moments_[number] = moments;
    }
    for (std::size_t i = first; i < first + columns; ++i) {
      const Moments& m = moments_[i];
      if (m.count == 0.0) continue;
      Block& block = image_.blocks[i];
      const Vector3d mean = m.sum / m.count;
      block.returns = static_cast<std::uint32_t>(m.count);
      block.depth = static_cast<float>(mean.z());
      block.depth_deviation = static_cast<float>(
          std::sqrt(std::max(0.0, m.squares[5] / m.count - mean.z() * mean.z())));
      block.mean = image_.projection.sensor_from_world.transpose() * mean.cast<float>() +
                   image_.projection.sensor_position;
    }
  }

  void fit_row(std::size_t row) {
    const int columns = image_.projection.columns;
    for (int column = 0; column < columns; ++column) {
      const std::size_t i =
          row * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
      if (image_.blocks[i].returns > 0) fit_normal(static_cast<int>(row), column, i);
    }
  }

  /// Fits the normal of a block: the smallest principal axis of the returns in a window of 5 x 5
  /// blocks with a similar depth.
  void fit_normal(int row, int column, std::size_t i) {
    const BlockProjection& projection = image_.projection;
    Block& block = image_.blocks[i];
    constexpr int reach = 2;
    constexpr int window = (2 * reach + 1) * (2 * reach + 1);
    Moments pooled;
    int pooled_blocks = 0;
    for (int r = std::max(0, row - reach); r <= std::min(projection.rows - 1, row + reach); ++r) {
      for (int c = std::max(0, column - reach);
           c <= std::min(projection.columns - 1, column + reach); ++c) {
        const std::size_t j =
            static_cast<std::size_t>(r) * static_cast<std::size_t>(projection.columns) +
            static_cast<std::size_t>(c);
        const Block& other = image_.blocks[j];
        if (other.returns == 0 || std::abs(other.depth - block.depth) > settings_.jump) continue;
        pooled.add(moments_[j]);
        ++pooled_blocks;
      }
    }
    const Vector3f towards_sensor = (projection.sensor_position - block.mean).normalized();
    block.normal = towards_sensor;
    if (pooled_blocks < 4 || pooled.count < 10.0) return;

    Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
    solver.computeDirect(pooled.covariance());
    const Vector3f axis = projection.sensor_from_world.transpose() *
                          solver.eigenvectors().col(0).cast<float>().normalized();
    block.normal = axis.dot(towards_sensor) < 0.0F ? Vector3f(-axis) : axis;
    block.quality = block.normal.dot(towards_sensor) * static_cast<float>(pooled_blocks) /
                    static_cast<float>(window) * (block.is_edge ? 0.3F : 1.0F);
    if (pooled_blocks == window && !block.is_edge) {
      block.residual = static_cast<float>(std::sqrt(std::max(0.0, solver.eigenvalues()[0])));
    }
  }

  BlockImage& image_;
  const BlockSettings& settings_;
  std::vector<Moments> moments_;
};

/// Returns the tangents of half the field of view.
Eigen::Vector2f half_slopes(const geometry::Camera& camera) {
  return (0.5 * Eigen::Vector2d(camera.width(), camera.height()))
      .cwiseQuotient(camera.focal_length_px())
      .cast<float>();
}

/// Marks the blocks completely within these slopes around the optical axis.
void mark_scanned(BlockImage& image, const Eigen::Vector2f& half_slopes) {
  const BlockProjection& p = image.projection;
  const auto is_within = [&](int number, int axis) {
    const float first =
        (static_cast<float>(number) - p.principal_point[axis]) / p.focal_length[axis];
    const float last = first + 1.0F / p.focal_length[axis];
    return std::max(std::abs(first), std::abs(last)) <= half_slopes[axis] * (1.0F + 1e-5F);
  };
  for (std::size_t i = 0; i < image.blocks.size(); ++i) {
    image.blocks[i].is_scanned = is_within(static_cast<int>(i) % p.columns, 0) &&
                                 is_within(static_cast<int>(i) / p.columns, 1);
  }
}

}  // namespace

float BlockImage::ray_density(const Block& block, const Eigen::Vector3f& point,
                              float cos_incidence) const {
  // Rays per unit area of the image plane at unit depth, divided by the surface area that is
  // projected to it: lambda = f_x f_y n cos(theta) / (z^2 cos(alpha)).
  const Vector3f in_sensor = projection.sensor_from_world * (point - projection.sensor_position);
  const float depth = in_sensor.z();
  const float cos_off_axis = depth / in_sensor.norm();
  return projection.focal_length.prod() * static_cast<float>(block.returns) * cos_incidence /
         (depth * depth * cos_off_axis);
}

Scale make_scale(double extent, double pixel, std::optional<double> surfel) {
  // Target number of surfels across the scene, and limits of the surfel size in pixels. The lower
  // limit is the size of a block; up to the upper limit, the relief that matters for a view is
  // resolved.
  constexpr double surfels_across = 150.0, min_pixels = 4.0, max_pixels = 25.0;
  // A block is slightly smaller than a surfel, so that no surfel falls between blocks. It has a
  // minimum width in pixels, below which the noise cannot be estimated.
  constexpr double blocks_to_surfel = 0.8;
  constexpr int min_block_px = 4;
  constexpr double jump_slope = 4.0;  // depth difference of a slope of 76 degrees over a block
  const double h =
      surfel.value_or(std::clamp(extent / surfels_across, min_pixels * pixel, max_pixels * pixel));
  const int block_px = std::max(min_block_px, static_cast<int>(blocks_to_surfel * h / pixel));
  return {h, block_px, jump_slope * block_px * pixel};
}

BlockImage make_block_image(const geometry::ScanSpan& scan, const geometry::Camera& camera,
                            const BlockSettings& settings) {
  assert(scan.pixels.size() == scan.points.size());
  const int block_px = settings.block_px;
  BlockImage image;
  BlockProjection& projection = image.projection;
  projection.columns = (camera.width() + block_px - 1) / block_px;
  projection.rows = (camera.height() + block_px - 1) / block_px;
  projection.sensor_from_world = scan.world_from_sensor.linear().transpose().cast<float>();
  projection.sensor_position = scan.sensor_position().cast<float>();
  projection.focal_length = (camera.focal_length_px() / block_px).cast<float>();
  // Pixel (0, 0) is the centre of a pixel, but block coordinates start at the outer corner of the
  // pixel.
  projection.principal_point =
      ((camera.principal_point_px().array() + 0.5) / block_px).matrix().cast<float>();
  image.blocks.resize(static_cast<std::size_t>(projection.columns) *
                      static_cast<std::size_t>(projection.rows));

  const auto width = static_cast<std::uint32_t>(camera.width());
  const auto b = static_cast<std::uint32_t>(block_px);
  const Matrix3f sensor_from_world = projection.sensor_from_world;
  const Vector3f sensor_position = projection.sensor_position;
  Reducer(image, settings).reduce([&](std::size_t row) {
    static thread_local std::vector<Return> returns;
    returns.clear();
    const auto first_block =
        static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(projection.columns);
    // Pixels are ascending, so the returns of a row of blocks are consecutive.
    auto first_pixel = static_cast<std::uint32_t>(row) * b * width;
    auto i = static_cast<std::size_t>(std::ranges::lower_bound(scan.pixels, first_pixel) -
                                      scan.pixels.begin());
    for (std::uint32_t r = 0; r < b; ++r, first_pixel += width) {
      std::uint32_t block = first_block, end_of_block = first_pixel + b;
      for (; i < scan.pixels.size() && scan.pixels[i] < first_pixel + width; ++i) {
        for (; scan.pixels[i] >= end_of_block; end_of_block += b) ++block;
        const Vector3f offset = scan.points[i] - sensor_position;
        returns.push_back({block, sensor_from_world * offset});
      }
    }
    return std::span<const Return>(returns);
  });
  return image;
}

std::vector<BlockImage> make_cube_images(const geometry::ScanSpan& scan,
                                         const geometry::Camera& camera, int face_blocks,
                                         const BlockSettings& settings) {
  const Matrix3f sensor_from_world = scan.world_from_sensor.linear().transpose().cast<float>();
  const Vector3f sensor_position = scan.sensor_position().cast<float>();
  const std::size_t face_size = static_cast<std::size_t>(face_blocks) * face_blocks;

  std::vector<BlockImage> faces;
  constexpr int front_face = 4;  // along z
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const float sign = face % 2 == 0 ? 1.0F : -1.0F;
    Matrix3f face_from_sensor =
        Matrix3f::Zero();  // right-handed, with z along the axis of the face
    face_from_sensor(2, axis) = sign;
    face_from_sensor(0, (axis + 1) % 3) = sign;
    face_from_sensor(1, (axis + 2) % 3) = 1.0F;

    BlockImage image;
    image.projection = {
        .columns = face_blocks,
        .rows = face_blocks,
        .sensor_from_world = face_from_sensor * sensor_from_world,
        .sensor_position = sensor_position,
        .focal_length = Eigen::Vector2f::Constant(0.5F * static_cast<float>(face_blocks)),
        .principal_point = Eigen::Vector2f::Constant(0.5F * static_cast<float>(face_blocks))};
    image.has_radial_range = true;
    std::vector<Return> returns;
    for (const Vector3f& point : scan.points) {
      if (const auto hit = image.projection.project(point)) {
        returns.push_back(
            {hit->block, image.projection.sensor_from_world * (point - sensor_position)});
      }
    }
    if (returns.empty() && face != front_face) continue;
    std::stable_sort(returns.begin(), returns.end(),
                     [](const Return& a, const Return& b) { return a.block < b.block; });
    std::vector<std::size_t> starts;
    for (int row = 0; row <= face_blocks; ++row) {
      const auto first_block = static_cast<std::uint32_t>(row * face_blocks);
      starts.push_back(static_cast<std::size_t>(
          std::lower_bound(returns.begin(), returns.end(), first_block,
                           [](const Return& r, std::uint32_t block) { return r.block < block; }) -
          returns.begin()));
    }
    image.blocks.resize(face_size);
    mark_scanned(image, face == front_face ? half_slopes(camera) : Eigen::Vector2f::Zero());
    Reducer(image, settings).reduce([&](std::size_t row) {
      return std::span<const Return>(returns).subspan(starts[row], starts[row + 1] - starts[row]);
    });
    faces.push_back(std::move(image));
  }
  return faces;
}

std::vector<BlockImage> make_block_images(const geometry::ScanSpan& scan,
                                          const geometry::Camera& camera,
                                          const BlockSettings& settings) {
  if (!scan.pixels.empty()) return {make_block_image(scan, camera, settings)};
  // The focal length of a face is half its width.
  const double spacing = 1.0 / camera.focal_length_px().minCoeff();
  const double focal_length = 1.0 / (spacing * settings.block_px);
  const int face = std::clamp(static_cast<int>(2.0 * focal_length), 16, 512);
  return make_cube_images(scan, camera, face, settings);
}

}  // namespace skycap::survey::surfel
