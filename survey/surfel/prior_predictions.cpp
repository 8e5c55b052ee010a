#include "survey/surfel/prior_predictions.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace skycap::survey::surfel {
namespace {

using Eigen::Vector3f;

/// Surfaces whose normals have a smaller cosine are different, such as the two sides of a wall.
constexpr float min_facing = -0.3F;

/// Returns a key of the cube that contains the point and of the main direction (one of six) of its
/// normal.
std::uint64_t make_cell_key(const Vector3f& position, const Vector3f& normal, float edge) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  std::uint64_t cell = static_cast<std::uint64_t>(2 * axis + (normal[axis] < 0.0F ? 1 : 0));
  constexpr std::uint64_t mask = (1U << 20) - 1U;
  const Eigen::Vector3i cube = (position / edge).array().floor().cast<int>();
  for (const int coordinate : {cube.x(), cube.y(), cube.z()}) {
    cell = cell << 20 | (static_cast<std::uint64_t>(coordinate) & mask);
  }
  return cell;
}

/// Area-weighted sums over the points of a cell.
struct Gathered {
  Vector3f position = Vector3f::Zero(), normal = Vector3f::Zero();
  float area = 0.0F, uncertainty = 0.0F;
};

std::vector<PriorPatch> gathered(const PriorSurface& surface, float edge) {
  std::unordered_map<std::uint64_t, std::size_t> index;
  std::vector<Gathered> cells;  // in order of their first points
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::uint64_t name = make_cell_key(surface.positions[i], surface.normals[i], edge);
    const auto [entry, is_new] = index.try_emplace(name, cells.size());
    if (is_new) cells.emplace_back();
    Gathered& cell = cells[entry->second];
    const float area = surface.areas[i];
    cell.position += area * surface.positions[i];
    cell.normal += area * surface.normals[i];
    cell.area += area;
    cell.uncertainty = std::max(cell.uncertainty, surface.uncertainties[i]);
  }
  std::vector<PriorPatch> patches;
  patches.reserve(cells.size());
  for (const Gathered& cell : cells) {
    if (cell.area <= 0.0F || cell.normal.norm() <= 0.0F) continue;
    patches.push_back(
        {cell.position / cell.area, cell.normal.normalized(), cell.area, cell.uncertainty});
  }
  return patches;
}

}  // namespace

PriorPredictions::PriorPredictions(const PriorSurface& surface, float spacing)
    : patches_(gathered(surface, spacing)),
      states_(patches_.size(), State::open),
      grid_(spacing),
      spacing_(spacing),
      reach_(spacing) {
  for (const PriorPatch& patch : patches_) {
    grid_.insert(patch.position);
    reach_ = std::max(reach_, spacing + patch.uncertainty);
  }
}

void PriorPredictions::update(const SurfelMap& map, const FreeSpaceHistory& space) {
  const Surfels& surfels = map.surfels();
  for (; surfels_asked_ < surfels.size(); ++surfels_asked_) {
    found_.clear();
    grid_.find_within(surfels.positions[surfels_asked_], reach_, found_);
    for (const geometry::Neighbour& near : found_) {
      const PriorPatch& patch = patches_[near.index];
      const float within = spacing_ + patch.uncertainty;
      const float cosine = surfels.normals[surfels_asked_].dot(patch.normal);
      if (near.squared_distance > within * within || cosine < min_facing) continue;
      states_[near.index] = State::found;
    }
  }
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    if (states_[i] != State::open) continue;
    const SpaceState known = space.query(patches_[i].position, images_asked_);
    if (is_unknown(known)) continue;
    states_[i] = known == SpaceState::measured ? State::found : State::refuted;
  }
  images_asked_ = space.image_count();
}

std::vector<Vector3f> PriorPredictions::standing() const {
  std::vector<Vector3f> positions;
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    if (states_[i] != State::refuted) positions.push_back(patches_[i].position);
  }
  return positions;
}

bool PriorPredictions::is_open_near(const Vector3f& point, float radius) const {
  std::vector<geometry::Neighbour> found;
  grid_.find_within(point, radius, found);
  return std::ranges::any_of(
      found, [&](const geometry::Neighbour& near) { return states_[near.index] == State::open; });
}

}  // namespace skycap::survey::surfel
