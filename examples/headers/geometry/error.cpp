#include <string_view>

#include <skycap/geometry/error.h>
#include <skycap/geometry/mesh_io.h>

#include "example.h"

// An Error contains a one-sentence message for the user and a kind.
const Example error_example("geometry/error", [] {
  try {
    skycap::geometry::read_mesh("no_such_roof.ply");
  } catch (const skycap::Error& error) {
    return error.kind() == skycap::ErrorKind::bad_file &&
           std::string_view(error.what()).starts_with("no_such_roof.ply");
  }
  return false;
});
