#include <skycap/geometry/mesh_io.h>

#include "example.h"

// Writes a triangle to an OBJ file and reads it back.
const Example mesh_io_example("geometry/mesh_io", [] {
  const skycap::geometry::Mesh gable{{{0, 0, 0}, {4, 0, 0}, {2, 0, 3}}, {{0, 1, 2}}};
  skycap::geometry::write_mesh(scratch("gable.obj"), gable);
  const skycap::geometry::Mesh read = skycap::geometry::read_mesh(scratch("gable.obj"));
  return read.vertices == gable.vertices && read.triangles == gable.triangles;
});
