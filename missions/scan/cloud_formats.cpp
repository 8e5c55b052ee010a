#include "missions/scan/cloud_formats.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/text/ply.h"
#include "missions/scan/las_format.h"

namespace skycap::missions::scan {
namespace {

using geometry::put_value;

CloudTotals compute_totals(const sim::LidarReturns& returns) {
  CloudTotals totals;  // Data for the headers of these formats.
  totals.points = returns.size();
  return totals;
}

std::vector<std::uint8_t> to_bytes(const std::string& text) { return {text.begin(), text.end()}; }

/// Common part of PLY and PCD, which differ only in their headers.
class RecordFormat : public CloudFormat {
 public:
  void encode(const sim::LidarReturns& returns, ReturnPosition position,
              CloudChunk& chunk) const override {
    constexpr std::size_t size = 28;
    chunk.totals = compute_totals(returns);
    chunk.bytes.resize(returns.size() * size);
    const auto& points = select_positions(returns, position);
    std::uint8_t* out = chunk.bytes.data();
    double farthest = 0.0;
    for (std::size_t i = 0; i < returns.size(); ++i, out += size) {
      const Eigen::Vector3d point = returns.origin + points[i].cast<double>();
      farthest = std::max(farthest, point.cwiseAbs().maxCoeff());
      for (int axis = 0; axis < 3; ++axis)
        put_value(out, 4UL * axis, static_cast<float>(point[axis]));
      put_value(out, 12, returns.intensities[i]);
      put_value(out, 16, returns.times[i]);
      put_value(out, 24, returns.channels[i]);
      out[26] = returns.return_numbers[i];
      out[27] = returns.number_of_returns[i];
    }
    if (farthest > geometry::farthest_single_coordinate) {
      throw Error(ErrorKind::bad_geometry,
                  "a point is " + std::to_string(farthest) +
                      " m from the origin, too far for single precision; write LAS or xyz");
    }
  }
};

class PlyFormat final : public RecordFormat {
 public:
  std::vector<std::uint8_t> header(const CloudState& grown) const override {
    using geometry::PlyType;
    geometry::PlyElement vertex{"vertex", grown.totals.points, {}};
    vertex.add(PlyType::float32, {"x", "y", "z", "intensity"});
    vertex.add(PlyType::float64, {"time"});
    vertex.add(PlyType::uint16, {"channel"});
    vertex.add(PlyType::uint8, {"return_number", "returns"});
    return to_bytes(geometry::growing_ply_header(vertex));
  }
};

class PcdFormat final : public RecordFormat {
 public:
  std::vector<std::uint8_t> header(const CloudState& grown) const override {
    const std::string count = std::to_string(grown.totals.points);
    return to_bytes("# .PCD v0.7 - Point Cloud Data file format, written by Skycap" +
                    std::string(2 * (20 - count.size()), ' ') +
                    "\nVERSION 0.7\nFIELDS x y z intensity time channel return_number returns\n"
                    "SIZE 4 4 4 4 8 2 1 1\nTYPE F F F F F U U U\nCOUNT 1 1 1 1 1 1 1 1\n"
                    "WIDTH " +
                    count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count +
                    "\nDATA binary\n");
  }
};

class XyzFormat final : public CloudFormat {
 public:
  std::vector<std::uint8_t> header(const CloudState&) const override {
    return to_bytes("# x y z intensity time channel return_number returns\n");
  }

  void encode(const sim::LidarReturns& returns, ReturnPosition position,
              CloudChunk& chunk) const override {
    constexpr std::size_t longest_line = 200;  // Eight numbers below 1e15.
    chunk.totals = compute_totals(returns);
    chunk.bytes.resize(returns.size() * longest_line);
    const auto& points = select_positions(returns, position);
    char* const begin = reinterpret_cast<char*>(chunk.bytes.data());
    char* out = begin;
    const auto put = [&](double number, int decimals) {
      out = std::to_chars(out, out + 24, number, std::chars_format::fixed, decimals).ptr;
      *out++ = ' ';
    };
    const auto put_whole = [&](unsigned number, char end) {
      out = std::to_chars(out, out + 8, number).ptr;
      *out++ = end;
    };
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const Eigen::Vector3d point = returns.origin + points[i].cast<double>();
      for (int axis = 0; axis < 3; ++axis) put(point[axis], 4);
      put(static_cast<double>(returns.intensities[i]), 4);
      put(returns.times[i], 7);
      put_whole(returns.channels[i], ' ');
      put_whole(returns.return_numbers[i], ' ');
      put_whole(returns.number_of_returns[i], '\n');
    }
    chunk.bytes.resize(static_cast<std::size_t>(out - begin));
  }
};

CoordinateGrid make_grid(const CloudFormatContext& context) {
  CoordinateGrid grid;
  Eigen::Vector3d centre = context.scene_centre;
  if (context.projection != nullptr) {
    grid.projection = context.projection;
    grid.crs_wkt = context.projection->wkt();
    centre = context.projection->to_map(centre);
  }
  // Rounded to whole kilometres, so that local scenes have a zero offset.
  grid.offset = 1000.0 * (centre / 1000.0).array().round().matrix();
  return grid;
}

const std::array<CloudFormatInfo, 8>& formats() {
  using Context = CloudFormatContext;
  static const std::array<CloudFormatInfo, 8> all = {{
      {"las", ".las",
       [](const Context& context) {
         return las_format({6, false, make_grid(context)});
       }},
      {"las7", ".las",
       [](const Context& context) {
         return las_format({7, false, make_grid(context)});
       }},
      {"laz", ".laz",
       [](const Context& context) {
         return las_format({6, true, make_grid(context)});
       }},
      {"e57", ".e57",
       [](const Context& context) { return e57_format(make_grid(context), context.sensor_name); }},
      {"ply", ".ply", [](const Context&) { return ply_format(); }},
      {"pcd", ".pcd", [](const Context&) { return pcd_format(); }},
      {"xyz", ".xyz", [](const Context&) { return xyz_format(); }},
      {"rawlog", ".rawlog", rawlog_format},
  }};
  return all;
}

}  // namespace

std::shared_ptr<const CloudFormat> ply_format() { return std::make_shared<PlyFormat>(); }
std::shared_ptr<const CloudFormat> pcd_format() { return std::make_shared<PcdFormat>(); }
std::shared_ptr<const CloudFormat> xyz_format() { return std::make_shared<XyzFormat>(); }

const CloudFormatInfo& cloud_format_named(const std::string& name) {
  for (const CloudFormatInfo& format : formats()) {
    if (format.name == name) return format;
  }
  throw Error(ErrorKind::bad_usage,
              "unknown point format '" + name + "'; expected one of: " + cloud_format_names());
}

std::string cloud_format_names() {
  std::string names;
  for (const CloudFormatInfo& format : formats())
    names += (names.empty() ? "" : ", ") + format.name;
  return names;
}

}  // namespace skycap::missions::scan
