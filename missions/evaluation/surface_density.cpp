#include "missions/evaluation/surface_density.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "flight/export/utm.h"
#include "geometry/error.h"
#include "geometry/parallel.h"

namespace skycap::missions::evaluation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double max_samples = 1e6;
constexpr std::uint64_t samples_seed = 3;  ///< Differs from the seed of the coverage samples.

/// Returns the class of a normal. Surfaces steeper than 45 degrees are walls.
SurfaceClass read_class(const Vector3f& normal) {
  constexpr float level = 0.70710678F;
  if (std::abs(normal.z()) <= level) return SurfaceClass::wall;
  return normal.z() > 0.0F ? SurfaceClass::roof : SurfaceClass::underside;
}

using Triangle = std::array<Vector3d, 3>;

Triangle triangle_corners(const geometry::Mesh& mesh, const std::array<std::uint32_t, 3>& indices) {
  return {mesh.vertices[indices[0]], mesh.vertices[indices[1]], mesh.vertices[indices[2]]};
}

/// Returns a vector along the normal of the triangle. Its length is twice the area.
Vector3d triangle_area_vector(const geometry::Mesh& mesh,
                              const std::array<std::uint32_t, 3>& indices) {
  const Triangle corners = triangle_corners(mesh, indices);
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]);
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Returns the signed area of the intersection of a disc around the origin and the triangle of the
/// origin, `from` and `to`.
double signed_area_within(const Vector2d& from, const Vector2d& to, double radius) {
  const auto sector = [&](const Vector2d& a, const Vector2d& b) {
    return 0.5 * radius * radius * std::atan2(cross(a, b), a.dot(b));
  };
  const Vector2d edge = to - from;
  const double a = edge.squaredNorm(), b = from.dot(edge), c = from.squaredNorm() - radius * radius,
               discriminant = b * b - a * c;
  if (!(discriminant > 0.0)) return sector(from, to);
  // The edge is inside the disc between these two fractions of its length.
  const double root = std::sqrt(discriminant);
  const double first = std::max(0.0, (-b - root) / a), last = std::min(1.0, (-b + root) / a);
  if (first >= last) return sector(from, to);
  const Vector2d enters = from + first * edge, leaves = from + last * edge;
  return sector(from, enters) + 0.5 * cross(enters, leaves) + sector(leaves, to);
}

/// Returns the area of the triangle within `radius` of `centre`: the intersection of the triangle
/// and a disc in its plane [m^2].
double area_within(const Triangle& triangle, const Vector3d& centre, double radius) {
  const Vector3d edge = triangle[1] - triangle[0], normal = edge.cross(triangle[2] - triangle[0]);
  const double doubled_area = normal.norm();
  if (!(doubled_area > 0.0)) return 0.0;
  const bool is_inside = std::ranges::all_of(triangle, [&](const Vector3d& corner) {
    return (corner - centre).squaredNorm() <= radius * radius;
  });
  if (is_inside) return 0.5 * doubled_area;
  const double height = (centre - triangle[0]).dot(normal) / doubled_area,
               squared = radius * radius - height * height;
  if (!(squared > 0.0)) return 0.0;
  const Vector3d x = edge.normalized(), y = normal.cross(x) / doubled_area;
  std::array<Vector2d, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = {(triangle[i] - centre).dot(x), (triangle[i] - centre).dot(y)};
  }
  double area = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    area += signed_area_within(corners[i], corners[(i + 1) % 3], std::sqrt(squared));
  }
  return std::max(0.0, area);
}

geometry::SurfaceSamples spread(const geometry::Mesh& mesh, double spacing,
                                double& area_per_point) {
  const double area = geometry::surface_area(mesh);
  const double count = std::clamp(std::ceil(area / (spacing * spacing)), 1.0, max_samples);
  area_per_point = area / count;
  return geometry::sample_surface(mesh, static_cast<std::size_t>(count), samples_seed);
}

DensityFigures compute_figures(std::vector<std::pair<double, double>> densities_and_areas,
                               double asked) {
  DensityFigures figures;
  std::ranges::sort(densities_and_areas);
  for (const auto& [density, area] : densities_and_areas) figures.area += area;
  double below = 0.0;
  bool has_twentieth = false, has_half = false;
  for (const auto& [density, area] : densities_and_areas) {
    figures.mean += density * area / figures.area;
    if (density >= asked) figures.share += area / figures.area;
    const auto bin = std::ranges::upper_bound(density_bins, density) - density_bins.begin() - 1;
    figures.histogram[static_cast<std::size_t>(bin)] += area / figures.area;
    below += area / figures.area;
    if (!std::exchange(has_twentieth, has_twentieth || below >= 0.05) && has_twentieth) {
      figures.percentile_5 = density;
    }
    if (!std::exchange(has_half, has_half || below >= 0.5) && has_half) figures.median = density;
  }
  return figures;
}

/// Little-endian bytes of a TIFF file with one image file directory.
class Tiff {
 public:
  enum Type : std::uint16_t { ascii = 2, u16 = 3, u32 = 4, f64 = 12 };

  template <typename Number>
  void add(std::uint16_t tag, Type type, const std::vector<Number>& values) {
    std::string bytes;
    for (const Number value : values) append(bytes, value);
    entries_.push_back({tag, type, static_cast<std::uint32_t>(values.size()), std::move(bytes)});
  }

  /// Returns the file: directory, values that do not fit into it, and `image`.
  std::string bytes(std::uint16_t strip_offset_tag, const std::string& image) {
    constexpr std::uint32_t head = 8, entry_size = 12;
    add<std::uint32_t>(strip_offset_tag, u32, {0});
    std::ranges::sort(entries_, {}, &Entry::tag);
    const auto count = static_cast<std::uint32_t>(entries_.size());
    const std::uint32_t begin = head + 2 + entry_size * count + 4;
    std::uint32_t extra = 0;
    for (const Entry& entry : entries_) {
      if (entry.bytes.size() > 4) extra += static_cast<std::uint32_t>(entry.bytes.size());
    }
    std::string file = "II*";
    file.push_back('\0');
    append(file, head);
    append(file, static_cast<std::uint16_t>(count));
    std::uint32_t offset = begin;
    std::string rest;
    for (Entry& entry : entries_) {
      if (entry.tag == strip_offset_tag) {
        entry.bytes.clear();
        append(entry.bytes, begin + extra);
      }
      append(file, entry.tag);
      append(file, static_cast<std::uint16_t>(entry.type));
      append(file, entry.count);
      if (entry.bytes.size() > 4) {
        append(file, offset);
        offset += static_cast<std::uint32_t>(entry.bytes.size());
        rest += entry.bytes;
      } else {
        entry.bytes.resize(4, '\0');
        file += entry.bytes;
      }
    }
    append(file, std::uint32_t{0});
    return file + rest + image;
  }

  template <typename Number>
  static void append(std::string& bytes, Number value) {
    static_assert(std::endian::native == std::endian::little);
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), &value, sizeof(Number));
    bytes.append(raw.data(), raw.size());
  }

 private:
  struct Entry {
    std::uint16_t tag;
    Type type;
    std::uint32_t count;
    std::string bytes;
  };
  std::vector<Entry> entries_;
};

/// Returns the matrix from columns and rows to coordinates, row by row.
std::vector<double> model_transformation(const Vector2d& origin, const Vector2d& per_column,
                                         const Vector2d& per_row) {
  return {per_column.x(),
          per_row.x(),
          0.0,
          origin.x(),
          per_column.y(),
          per_row.y(),
          0.0,
          origin.y(),
          0.0,
          0.0,
          0.0,
          0.0,
          0.0,
          0.0,
          0.0,
          1.0};
}

}  // namespace

const char* to_string(SurfaceClass of) {
  switch (of) {
    case SurfaceClass::roof:
      return "roof";
    case SurfaceClass::wall:
      return "wall";
    case SurfaceClass::underside:
      return "underside";
    case SurfaceClass::ground:
      break;
  }
  return "ground";
}

DensitySamples density_samples(const geometry::Mesh& model, const geometry::Mesh& surroundings,
                               double spacing, double margin) {
  DensitySamples samples;
  samples.surface = model;
  double area = 0.0;
  const geometry::SurfaceSamples own = spread(model, spacing, area);
  samples.positions = own.points;
  for (const Vector3f& normal : own.normals) samples.classes.push_back(read_class(normal));
  samples.areas.assign(own.points.size(), area);
  if (surroundings.triangles.empty()) return samples;
  Eigen::AlignedBox3d box = geometry::bounding_box(model);
  box.min().array() -= margin;
  box.max().array() += margin;
  geometry::Mesh ground{.vertices = surroundings.vertices, .triangles = {}};
  for (const auto& triangle : surroundings.triangles) {
    const Vector3d normal = triangle_area_vector(surroundings, triangle);
    if (read_class(normal.normalized().cast<float>()) != SurfaceClass::roof) continue;
    ground.triangles.push_back(triangle);
  }
  if (ground.triangles.empty()) return samples;
  geometry::append(samples.surface, ground);
  const geometry::SurfaceSamples others = spread(ground, spacing, area);
  for (const Vector3f& position : others.points) {
    if (!box.contains(position.cast<double>())) continue;
    samples.positions.push_back(position);
    samples.classes.push_back(SurfaceClass::ground);
    samples.areas.push_back(area);
  }
  return samples;
}

DensityMeter::DensityMeter(DensitySamples samples, double radius, unsigned threads)
    : samples_(std::move(samples)),
      radius_(radius),
      threads_(threads),
      grid_(radius),
      areas_(samples_.positions.size(), 0.0),
      counts_(samples_.positions.size(), 0) {
  for (const Vector3f& position : samples_.positions) grid_.insert(position);
  std::vector<geometry::Neighbour> near;
  for (const auto& indices : samples_.surface.triangles) {
    const Triangle triangle = triangle_corners(samples_.surface, indices);
    const Vector3d centre = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
    double size = 0.0;
    for (const Vector3d& corner : triangle) size = std::max(size, (corner - centre).norm());
    near.clear();
    grid_.find_within(centre.cast<float>(), 1.00001 * (size + radius_), near);
    for (const geometry::Neighbour& sample : near) {
      areas_[sample.index] +=
          area_within(triangle, samples_.positions[sample.index].cast<double>(), radius_);
    }
  }
}

void DensityMeter::add(std::span<const Vector3f> points) {
  constexpr std::size_t portion = 1 << 14;
  const std::size_t portions = (points.size() + portion - 1) / portion;
  geometry::parallel_for(portions, threads_, [&](std::size_t number) {
    std::vector<geometry::Neighbour> near;
    const std::size_t begin = number * portion, end = std::min(begin + portion, points.size());
    for (std::size_t i = begin; i < end; ++i) {
      if (!points[i].allFinite()) continue;
      near.clear();
      grid_.find_within(points[i], radius_, near);
      for (const geometry::Neighbour& position : near) {
        std::atomic_ref(counts_[position.index]).fetch_add(1, std::memory_order_relaxed);
      }
    }
  });
}

std::vector<double> DensityMeter::densities() const {
  std::vector<double> densities;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    densities.push_back(static_cast<double>(counts_[i]) / areas_[i]);
  }
  return densities;
}

std::optional<DensityFigures> DensityMeter::figures(double asked) const {
  const std::vector<double> all = densities();
  std::vector<std::pair<double, double>> chosen;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (samples_.classes[i] != SurfaceClass::ground) chosen.emplace_back(all[i], samples_.areas[i]);
  }
  if (chosen.empty()) return std::nullopt;
  return compute_figures(std::move(chosen), asked);
}

std::optional<DensityFigures> DensityMeter::figures(double asked, SurfaceClass of) const {
  const std::vector<double> all = densities();
  std::vector<std::pair<double, double>> chosen;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (samples_.classes[i] == of) chosen.emplace_back(all[i], samples_.areas[i]);
  }
  if (chosen.empty()) return std::nullopt;
  return compute_figures(std::move(chosen), asked);
}

DensityRaster::DensityRaster(const Eigen::AlignedBox2d& box, double cell)
    : north_west_(box.min().x(), box.max().y()), cell_(cell), columns_(0), rows_(0) {
  constexpr double max_cells = 1e8;
  const Vector2d cells = (box.sizes() / cell).array().ceil();
  if (!(cells.minCoeff() >= 1.0) || !(cells.prod() <= max_cells)) {
    throw Error(ErrorKind::bad_config,
                "the density raster would have " + std::to_string(cells.x()) + " x " +
                    std::to_string(cells.y()) +
                    " cells; it must have at least 1 and at most 100 million cells");
  }
  columns_ = static_cast<std::size_t>(cells.x());
  rows_ = static_cast<std::size_t>(cells.y());
  counts_.assign(columns_ * rows_, 0);
}

void DensityRaster::add(std::span<const Vector3f> points) {
  for (const Vector3f& point : points) {
    const double column = std::floor((double{point.x()} - north_west_.x()) / cell_);
    const double row = std::floor((north_west_.y() - double{point.y()}) / cell_);
    const bool is_inside = column >= 0.0 && row >= 0.0 && column < static_cast<double>(columns_) &&
                           row < static_cast<double>(rows_);  // False for NaN.
    if (!is_inside) continue;
    ++counts_[static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column)];
  }
}

std::string DensityRaster::geotiff(const std::optional<flight::Site>& site) const {
  const auto width = static_cast<double>(columns_), height = static_cast<double>(rows_);
  std::string image;
  image.reserve(4 * counts_.size());
  for (const std::uint32_t count : counts_) {
    Tiff::append(image, static_cast<float>(count / (cell_ * cell_)));
  }
  Vector2d origin = north_west_, per_column(cell_, 0.0), per_row(0.0, -cell_);
  // GeoTIFF keys, version 1.1.0. Each entry has the key's number, the location of its value (0: in
  // this entry), count and value.
  std::vector<std::uint16_t> keys{1, 1, 0, 1, 1025, 0, 1, 1};  // RasterPixelIsArea.
  if (site) {
    const flight::UtmProjection utm(*site);
    const auto to_map = [&](double column, double row) -> Vector2d {
      const Vector2d local = north_west_ + column * per_column + row * per_row;
      return utm.to_map_exactly({local.x(), local.y(), 0.0}).head<2>();
    };
    origin = to_map(0.0, 0.0);
    const Vector2d east = (to_map(width, 0.0) - origin) / width;
    const Vector2d south = (to_map(0.0, height) - origin) / height;
    per_column = east, per_row = south;
    keys = {1,    1, 0, 3, 1024, 0, 1, 1,
            1025, 0, 1, 1, 3072, 0, 1, static_cast<std::uint16_t>(utm.epsg())};
  }
  Tiff tiff;
  const auto u32 = [](std::size_t number) {
    return std::vector<std::uint32_t>{static_cast<std::uint32_t>(number)};
  };
  const auto u16 = [](std::uint16_t number) { return std::vector<std::uint16_t>{number}; };
  tiff.add(256, Tiff::u32, u32(columns_));      // ImageWidth
  tiff.add(257, Tiff::u32, u32(rows_));         // ImageLength
  tiff.add(258, Tiff::u16, u16(32));            // BitsPerSample
  tiff.add(259, Tiff::u16, u16(1));             // Compression: none
  tiff.add(262, Tiff::u16, u16(1));             // PhotometricInterpretation: black is zero
  tiff.add(277, Tiff::u16, u16(1));             // SamplesPerPixel
  tiff.add(278, Tiff::u32, u32(rows_));         // RowsPerStrip
  tiff.add(279, Tiff::u32, u32(image.size()));  // StripByteCounts
  tiff.add(284, Tiff::u16, u16(1));             // PlanarConfiguration
  tiff.add(339, Tiff::u16, u16(3));             // SampleFormat: floating point
  tiff.add(34264, Tiff::f64, model_transformation(origin, per_column, per_row));
  tiff.add(34735, Tiff::u16, keys);  // GeoKeyDirectory
  return tiff.bytes(273, image);     // StripOffsets
}

}  // namespace skycap::missions::evaluation
