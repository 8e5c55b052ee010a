#include "missions/verbs/true_space.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "flight/route/pad_check.h"
#include "missions/derived/mission_flight.h"

namespace skycap::missions::verbs {
namespace {

/// The triangles of which some part is above that height.
geometry::Mesh above(geometry::Mesh mesh, double height) {
  std::erase_if(mesh.triangles, [&](const auto& triangle) {
    return std::ranges::all_of(triangle,
                               [&](auto vertex) { return mesh.vertices[vertex].z() < height; });
  });
  return mesh;
}

}  // namespace

TrueSpace true_space(const file::Mission& mission, const geometry::Mesh& model, double pad_height) {
  flight::Obstacles obstacles = derived::flight_rules(mission);
  obstacles.mesh = model;
  flight::KnownSpace everywhere(obstacles);
  obstacles.mesh = above(model, pad_height + flight::pad_roughness);
  return {std::move(everywhere), flight::KnownSpace(without_ground(std::move(obstacles)))};
}

}  // namespace skycap::missions::verbs
