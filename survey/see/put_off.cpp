#include "survey/see/put_off.h"

#include "geometry/points/spatial_index.h"

namespace skycap::survey::see {

std::vector<std::uint32_t> PutOffFrontiers::forget_around(const Eigen::Vector3d& place) {
  std::vector<std::uint32_t> forgotten;
  std::erase_if(frontiers_, [&](const auto& entry) {
    const bool is_near = (entry.second.position - place).norm() < spacing_;
    if (is_near) forgotten.push_back(entry.first);
    return is_near;
  });
  return forgotten;
}

void PutOffFrontiers::take_up_again(const ViewPlacement& placement, FrontierMap& to) {
  geometry::PointGrid taken(spacing_ > 0.0 ? spacing_ : 1.0);
  for (auto next = frontiers_.begin(); next != frontiers_.end();) {
    const auto here = next++;
    Frontier& frontier = here->second;
    const Eigen::Vector3f place = frontier.position.cast<float>();
    if (spacing_ > 0.0 && taken.any_within(place, spacing_)) continue;
    taken.insert(place);
    frontier.view = look_again(frontier, placement);
    frontier.was_put_off = true;
    to.insert(frontiers_.extract(here));
  }
}

}  // namespace skycap::survey::see
