#include "survey/see/deferred_frontiers.h"

#include "geometry/points/spatial_index.h"

namespace skycap::survey::see {

std::vector<std::uint32_t> DeferredFrontiers::forget_around(const Eigen::Vector3d& position) {
  std::vector<std::uint32_t> forgotten;
  std::erase_if(frontiers_, [&](const auto& entry) {
    const bool is_near = (entry.second.position - position).norm() < spacing_;
    if (is_near) forgotten.push_back(entry.first);
    return is_near;
  });
  return forgotten;
}

void DeferredFrontiers::requeue(const ViewPlacement& placement, FrontierMap& to) {
  geometry::PointGrid occupied(spacing_ > 0.0 ? spacing_ : 1.0);
  for (auto next = frontiers_.begin(); next != frontiers_.end();) {
    const auto here = next++;
    Frontier& frontier = here->second;
    const Eigen::Vector3f position = frontier.position.cast<float>();
    if (spacing_ > 0.0 && occupied.any_within(position, spacing_)) continue;
    occupied.insert(position);
    frontier.view = reobserve_view(frontier, placement);
    frontier.was_deferred = true;
    to.insert(frontiers_.extract(here));
  }
}

}  // namespace skycap::survey::see
