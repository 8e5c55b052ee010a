#include "geometry/io/mesh_io.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "geometry/error.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

/// Returns a closed surface with shared vertices: a pyramid on the unit square.
Mesh pyramid() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.75}},
          {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
}

constexpr double pyramid_volume = 0.25;

double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6.0;
  }
  return sum;
}

class MeshIo : public testing::Test {
 protected:
  Mesh read(std::string_view name, std::string_view bytes, const MeshOptions& options = {}) {
    return read_mesh(folder_.file(name, bytes), options);
  }

  /// Returns the error message for such a file, without the folder name.
  std::string error_message(std::string_view name, std::string_view bytes) {
    try {
      read(name, bytes);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_file);
      std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
      EXPECT_TRUE(message.starts_with((folder_.path() / name).string() + ": ")) << message;
      return message.substr((folder_.path() / name).string().size() + 2);
    }
    return "no error";
  }

  TemporaryFolder folder_;
};

class MeshIoRoundTrip : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Formats, MeshIoRoundTrip, testing::Values("ply", "obj", "stl", "off"),
                         [](const auto& format) { return std::string(format.param); });

TEST_P(MeshIoRoundTrip, KeepsTheMesh) {
  const TemporaryFolder folder;
  const auto path = folder.path() / (std::string("mesh.") + GetParam());
  write_mesh(path, pyramid());
  const Mesh again = read_mesh(path);
  EXPECT_DOUBLE_EQ(volume(again), pyramid_volume);
  EXPECT_EQ(again.triangles.size(), 6U);
  EXPECT_EQ(again.vertices.size(), 5U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
      << "no temporary file is left";
}

// CGAL, an independent reader, reads the written files.
TEST_P(MeshIoRoundTrip, WritesFilesThatCgalReads) {
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  const TemporaryFolder folder;
  const auto path = folder.path() / (std::string("mesh.") + GetParam());
  write_mesh(path, pyramid());
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
  ASSERT_TRUE(CGAL::IO::read_polygon_soup(path.string(), points, polygons));
  ASSERT_EQ(polygons.size(), 6U);
  Mesh read;
  for (const Point& p : points) read.vertices.emplace_back(p.x(), p.y(), p.z());
  for (const auto& polygon : polygons) {
    ASSERT_EQ(polygon.size(), 3U);
    read.triangles.push_back({static_cast<std::uint32_t>(polygon[0]),
                              static_cast<std::uint32_t>(polygon[1]),
                              static_cast<std::uint32_t>(polygon[2])});
  }
  EXPECT_DOUBLE_EQ(volume(read), pyramid_volume);
}

TEST_F(MeshIo, KeepsDoublePrecisionCoordinates) {
  Mesh mesh = pyramid();
  mesh.vertices[4] = {0.1, 1e7 + 0.3, 1.0 / 3.0};
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.off"}) {
    write_mesh(folder_.path() / name, mesh);
    EXPECT_EQ(read_mesh(folder_.path() / name).vertices, mesh.vertices) << name;
  }
}

constexpr std::string_view ascii_ply =
    "ply\r\nformat ascii 1.0\r\ncomment any\r\nelement vertex 4\r\nproperty uchar red\r\n"
    "property double z\r\nproperty float x\r\nproperty float y\r\nelement edge 1\r\n"
    "property int a\r\nproperty int b\r\nelement face 1\r\nproperty list uchar float weights\r\n"
    "property list uchar uint vertex_index\r\nproperty float quality\r\nend_header\r\n"
    "7 5 0 0\r\n7 5 1 0\r\n7 5 1 +1\r\n7 5 0 1e0\r\n0 1\r\n2 0.5 nan 4 0 1 2 3 9.5\r\n";

TEST_F(MeshIo, ReadsPlyPropertiesInAnyOrder) {
  const Mesh mesh = read("a.ply", ascii_ply);
  EXPECT_EQ(mesh.vertices[2], Vector3d(1, 1, 5));
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_DOUBLE_EQ(surface_area(mesh), 1.0);
}

// The same file in both byte orders, assembled byte by byte.
TEST_F(MeshIo, ReadsPlyInBothByteOrders) {
  for (const bool big : {false, true}) {
    std::string bytes = "ply\nformat binary_";
    bytes += big ? "big" : "little";
    bytes +=
        "_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\n"
        "element face 1\nproperty list ushort int vertex_indices\nend_header\n";
    const auto add = [&](auto value) {
      std::string raw(reinterpret_cast<const char*>(&value), sizeof(value));
      if (big) std::reverse(raw.begin(), raw.end());
      bytes += raw;
    };
    for (const Vector3d& v : {Vector3d(0, 0, -300), Vector3d(2.5, 0, -300), Vector3d(0, 4, -300)}) {
      add(static_cast<float>(v.x()));
      add(v.y());
      add(static_cast<std::int16_t>(v.z()));
    }
    add(std::uint16_t{3});
    for (const std::int32_t index : {0, 1, 2}) add(index);
    const Mesh mesh = read("b.ply", bytes);
    EXPECT_EQ(mesh.vertices[1], Vector3d(2.5, 0, -300));
    EXPECT_DOUBLE_EQ(surface_area(mesh), 5.0);
  }
}

TEST_F(MeshIo, ReadsObjIndicesPolygonsAndForwardReferences) {
  const Mesh mesh = read("a.obj",
                         "# square\nmtllib x.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nvt 0 0\nvn 0 0 1\n"
                         "v 1 1 0\nv 0 1 0\nf -4/1/1 -3//1 \\\n 3 4\nf 1 2 5\nv 0 0 1\n");
  EXPECT_EQ(mesh.triangles.size(), 3U);
  EXPECT_DOUBLE_EQ(surface_area(mesh), 1.5);
}

TEST_F(MeshIo, ReadsOffCommentsColoursAndFirstLineCounts) {
  for (const char* head : {"OFF\n# c\n4 1 0\n", "COFF 4 1 0\n", "# c\nOFF\n\n4 1 0 # e\n"}) {
    const Mesh mesh = read(
        "a.off", std::string(head) + "0 0 0 255 0 0\n1 0 0\n\n1 1 0\n0 1 0\n4 0 1 2 3 9 9 9\n");
    EXPECT_DOUBLE_EQ(surface_area(mesh), 1.0) << head;
  }
}

TEST_F(MeshIo, MergesVerticesOfAsciiStl) {
  const Mesh mesh = read("a.stl",
                         "solid a b c\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"
                         "   vertex 1 0 0\n   vertex 1 1 0\n  endloop\n endfacet\n"
                         "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\n"
                         "vertex 0 1 -0.0\nendloop\nendfacet\nendsolid a b c\n");
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_DOUBLE_EQ(surface_area(mesh), 1.0);
}

TEST_F(MeshIo, ReadsBinaryStlThatBeginsWithSolid) {
  const auto path = folder_.path() / "mesh.stl";
  write_mesh(path, pyramid());
  {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file << "solid";
  }
  EXPECT_DOUBLE_EQ(volume(read_mesh(path)), pyramid_volume);
}

// An L shape that is cut at the wrong side of its reflex corner would cover more than its area.
TEST_F(MeshIo, KeepsAreaAndOrientationOfConcavePolygons) {
  const Mesh mesh = read("a.off",
                         "OFF 8 2 0\n0 0 2\n3 0 2\n3 1 2\n1 1 2\n1 3 2\n0 3 2\n0 0 0\n0 3 0\n"
                         "6 0 1 2 3 4 5\n4 0 5 7 6\n");
  EXPECT_NEAR(surface_area(mesh), 5.0 + 6.0, 1e-12);
  for (std::size_t t = 0; t < 4; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    EXPECT_GT((mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).z(),
              0.0);
  }
}

TEST_F(MeshIo, RemovesUnusedVerticesAndTrianglesWithoutArea) {
  const Mesh mesh = read("a.off",
                         "OFF 5 4 0\n0 0 0\nnan 0 0\n1 0 0\n0 1 0\n2 0 0\n3 0 2 3\n3 0 0 2\n"
                         "3 0 2 4\n2 0 2\n");
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.triangles.size(), 1U);
}

TEST_F(MeshIo, OrientsInvertedMeshesOnRequest) {
  Mesh inside_out = pyramid();
  for (auto& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  const auto path = folder_.path() / "mesh.ply";
  write_mesh(path, inside_out);
  EXPECT_DOUBLE_EQ(volume(read_mesh(path)), -pyramid_volume);
  EXPECT_DOUBLE_EQ(volume(read_mesh(path, {.orient_outward = true})), pyramid_volume);
}

TEST_F(MeshIo, ReadsGzipAndRejectsTruncatedGzip) {
  const auto path = folder_.path() / "mesh.ply.gz";
  gzFile file = gzopen(path.c_str(), "wb");
  ASSERT_EQ(gzwrite(file, ascii_ply.data(), static_cast<unsigned>(ascii_ply.size())),
            static_cast<int>(ascii_ply.size()));
  gzclose(file);
  EXPECT_DOUBLE_EQ(surface_area(read_mesh(path)), 1.0);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_THAT([&] { read_mesh(path); },
              testing::ThrowsMessage<Error>(HasSubstr("is not a complete gzip file")));
}

std::string draco_pyramid() {
  draco::TriangleSoupMeshBuilder builder;
  const Mesh mesh = pyramid();
  builder.Start(static_cast<int>(mesh.triangles.size()));
  const int position =
      builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Eigen::Vector3f, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = mesh.vertices[mesh.triangles[t][i]].cast<float>();
    }
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(static_cast<unsigned>(t)),
                                      corners[0].data(), corners[1].data(), corners[2].data());
  }
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*builder.Finalize(), &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST_F(MeshIo, DecodesDraco) {
  const Mesh mesh = read("a.drc", draco_pyramid());
  EXPECT_EQ(mesh.vertices.size(), 5U);
  EXPECT_EQ(mesh.triangles.size(), 6U);
  // 14 bits for the unit box: steps of 6e-5 in each coordinate.
  EXPECT_NEAR(volume(mesh), pyramid_volume, 1e-4);
}

// Draco accepts any byte as a boolean, but only 0 and 1 are valid.
TEST_F(MeshIo, RejectsDracoWithBooleanPositions) {
  constexpr std::string_view digits =
      "445241434f02020100000004040100010200020302012a0100030101000b03000000000000000000"
      "000000001f8b000000000000803f000000000000803f000000000000000000000800000000000000"
      "803f";
  std::string bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    bytes.push_back(static_cast<char>(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16)));
  }
  EXPECT_THAT([&] { read("bools.drc", bytes); },
              testing::ThrowsMessage<Error>(HasSubstr("has positions of an unsupported type")));
}

TEST_F(MeshIo, ReportsCauseForInvalidFiles) {
  const auto ply = [](std::string_view rest) {
    return "ply\nformat ascii 1.0\n" + std::string(rest);
  };
  const std::string three =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  std::string short_stl(84, ' ');
  short_stl[80] = 9;
  short_stl[81] = short_stl[82] = short_stl[83] = 0;

  const struct {
    std::string name, bytes, message;
  } cases[] = {
      {"empty.ply", "", "is empty"},
      {"not.ply", "solid x", "line 1: the first line of a PLY file must be 'ply'"},
      {"no_format.ply", "ply\nend_header\n", "the header must contain a line 'format"},
      {"no_end.ply", "ply\nformat ascii 1.0\n", "the header ends without a line 'end_header'"},
      {"format.ply", "ply\nformat binary_pdp 1.0\n", "line 2: the format 'binary_pdp' is unknown"},
      {"type.ply", ply("element vertex 3\nproperty flot x\n"), "line 4: the property type 'flot'"},
      {"orphan.ply", ply("property float x\n"), "line 3: a property must follow the element"},
      {"word.ply", ply("elephant vertex 3\n"), "line 3: 'elephant' is not a PLY header keyword"},
      {"count.ply", ply("element vertex many\n"), "line 3: expected a number of elements"},
      {"list.ply", ply("element face 1\nproperty list float int vertex_indices\nend_header\n"),
       "the length of a list must have an integer type"},
      {"huge.ply", ply("element vertex 30000000\nproperty float x\nend_header\n1\n"),
       "declares 30000000 of element 'vertex', but the file is too short"},
      {"vertices.ply", ply("element vertex 120000001\nproperty float x\nend_header\n1\n"),
       "contains more than 40000000 faces, 120000000 corners of faces or 120000000 vertices"},
      {"faces.ply",
       ply(three + "element face 40000001\nproperty list uchar int vertex_indices\nend_header\n" +
           points),
       "contains more than 40000000 faces"},
      {"xy.ply", ply("element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n"),
       "must have the properties x, y and z"},
      {"no_vertex.ply", ply(face + "3 0 1 2\n"), "missing element 'vertex'"},
      {"index.ply", ply(three + face + points + "3 0 1 3\n"),
       "face 0 has vertex 3, but there are 3 vertices, counted from 0"},
      {"negative.ply", ply(three + face + points + "3 0 -1 2\n"), "face 0 has vertex -1"},
      {"cut.ply", ply(three + face + points + "3 0 1"), "line 13: ends where an index is expected"},
      {"text.ply", ply(three + face + "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"),
       "line 11: expected a number (y), found 'zero'"},
      {"nan.ply", ply(three + face + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), "face 0: vertex 1 is ("},
      {"cloud.ply", ply(three + "end_header\n" + points), "contains no faces"},
      {"flat.ply", ply(three + face + "0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"),
       "contains no triangle with a positive area"},
      {"binary.ply",
       "ply\nformat binary_little_endian 1.0\n" + three + face + std::string(36, '\0') + "\3abcd",
       "ends within face 0 of 1"},
      {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 9\n",
       "line 5: the face refers to vertex 9, but there are only 3"},
      {"zero.obj", "v 0 0 0\nf 0 1 2\n", "line 2: the face refers to vertex 0"},
      {"back.obj", "v 0 0 0\nf -1 -2 -3\n", "line 2: the face refers to vertex -2"},
      {"short.obj", "v 0 0\n", "line 1: ends where a coordinate is expected"},
      {"garbage.obj", std::string("\x00\xff\x80\n\x01", 5), "contains neither vertices nor faces"},
      {"not.off", "FOO\n3 1 0\n", "line 1: a supported OFF file"},
      {"binary.off", "OFF BINARY\n", "binary OFF is not supported"},
      {"huge.off", "OFF\n4000000000 1 0\n", "line 2: 4000000000 vertices and 1 faces are declared"},
      {"index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
       "line 6: the face has vertex 7, but there are 3 vertices"},
      {"not.stl", "hello", "is neither ASCII STL"},
      {"cut.stl", short_stl, "declares 9 triangles in binary STL, but is 84 bytes long"},
      {"word.stl", "solid\nfacet normal 0 0 1\nouter rope\n",
       "line 3: 'rope' is not an STL keyword"},
      {"open.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "ends within a facet"},
      {"garbage.drc", "no draco at all", "is not Draco data"},
      {"cut.drc", draco_pyramid().substr(0, 30), "is damaged or incomplete Draco data"},
      {"mesh.xyz", "0 0 0\n", "a mesh file must end in .ply, .obj, .stl, .off or .drc"},
  };
  for (const auto& [name, bytes, message] : cases) {
    EXPECT_THAT(error_message(name, bytes), HasSubstr(message)) << name;
  }
  EXPECT_THAT([&] { read_mesh(folder_.path() / "absent.ply"); },
              testing::ThrowsMessage<Error>(HasSubstr("does not exist")));
  std::filesystem::create_directory(folder_.path() / "folder.ply");
  EXPECT_THAT([&] { read_mesh(folder_.path() / "folder.ply"); },
              testing::ThrowsMessage<Error>(HasSubstr("is a directory")));
}

// For any bytes, the reader returns a usable mesh or throws Error. Another exception, a crash, a
// hang or a sanitiser report fails the test.
TEST_F(MeshIo, ReadsOrRejectsDamagedFiles) {
  std::mt19937_64 random(7);
  std::vector<std::pair<std::string, std::string>> originals{{"a.ply", std::string(ascii_ply)},
                                                             {"a.drc", draco_pyramid()}};
  for (const char* name : {"b.ply", "b.obj", "b.off", "b.stl"}) {
    write_mesh(folder_.path() / name, pyramid());
    std::ifstream file(folder_.path() / name, std::ios::binary);
    originals.emplace_back(name, std::string(std::istreambuf_iterator<char>(file), {}));
  }
  int read_anyway = 0;
  for (const auto& [name, original] : originals) {
    int rejected = 0;
    for (int trial = 0; trial < 300; ++trial) {
      std::string bytes = original;
      for (int i = 0; i < 3; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
      if (trial % 4 == 0) bytes.resize(random() % bytes.size());
      std::optional<Mesh> mesh;
      try {
        mesh = read(name, bytes);
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr(name));  // the message names the file
        ++rejected;
        continue;
      }
      EXPECT_NO_THROW(validate(*mesh)) << name << ", trial " << trial;
      ++read_anyway;
    }
    EXPECT_GT(rejected, 50) << name;  // truncated files
  }
  EXPECT_GT(read_anyway, 50);  // changed coordinates in binary files
}

TEST_F(MeshIo, RejectsUnknownExtensionAndUnwritablePath) {
  EXPECT_THAT([&] { write_mesh(folder_.path() / "mesh.doc", pyramid()); },
              testing::ThrowsMessage<Error>(HasSubstr("must end in .ply, .obj, .stl or .off")));
  write_mesh(folder_.path() / "file.ply", pyramid());
  EXPECT_THAT([&] { write_mesh(folder_.path() / "file.ply" / "mesh.ply", pyramid()); },
              testing::ThrowsMessage<Error>(HasSubstr("cannot be written")));
}

}  // namespace
}  // namespace skycap::geometry
