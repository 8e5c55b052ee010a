#include "geometry/pose/world.h"
#include "missions/site_data/formats/file_contents.h"
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

constexpr Reader readers[] = {
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
