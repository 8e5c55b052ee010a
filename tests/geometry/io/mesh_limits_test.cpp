// Size limits of mesh files. The tests set small limits, so that small files exceed them.
#include <array>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/mesh_formats.h"

namespace skycap::geometry {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

using Parse = PolygonSoup(std::string_view, std::string_view, const MeshLimits&);

/// Two triangles with three vertices each.
struct TwoTriangles {
  const char* name;
  Parse* parse;
  std::string bytes;
};

std::string binary_stl(std::uint32_t triangles) {
  std::string bytes(84 + 50 * std::size_t{triangles}, '\0');
  std::memcpy(&bytes[80], &triangles, sizeof(triangles));
  return bytes;
}

std::vector<TwoTriangles> all_formats() {
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 1\n0 1 1\n";
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\n";
  return {{"a.ply", parse_ply,
           "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty "
           "float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n" +
               vertices + "3 0 1 2\n3 3 4 5\n"},
          {"a.obj", parse_obj,
           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\nf 4 5 6\n"},
          {"a.off", parse_off, "OFF\n6 2 0\n" + vertices + "3 0 1 2\n3 3 4 5\n"},
          {"ascii.stl", parse_stl, "solid\n" + facet + facet + "endsolid\n"},
          {"binary.stl", parse_stl, binary_stl(2)}};
}

TEST(MeshLimits, AcceptFilesAtTheLimit) {
  const MeshLimits limits{
      .faces = 2, .vertices = 6, .corners = 6, .face_corners = 3, .materials = 0};
  for (const TwoTriangles& file : all_formats()) {
    const PolygonSoup soup = file.parse(file.name, file.bytes, limits);
    EXPECT_EQ(soup.vertices.size(), 6U) << file.name;
    EXPECT_THAT(soup.corners, testing::ElementsAre(0, 1, 2, 3, 4, 5)) << file.name;
    EXPECT_THAT(soup.polygon_begin, testing::ElementsAre(0, 3, 6)) << file.name;
  }
}

TEST(MeshLimits, RejectFilesBeyondTheLimit) {
  const struct Case {
    MeshLimits limits;
    const char* message;
  } cases[] = {
      {{.faces = 1}, ": contains more than 1 faces, "},
      {{.vertices = 5}, " corners of faces or 5 vertices; simplify the mesh"},
      {{.corners = 5}, " faces, 5 corners of faces or "},
      {{.face_corners = 2}, ": face 0 has more than 2 corners; triangulate it first"},
  };
  for (const Case& wrong : cases) {
    for (const TwoTriangles& file : all_formats()) {
      EXPECT_THAT(
          [&] { file.parse(file.name, file.bytes, wrong.limits); },
          ThrowsMessage<Error>(testing::AllOf(HasSubstr(file.name), HasSubstr(wrong.message))));
    }
  }
}

TEST(MeshLimits, LimitNumberOfMaterials) {
  const std::string two = "usemtl a\nusemtl b\nusemtl a\n";
  EXPECT_THAT(parse_obj("a.obj", two, {.materials = 2}).materials, testing::ElementsAre("a", "b"));
  EXPECT_THAT([&] { parse_obj("a.obj", two, {.materials = 1}); },
              ThrowsMessage<Error>(HasSubstr("a.obj: line 2: names more than 1 materials")));
}

/// A list is rejected by its declared length, before its elements are read.
TEST(MeshLimits, RejectPlyFaceWithTooManyCorners) {
  const std::uint32_t corners = 1'000'001;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uint uchar vertex_indices\nend_header\n" +
      std::string(12, '\0');
  bytes.append(reinterpret_cast<const char*>(&corners), sizeof(corners));
  bytes.resize(bytes.size() + corners);
  EXPECT_THAT([&] { parse_ply("a.ply", bytes); },
              ThrowsMessage<Error>(HasSubstr(
                  "a.ply: face 0 has a list of 1000001 values; the maximum is 1 million")));
}

/// Property: a file that is read in chunks has no errors at chunk boundaries.
TEST(MeshLimits, KeepLargePlyComplete) {
  constexpr std::uint32_t vertices = 1'000'003, faces = 400'000;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(faces) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (std::uint32_t i = 0; i < vertices; ++i) append(Eigen::Vector3f(static_cast<float>(i), 1, 2));
  for (std::uint32_t i = 0; i < faces; ++i) {
    append(std::uint8_t{3});
    append(std::array{i, vertices - 1 - i, 2 * i});
  }
  const PolygonSoup soup = parse_ply("a.ply", bytes);
  ASSERT_EQ(soup.vertices.size(), vertices);
  ASSERT_EQ(soup.corners.size(), 3 * faces);
  ASSERT_EQ(soup.polygon_begin.size(), faces + 1);
  for (std::uint32_t i = 0; i < vertices; ++i) ASSERT_EQ(soup.vertices[i].x(), i);
  for (std::uint32_t i = 0; i < faces; ++i) {
    ASSERT_EQ(soup.polygon_begin[i], 3 * i);
    ASSERT_EQ(soup.corners[3 * i], i);
    ASSERT_EQ(soup.corners[3 * i + 1], vertices - 1 - i);
    ASSERT_EQ(soup.corners[3 * i + 2], 2 * i);
  }
}

}  // namespace
}  // namespace skycap::geometry
