#include <fstream>

#include "geometry/pose/world.h"
#include "missions/site_data/file_reader.h"
#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/formats/photogrammetry_offset.h"
#include "missions/site_data/formats/scene_facts.h"
#include "missions/site_data/prior.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/trial_run.h"

namespace skycap::fuzz {
namespace {

namespace site_data = missions::site_data;

void require_sane(const site_data::FileContents& contents) {
  const std::size_t rings = contents.ring_begin.size() - 1;
  for (std::size_t i = 0; i < rings; ++i) {
    require(contents.ring_begin[i] <= contents.ring_begin[i + 1], "a ring that ends before itself");
  }
  require(contents.ring_begin.back() <= contents.corners.size(), "a ring of corners not there");
  for (const site_data::FileObject& object : contents.objects) {
    require(!object.parent || *object.parent < contents.objects.size(),
            "part of what is not there");
    for (const site_data::FilePolygon& polygon : object.polygons) {
      require(polygon.first_ring + polygon.rings <= rings, "a polygon of rings that are not there");
    }
  }
}

void require_sane(const site_data::Prior& known) {
  require(!known.box.isEmpty(), "a prior of nothing");
  for (const site_data::Object& object : known.objects) {
    require(object.surfaces.size() == object.mesh.triangles.size(), "triangles without a kind");
    for (const auto& triangle : object.mesh.triangles) {
      for (const std::uint32_t v : triangle) {
        require(v < object.mesh.vertices.size(), "a triangle of vertices that do not exist");
        require(geometry::is_valid_position(object.mesh.vertices[v]), "a corner out of the world");
      }
    }
  }
}

/// Reads a file as parsed data and as a prior with its own georeference.
template <typename Parse>
int run(const char* name, const std::uint8_t* bytes, std::size_t size, Parse parse) {
  run_reader(name, [&] { require_sane(parse(bytes_to_string(bytes, size))); });
  return run_reader(name, [&] {
    site_data::Source source;
    source.file = file_with(name, bytes_to_string(bytes, size));
    source.pose = site_data::SourcePose{};
    require_sane(site_data::read_prior(source, {}));
  });
}

int run_citygml(const std::uint8_t* bytes, std::size_t size) {
  return run("city.gml", bytes, size, [](std::string text) {
    return site_data::parse_citygml("city.gml", std::move(text));
  });
}

int run_cityjson(const std::uint8_t* bytes, std::size_t size) {
  return run("city.json", bytes, size,
             [](const std::string& text) { return site_data::parse_cityjson("city.json", text); });
}

/// Reads an earlier scan, which is downsampled during reading.
int run_scan(const char* name, const std::uint8_t* bytes, std::size_t size) {
  return run_reader(name, [&] {
    site_data::Source source;
    source.file = file_with(name, bytes_to_string(bytes, size));
    source.pose = site_data::SourcePose{};
    const site_data::Prior known = site_data::read_prior(source, {});
    require(!known.box.isEmpty(), "a prior of nothing");
    for (const Eigen::Vector3f& point : known.points) {
      require(geometry::is_valid_position(point.cast<double>()), "a point out of the world");
    }
  });
}

/// Reads a file in a format of GDAL or Assimp. Assimp runs in a child process, which libFuzzer
/// cannot observe.
int run_library(const char* name, site_data::Role role, const std::uint8_t* bytes,
                std::size_t size) {
  return run_reader(name, [&] {
    site_data::Source source;
    source.file = file_with(name, bytes_to_string(bytes, size));
    source.role = role;
    source.crs = "EPSG:32630";
    source.height = 10.0;
    source.base = 100.0;
    source.vertical = site_data::HeightDatum::ellipsoid;
    site_data::SiteFrame site;
    site.origin = flight::GeodeticPoint{51.753458, -1.254022, 111.5};
    const bool is_map = site_data::Role::obstacle == role;
    if (is_map) require_sane(*site_data::read_contents(source, site));
    if (role == site_data::Role::terrain) source.base = source.height = std::nullopt;
    require(!site_data::read_prior(source, site).box.isEmpty(), "a prior of nothing");
  });
}

template <site_data::Role role>
int run_map(const char* name, const std::uint8_t* bytes, std::size_t size) {
  return run_library(name, role, bytes, size);
}

/// Reads the properties of a scene that Assimp ignores.
int run_gltf_facts(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("s.glb", [&] {
    const auto file = file_with("s.glb", bytes_to_string(bytes, size));
    const auto facts = site_data::gltf_facts(file, site_data::gltf_json(file));
    require(!facts.unit || *facts.unit > 0.0, "a unit without length");
  });
}

int run_ifc_facts(const std::uint8_t* bytes, std::size_t size) {
  return run_reader("s.ifc", [&] {
    const std::string text = bytes_to_string(bytes, size);
    site_data::ifc_facts("s.ifc", text, true);
    const auto facts = site_data::ifc_facts("s.ifc", text, false);
    require(!facts.unit || *facts.unit > 0.0, "a unit without length");
  });
}

/// Reads the coordinate offset of a mesh. The first byte selects the program that wrote it.
int run_mesh_offset(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  constexpr const char* files[] = {"odm_georeferencing/coords.txt", "model_offset.xyz",
                                   "metadata.xml"};
  const std::filesystem::path folder = fresh_folder();
  std::filesystem::create_directories(folder / "odm_georeferencing");
  const char* const name = files[bytes[0] % 3];
  std::ofstream(folder / name, std::ios::binary) << bytes_to_string(bytes + 1, size - 1);
  std::filesystem::create_directories(folder / "odm_texturing");
  const auto mesh = bytes[0] % 3 == 0 ? folder / "odm_texturing/odm_textured_model_geo.obj"
                                      : folder / "model.obj";
  return run_reader(std::filesystem::path(name).filename().string(), [&] {
    const auto found = site_data::find_photogrammetry_offset(mesh);
    require(!found || found->offset.allFinite(), "an offset that is not finite");
  });
}

constexpr Reader readers[] = {
    {"map_geojson",
     [](const std::uint8_t* b, std::size_t n) {
       return run_map<site_data::Role::obstacle>("m.geojson", b, n);
     }},
    {"map_kml", [](const std::uint8_t* b,
                   std::size_t n) { return run_map<site_data::Role::obstacle>("m.kml", b, n); }},
    {"map_osm", [](const std::uint8_t* b,
                   std::size_t n) { return run_map<site_data::Role::obstacle>("m.osm", b, n); }},
    {"map_dxf", [](const std::uint8_t* b,
                   std::size_t n) { return run_map<site_data::Role::obstacle>("m.dxf", b, n); }},
    {"raster_asc", [](const std::uint8_t* b,
                      std::size_t n) { return run_map<site_data::Role::terrain>("t.asc", b, n); }},
    {"raster_tif", [](const std::uint8_t* b,
                      std::size_t n) { return run_map<site_data::Role::terrain>("t.tif", b, n); }},
    {"raster_xyz", [](const std::uint8_t* b,
                      std::size_t n) { return run_map<site_data::Role::terrain>("t.xyz", b, n); }},
    {"scene_gltf",
     [](const std::uint8_t* b, std::size_t n) {
       return run_map<site_data::Role::obstacle>("s.gltf", b, n);
     }},
    {"scene_dae", [](const std::uint8_t* b,
                     std::size_t n) { return run_map<site_data::Role::obstacle>("s.dae", b, n); }},
    {"gltf_facts", run_gltf_facts},
    {"ifc_facts", run_ifc_facts},
    {"mesh_offset", run_mesh_offset},
    {"citygml", run_citygml},
    {"cityjson", run_cityjson},
    {"prior_las", [](const std::uint8_t* b, std::size_t n) { return run_scan("site.las", b, n); }},
    {"prior_e57",
     [](const std::uint8_t* b, std::size_t n) {
       const std::string sealed = sealed_e57(bytes_to_string(b, n));
       return run_scan("site.e57", reinterpret_cast<const std::uint8_t*>(sealed.data()),
                       sealed.size());
     }},
};

}  // namespace

std::span<const Reader> prior_readers() { return readers; }

}  // namespace skycap::fuzz
