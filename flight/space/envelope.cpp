// The one source that includes CGAL's alpha wrapping, which takes twenty seconds to compile.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include "flight/space/obstacles.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

void require_positive(double alpha, double offset) {
  if (alpha > 0.0 && offset > 0.0) return;
  throw Error(ErrorKind::bad_config, "an envelope with alpha " + std::to_string(alpha) +
                                         " m and offset " + std::to_string(offset) +
                                         " m; both must be positive");
}

geometry::Mesh from_cgal(const SurfaceMesh& wrap) {
  geometry::Mesh mesh;
  std::vector<std::uint32_t> index(wrap.number_of_vertices() + wrap.number_of_removed_vertices());
  for (const auto v : wrap.vertices()) {
    index[v.idx()] = static_cast<std::uint32_t>(mesh.vertices.size());
    const auto& p = wrap.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto face : wrap.faces()) {
    std::array<std::uint32_t, 3> triangle{};
    std::size_t corner = 0;
    for (const auto v : CGAL::vertices_around_face(wrap.halfedge(face), wrap)) {
      triangle[corner++] = index[v.idx()];
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

geometry::Mesh envelope(const geometry::Mesh& mesh, double alpha, double offset) {
  require_positive(alpha, offset);
  geometry::validate(mesh);
  std::vector<Kernel::Point_3> points;
  points.reserve(mesh.vertices.size());
  for (const auto& v : mesh.vertices) points.emplace_back(v.x(), v.y(), v.z());
  std::vector<std::array<std::size_t, 3>> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    // Triangles without area have no plane for the wrapping to work with; their edges belong to
    // neighbours in any mesh that has a surface.
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    if ((q - p).cross(r - p).squaredNorm() > 0.0) triangles.push_back({a, b, c});
  }
  SurfaceMesh wrap;
  CGAL::alpha_wrap_3(points, triangles, alpha, offset, wrap);
  return from_cgal(wrap);
}

geometry::Mesh envelope(std::span<const Eigen::Vector3f> points, double alpha, double offset) {
  require_positive(alpha, offset);
  std::vector<Kernel::Point_3> wrapped;
  wrapped.reserve(points.size());
  for (const auto& p : points) {
    if (p.allFinite()) wrapped.emplace_back(p.x(), p.y(), p.z());
  }
  if (wrapped.empty()) {
    throw Error(ErrorKind::bad_geometry, "there is no finite point to wrap an envelope around");
  }
  SurfaceMesh wrap;
  CGAL::alpha_wrap_3(wrapped, alpha, offset, wrap);
  return from_cgal(wrap);
}

}  // namespace skycap::flight
