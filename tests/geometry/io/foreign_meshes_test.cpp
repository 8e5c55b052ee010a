// One box in the formats of other programs: each file contains the same 12 triangles.
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

/// 4 x 3 x 2, surface area 52.
const std::vector<std::array<double, 3>> vertices = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0},
                                                     {0, 0, 2}, {4, 0, 2}, {4, 3, 2}, {0, 3, 2}};
const std::vector<std::array<int, 4>> faces = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                               {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

std::string format_number(double number) { return std::to_string(static_cast<int>(number)); }

/// Returns one line for each vertex.
std::string vertex_lines(const std::string& before = "", const std::string& after = "",
                         const std::string& apart = " ") {
  std::string text;
  for (const auto& [x, y, z] : vertices) {
    text += before + format_number(x) + apart + format_number(y) + apart + format_number(z) +
            after + "\n";
  }
  return text;
}

/// Returns one line for each face, with indices from `first`.
std::string face_lines(const std::string& before, const std::string& after, int first,
                       const std::string& apart = " ") {
  std::string text;
  for (const auto& face : faces) {
    text += before;
    for (std::size_t i = 0; i < 4; ++i)
      text += (i == 0 ? "" : apart) + std::to_string(face[i] + first);
    text += after + "\n";
  }
  return text;
}

std::string replaced(std::string text, const std::string& old, const std::string& now) {
  for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at)) {
    text.replace(at, old.size(), now);
    at += now.size();
  }
  return text;
}

std::string obj_text() { return vertex_lines("v ") + face_lines("f ", "", 1); }
std::string off_text() { return "OFF\n8 6 0\n" + vertex_lines() + face_lines("4 ", "", 0); }

std::string ascii_stl() {
  std::string text = "solid box\n";
  for (const auto& face : faces) {
    for (const std::array<int, 3> corners : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      text += "facet normal 0 0 1\nouter loop\n";
      for (const int corner : corners) {
        const auto& [x, y, z] =
            vertices[static_cast<std::size_t>(face[static_cast<std::size_t>(corner)])];
        text +=
            "vertex " + format_number(x) + " " + format_number(y) + " " + format_number(z) + "\n";
      }
      text += "endloop\nendfacet\n";
    }
  }
  return text + "endsolid box\n";
}

std::string binary_stl(const std::string& header, std::uint32_t count, const std::string& tail) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  const auto append = [&](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(count);
  for (const auto& face : faces) {
    for (const std::array<int, 3> corners : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      for (int i = 0; i < 3; ++i) append(0.0F);
      for (const int corner : corners) {
        for (const double x :
             vertices[static_cast<std::size_t>(face[static_cast<std::size_t>(corner)])]) {
          append(static_cast<float>(x));
        }
      }
      append(std::uint16_t{0});
    }
  }
  return bytes + tail;
}

class ForeignMesh : public testing::Test {
 protected:
  void expect_box(const std::string& name, const std::string& bytes) {
    try {
      const Mesh mesh = read_mesh(folder_.file(name, bytes));
      EXPECT_EQ(mesh.triangles.size(), 12U) << bytes.substr(0, 60);
      EXPECT_NEAR(surface_area(mesh), 52.0, 1e-9) << bytes.substr(0, 60);
      EXPECT_EQ(bounding_box(mesh).sizes(), Vector3d(4, 3, 2)) << bytes.substr(0, 60);
    } catch (const Error& error) {
      ADD_FAILURE() << error.what() << "\n" << bytes.substr(0, 200);
    }
  }
  std::string error_message(const std::string& name, const std::string& bytes) {
    return testing_support::thrown_message([&] { read_mesh(folder_.file(name, bytes)); });
  }
  TemporaryFolder folder_;
};

TEST_F(ForeignMesh, ReadsOffWithCountsOnAnyLine) {
  expect_box("a.off", off_text());
  expect_box("a.off", "OFF8 6 0\n" + vertex_lines() + face_lines("4 ", "", 0));
  expect_box("a.off", "COFF8 6 0\n" + vertex_lines("", " 255 0 0 255") + face_lines("4 ", "", 0));
  expect_box("a.off", "NOFF8 6 0\n" + vertex_lines("", " 0 0 1") + face_lines("4 ", "", 0));
  expect_box("a.off", "OFF\n# made\n8\n6\n0\n\n" + vertex_lines() +
                          face_lines("4 ", " 0.5 0.5 0.5 # red", 0));
  const std::string all = off_text();
  expect_box("a.off", replaced(all, "\n", " "));  // free format, in one line
  expect_box("a.off", replaced(all, " ", "\n"));  // one number per line
  expect_box("a.off", "\xEF\xBB\xBF" + replaced(all, "\n", "\r"));
}

TEST_F(ForeignMesh, ReadsAllAsciiStlVariants) {
  const std::string stl = ascii_stl();
  std::string upper = stl;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const std::string half = stl.substr(stl.find("facet"));
  for (const std::string& text :
       {stl, upper, " \n" + stl, "\xEF\xBB\xBF" + stl, replaced(stl, "\n", "\r"),
        replaced(stl, "\n", "\r\n"), replaced(stl, "endloop", "end loop"),
        replaced(stl, "outer", "color 0.5 0.5 0.5\nouter"),
        "solid empty\nendsolid empty\n" + upper}) {
    expect_box("a.stl", text);
  }
}

TEST_F(ForeignMesh, ReadsBinaryStlByFileLengthWhenCountIsUnknown) {
  constexpr std::uint32_t unknown = std::numeric_limits<std::uint32_t>::max();
  for (const char* header : {"exported", "solid box"}) {
    expect_box("a.stl", binary_stl(header, 12, ""));
    expect_box("a.stl", binary_stl(header, 12, "ab"));
    expect_box("a.stl", binary_stl(header, 0, ""));
    expect_box("a.stl", binary_stl(header, unknown, ""));
    expect_box("a.stl", binary_stl(header, unknown, "ab"));
  }
  EXPECT_THAT(error_message("a.stl", binary_stl("solid box", 13, "")),
              HasSubstr("declares 13 triangles in binary STL"));
}

TEST_F(ForeignMesh, NamesMaterialsByWholeLine) {
  std::string text = vertex_lines("v ");
  const std::string lines = face_lines("f ", "", 1);
  text += "usemtl Curtain Wall Panel\n" + lines.substr(0, lines.find('\n') + 1);
  text += "usemtl Curtain Wall Glass \t# clear\r\n" + lines.substr(lines.find('\n') + 1);
  text += "usemtl Glass #2\nf 1 2 3\n";
  std::vector<std::string> names;
  for (const MaterialMesh& part : read_mesh_by_material(folder_.file("a.obj", text))) {
    names.push_back(part.material);
  }
  EXPECT_THAT(names, ElementsAre("Curtain Wall Panel", "Curtain Wall Glass", "Glass #2"));
}

// No face uses the first of the nine vertices. If a line were lost, the solid would differ.
TEST_F(ForeignMesh, ReadsObjWithByteOrderMarksAndAnyLineEnds) {
  const std::string unused = vertex_lines("v ") + "v 9 9 9\n" + face_lines("f ", "", 1);
  expect_box("a.obj", "\xEF\xBB\xBF" + unused);
  expect_box("a.obj", replaced(unused, "\n", "\r"));
  expect_box("a.obj", replaced(unused, "\n", "\r\n"));
  std::string wide = "\xFF\xFE";
  for (const char c : unused) wide += std::string{c, '\0'};
  expect_box("a.obj", wide);
}

TEST_F(ForeignMesh, ReadsObjOfCadPrograms) {
  const std::string v = vertex_lines("v ");
  expect_box("a.obj", v + replaced(face_lines("f ", "", 1, "|"), "|", " \\\n "));
  expect_box("a.obj", v + replaced(face_lines("f ", "", 1, "|"), "|", "\\\r\n "));
  expect_box("a.obj", v + face_lines("f ", " # side", 1));
  expect_box("a.obj", v + face_lines("fo ", "", 1));
  expect_box("a.obj", vertex_lines("V ") + face_lines("F ", "", 1));
  expect_box("a.obj", vertex_lines("v ", "", "\\\n ") + face_lines("f\t", "", 1, "//1\t"));
  std::string open_end = v + face_lines("f ", "", -8);
  open_end.back() = '\\';
  expect_box("a.obj", open_end);
  EXPECT_THAT(error_message("a.obj", replaced(v, " 4", " 4,0")),
              HasSubstr("line 2: '4,0' has a decimal comma"));
  EXPECT_THAT(error_message("a.obj", v + "surf 0 1 0 1 1 2 3 4\n"),
              HasSubstr("line 9: free-form surfaces (surf) are not supported"));
  EXPECT_THAT(error_message("a.obj", "call other.obj\n"), HasSubstr("includes another file"));
}

std::string ply_header(const std::string& format, const std::string& face) {
  return "ply\nformat " + format +
         " 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n" + face +
         "end_header\n";
}

TEST_F(ForeignMesh, ReadsPlyWithListsOfOtherNamesAndTypes) {
  const std::string body = vertex_lines() + face_lines("4 ", "", 0);
  for (const char* list : {"uchar int vertex_indices", "uchar int vertex_indexes",
                           "uchar float vertex_indices", "int uint corners"}) {
    const std::string text =
        ply_header("ascii", "element face 6\nproperty list " + std::string(list) + "\n") + body;
    expect_box("a.ply", text);
    expect_box("a.ply", replaced(text, "\n", "\r"));
    expect_box("a.ply", "\xEF\xBB\xBF" + text);
  }
  EXPECT_THAT(error_message("a.ply", ply_header("ascii",
                                                "element face 6\nproperty list uchar int a\n"
                                                "property list uchar int b\n") +
                                         body),
              HasSubstr("has the lists a, b; the list of corners must be named vertex_indices"));
  EXPECT_THAT(error_message("a.ply", ply_header("ascii",
                                                "element face 1\nproperty list uchar float "
                                                "vertex_indices\n") +
                                         vertex_lines() + "3 0 1 1.5\n"),
              HasSubstr("face has a list with 1.5"));
}

TEST_F(ForeignMesh, ReadsTriangleStrips) {
  const std::vector<std::int64_t> strips = {0, 1, 4, 5, -1, 1, 2, 5, 6, -1, 2, 3, 6, 7, -1,
                                            3, 0, 7, 4, -1, 4, 5, 7, 6, -1, 0, 3, 1, 2};
  std::string ascii =
      ply_header("ascii", "element tristrips 1\nproperty list int int vertex_indices\n") +
      vertex_lines() + std::to_string(strips.size());
  std::string binary = ply_header("binary_little_endian",
                                  "element tristrips 1\nproperty list uchar uint vertex_indices\n");
  const auto append = [&](auto value) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const auto& vertex : vertices) {
    for (const double x : vertex) append(static_cast<float>(x));
  }
  append(static_cast<std::uint8_t>(strips.size()));
  for (const std::int64_t index : strips) {
    ascii += " " + std::to_string(index);
    append(static_cast<std::uint32_t>(index));
  }
  expect_box("a.ply", ascii);
  expect_box("a.ply", binary);
  // All triangles of a strip have the same orientation.
  const Mesh mesh = read_mesh(folder_.file("a.ply", ascii));
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6.0;
  }
  EXPECT_NEAR(std::abs(volume), 24.0, 1e-9);
}

TEST_F(ForeignMesh, SkipsFacesThatAreNotFiniteWhenNotesAreEnabled) {
  for (const auto& [name, text] : std::initializer_list<std::pair<const char*, std::string>>{
           {"a.obj", replaced(obj_text(), "v 4 3 2", "v nan 3 2")},
           {"a.off", replaced(off_text(), "4 3 2\n0 3 2", "1.#QNAN 3 2\n0 3 2")},
           {"a.ply",
            ply_header("ascii", "element face 6\nproperty list uchar int vertex_indices\n") +
                replaced(vertex_lines(), "4 3 2", "4 inf 2") + face_lines("4 ", "", 0)}}) {
    std::vector<std::string> notes;
    MeshOptions options;
    options.note = [&](const std::string& note) { notes.push_back(note); };
    const Mesh mesh = read_mesh(folder_.file(name, text), options);
    EXPECT_EQ(mesh.triangles.size(), 6U) << name;
    EXPECT_NEAR(surface_area(mesh), 26.0, 1e-9) << name;
    EXPECT_THAT(notes, ElementsAre(HasSubstr("3 faces skipped"))) << name;
    EXPECT_THAT(error_message(name, text), HasSubstr("coordinates must be finite")) << name;
  }
}

}  // namespace
}  // namespace skycap::geometry
