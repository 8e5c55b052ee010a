#include <chrono>
#include <filesystem>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/mesh_io.h"
#include "missions/cli/commands.h"
#include "missions/support/reconstruction.h"

namespace skycap::missions::cli {

int reconstruct_cloud(const ReconstructOptions& options, const Console& console) {
  support::ReconstructionConfig config;
  config.depth = options.depth;
  config.spacing = options.spacing;
  config.min_density = options.min_density;
  config.threads = options.threads;
  config.validate();
  std::filesystem::path out = options.cloud;
  out.replace_extension();
  out += "_mesh.ply";
  out = options.out.value_or(out);

  ProgressLine progress(console, false);
  progress.show("reading " + options.cloud.string());
  const geometry::AttributedCloud cloud = geometry::read_cloud(options.cloud);
  progress.show("reconstructing a mesh of " + options.cloud.string());
  const auto start = std::chrono::steady_clock::now();
  const support::Reconstruction result = [&] {
    try {
      return support::reconstruct(cloud.positions, cloud.normals, config);
    } catch (const Error& error) {
      throw Error(error.kind(), options.cloud.string() + ": " + error.what());
    }
  }();
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  geometry::write_mesh(out, result.mesh);
  progress.clear();
  console.out << fmt::format(
                     "{}: {} points, spacing {:.3g} m{}\n  surface   {} triangles in {:.1f} s, "
                     "octree depth {}; {} triangles trimmed\n",
                     options.cloud.filename().string(), result.points, result.spacing,
                     cloud.normals.empty() ? ", normals estimated" : "",
                     result.mesh.triangles.size(), time.count(), result.depth,
                     result.trimmed_triangles)
              << "  results   " << out.string() << "\n";
  return 0;
}

}  // namespace skycap::missions::cli
