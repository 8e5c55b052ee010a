/// Common parts of the E57 tests.
#pragma once

#include <array>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/e57_reader.h"
#include "tests/support/e57_bytes.h"
#include "tests/support/temporary_folder.h"

namespace skycap::testing_support {

using E57Triples = std::vector<std::array<double, 3>>;

inline const E57Triples three_points{{1.0, 2.0, 3.0}, {-4.5, 1e-3, 6.0}, {0.1, 0.2, 1e4}};

class E57 : public testing::Test {
 protected:
  struct Read {
    std::vector<Eigen::Vector3d> positions;
    std::vector<Eigen::Vector3f> normals;
    std::vector<std::array<std::uint8_t, 3>> colours;
    std::vector<std::uint32_t> scans;
  };
  Read read(const std::string& bytes, std::size_t max = 1 << 16) const {
    geometry::E57Reader reader(folder_.file("a.e57", bytes));
    Read all;
    geometry::E57Points points;
    while (reader.next(points, max)) {
      all.positions.insert(all.positions.end(), points.positions.begin(), points.positions.end());
      all.normals.insert(all.normals.end(), points.normals.begin(), points.normals.end());
      all.colours.insert(all.colours.end(), points.colours.begin(), points.colours.end());
      all.scans.resize(all.positions.size(), points.scan);
    }
    return all;
  }
  /// Returns the error message; empty if the file is read.
  std::string rejection(const std::string& bytes) const {
    try {
      read(bytes);
      return {};
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_EQ(error.kind(), ErrorKind::bad_file);
      EXPECT_THAT(message, testing::HasSubstr("a.e57: "));
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      return message;
    }
  }
  const TemporaryFolder folder_;
};

/// Returns the XML of a pose with the rotation (w x y z) and the translation (x y z).
inline std::string make_pose(const std::string& rotation, const std::string& translation) {
  const auto numbers = [](const char* names, const std::string& text) {
    std::string xml;
    std::istringstream stream(text);
    std::string number;
    for (const char* name = names; stream >> number; ++name) {
      // Elements with the value zero may be empty.
      xml += std::string("<") + *name + " type=\"Float\">" + (number == "0" ? "" : number) + "</" +
             *name + ">";
    }
    return xml;
  };
  std::string xml = "<pose type=\"Structure\">";
  if (!rotation.empty()) {
    xml += "<rotation type=\"Structure\">" + numbers("wxyz", rotation) + "</rotation>";
  }
  if (!translation.empty()) {
    xml += "<translation type=\"Structure\">" + numbers("xyz", translation) + "</translation>";
  }
  return xml + "</pose>";
}

}  // namespace skycap::testing_support
