#include <span>
#include <sstream>

#include "flight/clearance/measured_space.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/column_cloud.h"
#include "geometry/io/las/las_conversion.h"
#include "geometry/io/mesh_io.h"
#include "geometry/pose/world.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"

namespace skycap::fuzz {
namespace {

void require_sane(const geometry::Mesh& mesh) {
  require(!mesh.triangles.empty(), "a mesh without triangles");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      require(v < mesh.vertices.size(), "a triangle of vertices that do not exist");
      require(geometry::is_valid_position(mesh.vertices[v], geometry::farthest_vertex),
              "a corner out of the world");
    }
  }
}

int run_mesh(const char* name, const std::uint8_t* bytes, std::size_t size) {
  return run_reader(name, [&] {
    const auto path = file_with(name, bytes_to_string(bytes, size));
    require_sane(geometry::read_mesh(path));
    for (const auto& part : geometry::read_mesh_by_material(path)) require_sane(part.mesh);
  });
}

/// Reads all attributes of a cloud, writes it as LAZ and reads it again.
void require_convertible(const std::filesystem::path& path) {
  const geometry::ColumnCloud cloud = geometry::read_column_cloud(path);
  for (const auto& column : cloud.columns) {
    require(column.empty() || column.size() == cloud.positions.size(), "points without attributes");
  }
  require(cloud.times.empty() || cloud.times.size() == cloud.positions.size(),
          "points without times");
  const auto copy = file_with("copy.laz", "");
  try {
    geometry::write_column_cloud(copy, cloud);
  } catch (const Error& error) {  // the message names the copy
    const bool is_expected =
        std::string_view(error.what()).find("coordinates extend over") != std::string_view::npos;
    require(is_expected, "a cloud that cannot be written");
    return;
  }
  require(geometry::read_column_cloud(copy).positions.size() == cloud.positions.size(),
          "a copy with other points");
}

/// Converts a LAS or LAZ file without reading it as a whole.
void require_convertible_las(const std::filesystem::path& path) {
  const auto copy = file_with("converted.las", "");
  geometry::las::convert_las(path, copy, false, {1, 2, 3}, "", [&](double share) {
    require(share >= 0.0 && share <= 1.0, "a share out of its range");
  });
}

int run_cloud(const char* name, const std::uint8_t* bytes, std::size_t size) {
  if (std::string_view(name).find(".la") != std::string_view::npos) {
    run_reader("", [&] { require_convertible_las(file_with(name, bytes_to_string(bytes, size))); });
  }
  run_reader(name, [&] {
    const auto path = file_with(name, bytes_to_string(bytes, size));
    double last = 0.0;
    geometry::read_positions(path, [&](std::span<const Eigen::Vector3f> points, double end) {
      require(end >= last && end <= 1.0, "a share that goes back");
      last = end;
      for (const Eigen::Vector3f& point : points) {
        require(geometry::is_valid_position(point.cast<double>(), 16384.0),
                "a point out of the world");
      }
    });
  });
  run_reader(name, [&] { require_convertible(file_with(name, bytes_to_string(bytes, size))); });
  return run_reader(name, [&] {
    const auto cloud = geometry::read_cloud(file_with(name, bytes_to_string(bytes, size)));
    const std::size_t count = cloud.positions.size();
    require(count > 0, "a cloud without points");
    require(cloud.normals.empty() || cloud.normals.size() == count, "points without normals");
    require(cloud.views.empty() || cloud.views.size() == count, "points without views");
    require(cloud.colours.empty() || cloud.colours.size() == count, "points without colours");
    for (const Eigen::Vector3f& position : cloud.positions) {
      require(geometry::is_valid_position(position.cast<double>(), 16384.0),
              "a point out of the world");
    }
  });
}

int run_e57(const std::uint8_t* bytes, std::size_t size) {
  const std::string sealed = sealed_e57(bytes_to_string(bytes, size));
  return run_cloud("cloud.e57", reinterpret_cast<const std::uint8_t*>(sealed.data()),
                   sealed.size());
}

/// Reads measured free space. When it is written and read again it must be equal.
int run_free_space(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("free_space.bin", [&] {
    std::istringstream stream(bytes_to_string(bytes, size));
    const auto space = flight::MeasuredSpace::read(stream, "free_space.bin");
    std::stringstream first, second;
    space.write(first);
    flight::MeasuredSpace::read(first, "written").write(second);
    require(first.str() == second.str(), "free space changes when it is written and read");
    const Eigen::AlignedBox3d extent = space.extent();
    require(extent.isEmpty() || (geometry::is_valid_position(extent.min()) &&
                                 geometry::is_valid_position(extent.max())),
            "free space out of the world");
    space.closest({{0, 0, 0}, {1, 1, 1}}, 2.0);
  });
}

constexpr Reader readers[] = {
    {"mesh_ply", [](const std::uint8_t* b, std::size_t n) { return run_mesh("mesh.ply", b, n); }},
    {"mesh_obj", [](const std::uint8_t* b, std::size_t n) { return run_mesh("mesh.obj", b, n); }},
    {"mesh_off", [](const std::uint8_t* b, std::size_t n) { return run_mesh("mesh.off", b, n); }},
    {"mesh_stl", [](const std::uint8_t* b, std::size_t n) { return run_mesh("mesh.stl", b, n); }},
    {"mesh_drc", [](const std::uint8_t* b, std::size_t n) { return run_mesh("mesh.drc", b, n); }},
    {"cloud_ply",
     [](const std::uint8_t* b, std::size_t n) { return run_cloud("cloud.ply", b, n); }},
    {"cloud_pcd",
     [](const std::uint8_t* b, std::size_t n) { return run_cloud("cloud.pcd", b, n); }},
    {"cloud_las",
     [](const std::uint8_t* b, std::size_t n) { return run_cloud("cloud.las", b, n); }},
    {"cloud_laz",
     [](const std::uint8_t* b, std::size_t n) { return run_cloud("cloud.laz", b, n); }},
    {"cloud_e57", run_e57},
    {"cloud_xyz",
     [](const std::uint8_t* b, std::size_t n) { return run_cloud("cloud.xyz", b, n); }},
    {"gzip", [](const std::uint8_t* b, std::size_t n) { return run_cloud("cloud.xyz.gz", b, n); }},
    {"free_space", run_free_space},
};

}  // namespace

std::span<const Reader> surface_readers() { return readers; }

}  // namespace skycap::fuzz
