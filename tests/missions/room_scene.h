/// Room with a door, for tests of reachable space.
#pragma once

#include "geometry/surfaces/mesh.h"
#include "sim/models/masonry/solids.h"

namespace skycap::tests {

struct Room {
  double width = 20.0;  ///< inner side of the square floor [m]
  double height = 10.0;
  double wall = 0.5;
  double door_width = 0.0;  ///< in the middle of the wall towards -y, from the floor upwards [m]
  double door_height = 0.0;
};

/// Returns closed solids: base, roof and walls around the origin. The floor inside is at z = 0.
inline geometry::Mesh room_mesh(const Room& room) {
  const double in = 0.5 * room.width, out = in + room.wall, top = room.height;
  const double door = 0.5 * room.door_width;
  geometry::Mesh mesh;
  const auto add = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    geometry::append(mesh, sim::models::box(low, high));
  };
  add({-out, -out, -room.wall}, {out, out, 0.0});
  add({-out, -out, top}, {out, out, top + room.wall});
  add({-out, -out, 0.0}, {-in, out, top});
  add({in, -out, 0.0}, {out, out, top});
  add({-in, in, 0.0}, {in, out, top});
  if (door == 0.0) {
    add({-in, -out, 0.0}, {in, -in, top});
    return mesh;
  }
  add({-in, -out, 0.0}, {-door, -in, top});
  add({door, -out, 0.0}, {in, -in, top});
  if (room.door_height < top) add({-door, -out, room.door_height}, {door, -in, top});
  return mesh;
}

}  // namespace skycap::tests
