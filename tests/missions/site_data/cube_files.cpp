#include "tests/missions/site_data/cube_files.h"

#include <cstdint>
#include <cstdio>
#include <cstring>

#include "geometry/io/las/layout.h"
#include "tests/support/e57_bytes.h"

namespace skycap::testing_support {
namespace {

using Eigen::Vector3d;

template <typename Value>
void put(std::string& bytes, std::size_t offset, Value value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

template <typename Value>
void append(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void pad(std::string& bytes, char filler) {
  while (bytes.size() % 4 != 0) bytes += filler;
}

}  // namespace

std::string numbers(const Vector3d& offset, const char* separator) {
  std::array<char, 128> text;
  std::snprintf(text.data(), text.size(), "%.3f%s%.3f%s%.3f", offset.x(), separator, offset.y(),
                separator, offset.z());
  return text.data();
}

std::string make_citygml(const Cube& cube, const std::string& crs) {
  constexpr std::array<const char*, 3> kinds = {"GroundSurface", "RoofSurface", "WallSurface"};
  std::string text =
      "<?xml version=\"1.0\"?>\n<CityModel xmlns=\"http://www.opengis.net/citygml/2.0\""
      " xmlns:bldg=\"http://www.opengis.net/citygml/building/2.0\""
      " xmlns:gml=\"http://www.opengis.net/gml\">\n"
      "<gml:boundedBy><gml:Envelope srsName=\"" +
      crs +
      "\" srsDimension=\"3\"/></gml:boundedBy>\n<cityObjectMember><bldg:Building gml:id=\"cube\">\n"
      "<bldg:function>31001_1000</bldg:function>\n";
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string kind = kinds[std::min<std::size_t>(i, 2)];
    text += "<bldg:boundedBy><bldg:" + kind + " gml:id=\"s" + std::to_string(i) +
            "\"><bldg:lod2MultiSurface><gml:MultiSurface><gml:surfaceMember><gml:Polygon>"
            "<gml:exterior><gml:LinearRing><gml:posList>";
    for (const int corner : Cube::faces[i]) text += numbers(cube.corner(corner)) + " ";
    text += numbers(cube.corner(Cube::faces[i][0])) +
            "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"
            "</gml:MultiSurface></bldg:lod2MultiSurface></bldg:" +
            kind + "></bldg:boundedBy>\n";
  }
  return text + "</bldg:Building></cityObjectMember></CityModel>\n";
}

std::string make_cityjson(const Cube& cube, const std::string& crs) {
  std::string text =
      R"({"type":"CityJSON","version":"2.0","metadata":{"referenceSystem":")" + crs +
      R"("},"transform":{"scale":[0.001,0.001,0.001],"translate":[)" + numbers(cube.low, ",") +
      R"(]},"CityObjects":{"cube":{"type":"Building","attributes":{"function":"31001_1000"},)"
      R"("geometry":[{"type":"Solid","lod":"2.2","boundaries":[[)";
  for (std::size_t i = 0; i < 6; ++i) {
    text += i == 0 ? "[[" : ",[[";
    for (std::size_t j = 0; j < 4; ++j) {
      text += (j == 0 ? "" : ",") + std::to_string(Cube::faces[i][j]);
    }
    text += "]]";
  }
  text += R"(]],"semantics":{"surfaces":[{"type":"GroundSurface"},{"type":"RoofSurface"},)"
          R"({"type":"WallSurface"}],"values":[[0,1,2,2,2,2]]}}]}},"vertices":[)";
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3i units =
        ((cube.corner(i) - cube.low) * 1000.0).array().round().cast<int>();
    text += (i == 0 ? "[" : ",[") + std::to_string(units.x()) + "," + std::to_string(units.y()) +
            "," + std::to_string(units.z()) + "]";
  }
  return text + "]}";
}

std::string make_geojson(const Cube& cube) {
  std::string ring;
  for (const int corner : {0, 1, 3, 2, 0}) {
    const std::string offset = numbers(cube.corner(corner), ",");
    ring += (ring.empty() ? "[" : ",[") + offset.substr(0, offset.rfind(',')) + "]";
  }
  return R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":)"
         R"("urn:ogc:def:crs:EPSG::25832"}},"features":[{"type":"Feature","properties":)"
         R"({"id":"cube","function":"31001_1000"},"geometry":{"type":"Polygon","coordinates":[[)" +
         ring + "]]}}]}";
}

std::string make_obj(const Cube& cube) {
  std::string text;
  for (int i = 0; i < 8; ++i) text += "v " + numbers(cube.corner(i)) + "\n";
  for (const auto& face : Cube::faces) {
    text += "f";
    for (const int corner : face) text += " " + std::to_string(corner + 1);
    text += "\n";
  }
  return text;
}

std::string make_glb(const Cube& cube) {
  std::string binary;
  for (int i = 0; i < 8; ++i) {
    const Vector3d offset = cube.corner(i) - cube.low;
    // East is x and up is y, so north is -z.
    for (const double coordinate : {offset.x(), offset.z(), -offset.y()}) {
      append(binary, static_cast<float>(coordinate));
    }
  }
  for (const auto& face : Cube::faces) {
    for (const std::size_t corner : {0, 1, 2, 0, 2, 3}) {
      append(binary, static_cast<std::uint16_t>(face[corner]));
    }
  }
  const std::string max = std::to_string(cube.size.x()) + "," + std::to_string(cube.size.z());
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"mesh":0,"name":"cube"}],"meshes":[{"primitives":[)"
      R"({"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":168}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":96,"target":34962},)"
      R"({"buffer":0,"byteOffset":96,"byteLength":72,"target":34963}],"accessors":[)"
      R"({"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,)" +
      std::to_string(-cube.size.y()) + R"(],"max":[)" + max + R"(,0]},)" +
      R"({"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}]})";
  pad(json, ' ');
  pad(binary, '\0');
  std::string bytes = "glTF";
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
  append(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append(bytes, static_cast<std::uint32_t>(binary.size()));
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

std::string make_ascii_grid(const Cube& cube) {
  constexpr int around = 4, across = 20;
  constexpr double cell = 0.5;
  const Vector3d corner = cube.low - Vector3d::Constant(around * cell);
  const std::string offset = numbers(corner);
  std::string text = "ncols 28\nnrows 28\nxllcorner " + offset.substr(0, offset.find(' ')) +
                     "\nyllcorner " +
                     offset.substr(offset.find(' ') + 1, offset.rfind(' ') - offset.find(' ') - 1) +
                     "\ncellsize 0.5\nNODATA_value -9999\n";
  for (int row = 0; row < 2 * around + across; ++row) {
    for (int column = 0; column < 2 * around + across; ++column) {
      const auto is_on = [](int i) { return i >= around && i < around + across; };
      text += is_on(row) && is_on(column) ? "390.0 " : row == 0 ? "-9999 " : "370.0 ";
    }
    text += "\n";
  }
  return text;
}

std::string make_las(const Cube& cube, int minor, int format, const std::string& wkt) {
  namespace las = geometry::las;
  const std::size_t header = minor == 4 ? 375 : minor == 3 ? 235 : 227;
  const std::size_t record = wkt.empty() ? 0 : las::record::end + wkt.size() + 1;
  const std::size_t point = las::point_size(format);
  std::string bytes(header + record + 8 * point, '\0');
  bytes.replace(0, 4, "LASF");
  put(bytes, las::header::major, std::uint8_t{1});
  put(bytes, las::header::minor, static_cast<std::uint8_t>(minor));
  put(bytes, las::header::size, static_cast<std::uint16_t>(header));
  put(bytes, las::header::first_point, static_cast<std::uint32_t>(header + record));
  put(bytes, las::header::records, std::uint32_t{wkt.empty() ? 0U : 1U});
  put(bytes, las::header::point_format, static_cast<std::uint8_t>(format));
  put(bytes, las::header::point_size, static_cast<std::uint16_t>(point));
  put(bytes, las::header::old_points, std::uint32_t{8});
  if (minor == 4) put(bytes, las::header::points, std::uint64_t{8});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(bytes, las::header::scale + 8 * axis, 0.001);
    put(bytes, las::header::offset + 8 * axis, cube.low[static_cast<int>(axis)]);
  }
  if (!wkt.empty()) {
    bytes.replace(header + las::record::user, 15, "LASF_Projection");
    put(bytes, header + las::record::id, std::uint16_t{2112});
    put(bytes, header + las::record::length, static_cast<std::uint16_t>(wkt.size() + 1));
    bytes.replace(header + las::record::end, wkt.size(), wkt);
  }
  for (int i = 0; i < 8; ++i) {
    const Vector3d units = (cube.corner(i) - cube.low) * 1000.0;
    for (int axis = 0; axis < 3; ++axis) {
      put(bytes, header + record + static_cast<std::size_t>(i) * point + 4UL * axis,
          static_cast<std::int32_t>(std::lround(units[axis])));
    }
    const std::size_t offset = header + record + static_cast<std::size_t>(i) * point;
    // Class: ground or building.
    bytes[offset + (format < 6 ? 15 : 16)] = static_cast<char>(i < 4 ? 2 : 6);
  }
  return bytes;
}

std::string make_e57(const Cube& cube, const std::string& reference_system) {
  std::vector<E57Scan> scans;
  for (int first = 0; first < 8; first += 4) {  // bottom and top, each rotated by 90 degrees
    E57Scan& scan = scans.emplace_back();
    std::array<std::vector<std::int64_t>, 3> units;
    for (int i = first; i < first + 4; ++i) {
      const Vector3d corner = (cube.corner(i) - cube.low) * 1000.0;
      const std::array turned{corner.y(), -corner.x(), corner.z()};
      for (std::size_t axis = 0; axis < 3; ++axis) units[axis].push_back(std::lround(turned[axis]));
    }
    const std::array names{"cartesianX", "cartesianY", "cartesianZ"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      scan.streams.push_back(e57_integers(names[axis], -20'000, 20'000, units[axis],
                                          "ScaledInteger", "scale=\"0.001\""));
    }
    scan.records = 4;
    scan.more =
        "<pose><rotation><w>0.70710678118654752</w><z>0.70710678118654752</z></rotation>"
        "<translation><x>" +
        std::to_string(cube.low.x()) + "</x><y>" + std::to_string(cube.low.y()) + "</y><z>" +
        std::to_string(cube.low.z()) + "</z></translation></pose>";
  }
  return testing_support::make_e57(scans, "<coordinateMetadata type=\"String\"><![CDATA[" +
                                              reference_system + "]]></coordinateMetadata>");
}

missions::site_data::Source make_source(const std::filesystem::path& file) {
  missions::site_data::Source source;
  source.file = file;
  source.crs = "EPSG:25832";
  source.vertical = missions::site_data::HeightDatum::ellipsoid;
  return source;
}

missions::site_data::SiteFrame site_at_cube() {
  return {.origin = flight::GeodeticPoint{48.763, 11.3985, 385.0},
          .takeoff_z = 2.0,
          .ground_z = 2.0,
          .undulation = 46.490242};
}

}  // namespace skycap::testing_support
