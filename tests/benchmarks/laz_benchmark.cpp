// Speed and size of written LAZ files: laz_benchmark [FILE ...] [--points N]. The points of each
// file, or N simulated points, are compressed on one core and read back. The CPU times exclude the
// files.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/las/las_conversion.h"
#include "geometry/io/las/las_file_writer.h"
#include "geometry/io/las/layout.h"
#include "tests/benchmarks/processor_time.h"

namespace {

namespace fs = std::filesystem;
namespace las = skycap::geometry::las;
using skycap::geometry::LasFields;
using skycap::geometry::LasReader;
using skycap::geometry::put_value;

struct Points {
  int format = 6;
  std::size_t size = 30;
  std::string records;

  std::size_t count() const { return records.size() / size; }
};

/// Points of a scanner with 16 channels that flies along a facade.
Points simulate(std::size_t count) {
  Points points;
  points.records.assign(count * points.size, '\0');
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (std::size_t i = 0; i < count; ++i) {
    char* const to = points.records.data() + i * points.size;
    const double time = static_cast<double>(i / 16) * 55.3e-6, turn = 20.0 * time;
    const double azimuth = 2.0 * std::numbers::pi * (turn - std::floor(turn));
    const double elevation = (static_cast<double>(i % 16) - 7.5) / 30.0;
    const double range = 20.0 / std::max(0.2, std::abs(std::cos(azimuth))) + noise(random);
    const auto put = [&](std::size_t offset, double metres) {
      put_value(to, offset, static_cast<std::int32_t>(std::lround(1e4 * metres)));
    };
    put(0, range * std::cos(azimuth));
    put(4, range * std::sin(azimuth) + 3.0 * time);
    put(8, range * std::tan(elevation) + 15.0);
    put_value(to, las::point::intensity,
              static_cast<std::uint16_t>(20000.0 * std::abs(std::cos(azimuth)) +
                                         1e5 * std::abs(noise(random))));
    to[las::point::returns] = 0x11;
    to[las::point::user_data] = static_cast<char>(i % 16);
    put_value(to, las::point::scan_angle,
              static_cast<std::int16_t>((azimuth - std::numbers::pi) * 9549.0));
    put_value(to, las::point::source, std::uint16_t{1});
    put_value(to, las::point::time, time);
  }
  return points;
}

Points read_points(const fs::path& path) {
  LasReader reader(path, LasFields::all);
  const las::PointUpgrade upgrade(reader.header());
  Points points;
  points.format = upgrade.format();
  points.size = std::size_t{las::point_size(points.format)} + upgrade.extra_bytes();
  std::string records, upgraded;
  while (reader.next_records(records)) {
    upgrade.convert(records, upgraded);
    points.records += upgraded;
  }
  return points;
}

std::string compress(const Points& points) {
  const auto encoder = las::make_chunk_encoder(points.format, points.size);
  std::string bytes;
  for (std::size_t begin = 0; begin < points.records.size(); begin += points.size) {
    encoder->add(points.records.data() + begin);
    if (encoder->points() == las::chunk_points) bytes += encoder->finish();
  }
  return bytes + encoder->finish();
}

double read_time(const fs::path& path, LasFields fields) {
  const double start = seconds_on(CLOCK_THREAD_CPUTIME_ID);
  LasReader reader(path, fields);
  std::string records;
  while (reader.next_records(records)) {
  }
  return seconds_on(CLOCK_THREAD_CPUTIME_ID) - start;
}

void measure(const std::string& name, const Points& points, std::uintmax_t original_bytes) {
  const double start = seconds_on(CLOCK_THREAD_CPUTIME_ID);
  const std::string compressed = compress(points);
  const double write = seconds_on(CLOCK_THREAD_CPUTIME_ID) - start;
  const fs::path path = fs::temp_directory_path() / "skycap_laz_benchmark.laz";
  las::WrittenFile file;
  file.point_format = points.format;
  file.extra_bytes = static_cast<std::uint16_t>(points.size - las::point_size(points.format));
  file.is_compressed = true;
  las::LasFileWriter writer(path, file);
  writer.add(points.records);
  writer.finish();
  const double all = read_time(path, LasFields::all), needed = read_time(path, LasFields::needed);
  const auto count = static_cast<double>(points.count());
  std::printf("%s: %.0f points of format %d\n", name.c_str(), count, points.format);
  std::printf("  write      %.2f M points/s\n", 1e-6 * count / write);
  std::printf("  read       %.2f M points/s with all fields, %.2f M points/s without\n",
              1e-6 * count / all, 1e-6 * count / needed);
  std::printf("  write/read %.2f times the time of the reader with all fields\n", write / all);
  const auto bytes = static_cast<double>(fs::file_size(path));
  std::printf("  size       %.2f bytes per point, %.1f%% of LAS", bytes / count,
              100.0 * bytes / static_cast<double>(points.records.size()));
  if (original_bytes > 0) {
    std::printf(", %.1f%% of the file", 100.0 * bytes / static_cast<double>(original_bytes));
  }
  std::printf("\n");
  fs::remove(path);
}

}  // namespace

int main(int count, char** arguments) {
  try {
    std::size_t points = 2'000'000;
    std::vector<std::string> files;
    for (int i = 1; i < count; ++i) {
      if (std::strcmp(arguments[i], "--points") == 0 && i + 1 < count) {
        points = std::strtoull(arguments[++i], nullptr, 10);
      } else {
        files.emplace_back(arguments[i]);
      }
    }
    for (const std::string& file : files) measure(file, read_points(file), fs::file_size(file));
    if (files.empty()) measure("simulated scan", simulate(points), 0);
    return 0;
  } catch (const skycap::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
