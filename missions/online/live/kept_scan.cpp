#include "missions/online/live/kept_scan.h"

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/text/ply.h"
#include "missions/support/sha256.h"

namespace skycap::missions::online {

std::string kept_scan(const geometry::Scan& scan) {
  const bool is_organised = !scan.pixels.empty();
  geometry::PlyElement vertex{"vertex", scan.points.size(), {}};
  vertex.add(geometry::PlyType::float32, {"x", "y", "z"});
  if (is_organised) vertex.add(geometry::PlyType::uint32, {"pixel"});
  // No comment line in the header: the bytes are part of a scan's identity in journals.
  std::string bytes = geometry::ply_header({&vertex, 1}, "");
  constexpr std::size_t largest_point = 16;  // [bytes]
  bytes.reserve(bytes.size() + largest_point * scan.points.size());
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    geometry::append_value(bytes, scan.points[i]);
    if (is_organised) geometry::append_value(bytes, scan.pixels[i]);
  }
  return bytes;
}

geometry::Scan parse_kept_scan(std::string_view name, std::string_view bytes) {
  geometry::PlyReader reader(name, bytes);
  constexpr std::array<std::string_view, 4> keys{"x", "y", "z", "pixel"};
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::bad_file, std::string(name) + ": " + what);
  };
  if (reader.elements().size() != 1) fail("is not a scan file of a survey");
  const geometry::PlyTable table = reader.read_element(keys);
  const std::vector<double>&x = table.columns[0], &y = table.columns[1], &z = table.columns[2],
        &pixels = table.columns[3];
  if (y.size() != x.size() || z.size() != x.size() ||
      (!pixels.empty() && pixels.size() != x.size())) {
    fail("is not a scan file of a survey");
  }
  geometry::Scan scan;
  scan.points.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    scan.points.push_back(Eigen::Vector3d(x[i], y[i], z[i]).cast<float>());
  }
  for (const double pixel : pixels) {
    if (!(pixel >= 0.0 && pixel <= std::numeric_limits<std::uint32_t>::max())) {
      fail("has an invalid pixel index");
    }
    scan.pixels.push_back(static_cast<std::uint32_t>(pixel));
  }
  return scan;
}

std::string compute_checksum(std::string_view bytes) {
  return support::sha256(std::as_bytes(std::span(bytes)));
}

geometry::Scan read_kept_scan(const std::filesystem::path& file, const std::string& sha256) {
  constexpr std::size_t largest = std::size_t{384} << 20;  // [bytes]
  const std::string bytes = geometry::read_file(file, largest);
  if (compute_checksum(bytes) != sha256) {
    throw Error(ErrorKind::bad_file,
                file.string() +
                    ": is damaged (checksum differs from the journal); restore it from a backup");
  }
  return parse_kept_scan(file.string(), bytes);
}

}  // namespace skycap::missions::online
