// Checks the legs of a route against a mesh and prints the legs that are closer than 2 m to it.
// `verify_route [MESH]` reads PLY, OBJ, STL or OFF files. Without a mesh it uses a tower of 10 x 10
// x 30 m.
#include <cstdio>

#include <skycap/flight/clearance.h>
#include <skycap/flight/route.h>
#include <skycap/geometry/error.h>
#include <skycap/geometry/mesh_io.h>

using namespace skycap;

int main(int argc, char** argv) try {
  const geometry::Prism tower{"tower", {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, 0.0, 30.0};
  const flight::KnownSpace space(
      {.mesh = argc > 1 ? geometry::read_mesh(argv[1]) : flight::surface(tower),
       .ground_height = 0.0});
  // Along the south side, over the edge of the roof, and down on the other side.
  const std::vector<Eigen::Vector3d> route{
      {-20, -12, 10}, {20, -12, 10}, {20, -12, 31}, {-20, 8, 31}, {-20, 12, 5}};
  const auto violations = flight::check_route(route, space, 2.0);
  for (const flight::Violation& violation : violations) {
    std::puts(flight::describe(violation).c_str());
  }
  std::printf("%zu of %zu legs have a clearance of at least 2 m\n",
              route.size() - 1 - violations.size(), route.size() - 1);
} catch (const Error& error) {
  std::fprintf(stderr, "certify_route: %s\n", error.what());
  return 2;
}
