#include "survey/inspection/sight_cells.h"

#include <algorithm>
#include <cmath>

namespace skycap::survey::inspection {
namespace {

using Eigen::Array3i;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double cell_size = 1.0;
constexpr float cell_radius = 0.87F;  // half of the diagonal of a cell, rounded up
constexpr float tangent_share = 0.985F;
constexpr double incidence_margin = 2.0 * geometry::radians_per_degree;
/// Pixels along a face of the depth cube.
constexpr int min_resolution = 32, max_resolution = 96;

/// Pixels are at most as wide as the discs at the end of the range.
int cube_resolution(const StructureCloud& cloud, double range) {
  const double pixels = 2.0 * range / std::max(static_cast<double>(cloud.median_radius), 1e-3);
  return static_cast<int>(std::clamp(std::ceil(pixels), static_cast<double>(min_resolution),
                                     static_cast<double>(max_resolution)));
}

}  // namespace

SightCells::SightCells(const StructureCloud& cloud, const InspectionCamera& camera,
                       const Eigen::AlignedBox3d& box)
    : cloud_(cloud),
      camera_(camera),
      origin_(box.min()),
      counts_((box.sizes().array() / cell_size).ceil().cast<int>() + 1),
      min_cosine_(
          static_cast<float>(std::cos(std::max(0.0, camera.max_incidence - incidence_margin)))),
      squared_range_(static_cast<float>(camera.range * camera.range)),
      tan_half_width_(tangent_share * static_cast<float>(std::tan(0.5 * camera.horizontal_fov))),
      tan_half_height_(tangent_share * static_cast<float>(std::tan(0.5 * camera.vertical_fov))),
      cells_(static_cast<std::size_t>(counts_.cast<std::int64_t>().prod())) {}

SightCells::~SightCells() {
  for (std::atomic<Cell*>& cell : cells_) delete cell.load(std::memory_order_relaxed);
}

SightCells::Cell* SightCells::make_cell(const Vector3f& centre) const {
  auto cell = std::make_unique<Cell>();
  const float reach = static_cast<float>(camera_.range) + cell_radius;
  const float squared_reach = reach * reach;
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    if ((cloud_.points[i] - centre).squaredNorm() <= squared_reach) cell->entries.push_back(i);
  }
  if (!cell->entries.empty()) {
    DepthCube cube(cube_resolution(cloud_, camera_.range));
    cube.draw(cloud_, cell->entries, centre);
    for (std::uint32_t& entry : cell->entries) {
      const std::uint32_t point = entry;
      entry = point * 2 + (cube.is_visible(cloud_, point) ? 1U : 0U);
    }
  }
  cell->entries.shrink_to_fit();
  computed_.fetch_add(1, std::memory_order_relaxed);
  return cell.release();
}

const std::vector<std::uint32_t>& SightCells::entries(const Vector3d& position) const {
  static const std::vector<std::uint32_t> none;
  const Array3i at = ((position - origin_).array() / cell_size).floor().cast<int>();
  if ((at < 0).any() || (at >= counts_).any()) return none;
  const std::size_t index =
      (static_cast<std::size_t>(at.z()) * static_cast<std::size_t>(counts_.y()) +
       static_cast<std::size_t>(at.y())) *
          static_cast<std::size_t>(counts_.x()) +
      static_cast<std::size_t>(at.x());
  std::atomic<Cell*>& slot = cells_[index];
  Cell* cell = slot.load(std::memory_order_acquire);
  if (cell == nullptr) {
    const Vector3d centre =
        origin_ + cell_size * (at.matrix().cast<double>().array() + 0.5).matrix();
    Cell* const made = make_cell(centre.cast<float>());
    if (slot.compare_exchange_strong(cell, made, std::memory_order_acq_rel)) {
      cell = made;
    } else {  // Another thread computed the same cell.
      delete made;
    }
  }
  return cell->entries;
}

bool SightCells::is_in_incidence(const Vector3f& line, float distance, std::uint32_t point) const {
  return std::abs(cloud_.normals[point].dot(line)) >= min_cosine_ * distance;
}

void SightCells::add_view(const Vector3d& position, double yaw, double pitch, std::size_t targets,
                          std::uint32_t min_level, std::vector<PointSight>& sights) const {
  const CameraAxes axes(yaw, pitch);
  const Vector3f forward = axes.forward.cast<float>(), left = axes.left.cast<float>(),
                 up = axes.up.cast<float>(), eye = position.cast<float>();
  for (const std::uint32_t entry : entries(position)) {
    const std::uint32_t point = entry >> 1;
    if (point >= targets) break;
    const bool is_hidden = (entry & 1U) == 0;
    if (is_hidden && min_level > 1) continue;
    const Vector3f line = cloud_.points[point] - eye;
    const float depth = forward.dot(line);
    if (depth <= 0.0F || std::abs(left.dot(line)) > depth * tan_half_width_ ||
        std::abs(up.dot(line)) > depth * tan_half_height_) {
      continue;
    }
    const float squared = line.squaredNorm();
    if (squared > squared_range_) continue;
    std::uint32_t level = 1;
    if (!is_hidden) level = is_in_incidence(line, std::sqrt(squared), point) ? 3 : 2;
    if (level >= min_level) sights.push_back({point * 4 + level});
  }
}

std::uint32_t SightCells::level(const Vector3d& position, std::uint32_t point) const {
  const Vector3f line = cloud_.points[point] - position.cast<float>();
  const float squared = line.squaredNorm();
  if (squared > squared_range_) return 0;
  const std::vector<std::uint32_t>& near = entries(position);
  const auto found = std::ranges::lower_bound(near, point * 2);
  if (found == near.end() || *found >> 1 != point) return 0;
  if ((*found & 1U) == 0) return 1;
  return is_in_incidence(line, std::sqrt(squared), point) ? 3 : 2;
}

}  // namespace skycap::survey::inspection
