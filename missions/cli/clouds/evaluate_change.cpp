#include "missions/cli/clouds/evaluate_change.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/angle.h"
#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/column_cloud.h"
#include "geometry/io/output_folder.h"
#include "geometry/io/text/ply.h"
#include "geometry/points/cloud_alignment.h"
#include "geometry/points/m3c2.h"
#include "geometry/points/point_grid.h"
#include "geometry/points/spaced_points.h"
#include "missions/report/cloud_code.h"
#include "missions/report/cloud_page.h"
#include "missions/support/json_text.h"
#include "sim/scene/render.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Json = nlohmann::ordered_json;
using Colour = std::array<std::uint8_t, 3>;

/// Clouds in a local frame, in which single precision is sufficient.
struct Clouds {
  Vector3d origin = Vector3d::Zero();  ///< of the local frame, in the coordinates of the files
  std::vector<Vector3f> reference, cloud;
  Vector3d centre = Vector3d::Zero();  ///< of the reference, local
};

Clouds read_clouds(const EvaluateOptions& options, const Console& console) {
  const auto read = [&](const fs::path& file) {
    geometry::ColumnCloud cloud = geometry::read_column_cloud(file);
    if (cloud.skipped > 0) {
      warn(console,
           fmt::format("{}: {} points skipped (NaN or infinite)", file.string(), cloud.skipped));
    }
    if (cloud.positions.empty()) {
      throw Error(ErrorKind::bad_file, file.string() + ": contains no valid points");
    }
    return std::move(cloud.positions);
  };
  const std::vector<Vector3d> reference = read(options.reference), cloud = read(options.cloud);
  Eigen::AlignedBox3d box, other;
  for (const Vector3d& point : reference) box.extend(point);
  for (const Vector3d& point : cloud) other.extend(point);
  const double reach =
      std::max((box.max() - box.min()).maxCoeff(), (box.exteriorDistance(other.center())));
  constexpr double max_reach = 10'000.0;
  if (!(reach <= max_reach)) {
    throw Error(ErrorKind::bad_file,
                fmt::format("{}: extends over, or is away from {} by, {:.0f} m; the maximum is "
                            "10000 m: check the coordinates of both",
                            options.cloud.string(), options.reference.string(), reach));
  }
  Clouds clouds;
  clouds.origin = box.center().array().round();
  clouds.centre = box.center() - clouds.origin;
  const auto localise = [&](const std::vector<Vector3d>& points, std::vector<Vector3f>& local) {
    local.reserve(points.size());
    for (const Vector3d& point : points) local.push_back((point - clouds.origin).cast<float>());
  };
  localise(reference, clouds.reference);
  localise(cloud, clouds.cloud);
  return clouds;
}

/// Returns one point per spacing.
std::vector<Vector3f> core_points(const std::vector<Vector3f>& points, double spacing) {
  geometry::SpacedPoints spaced(spacing);
  for (const Vector3f& point : points) spaced.keep(point);
  std::vector<Vector3f> cores;
  cores.reserve(spaced.grid().size());
  for (std::uint32_t i = 0; i < spaced.grid().size(); ++i) cores.push_back(spaced.grid().point(i));
  return cores;
}

/// Returns the fraction of `cores` with a point of `cloud` within `distance`.
double completeness(const std::vector<Vector3f>& cores, const std::vector<Vector3f>& cloud,
                    double distance) {
  geometry::PointGrid grid(distance);
  for (const Vector3f& point : cloud) grid.insert(point);
  std::size_t found = 0;
  for (const Vector3f& core : cores) found += grid.any_within(core, distance) ? 1 : 0;
  return static_cast<double>(found) / static_cast<double>(cores.size());
}

/// Rigid offset of the cloud from the reference.
struct Offset {
  geometry::Registration registration;
  Vector3d shift;  ///< from the reference to the cloud at the centre of the cloud [m]
  double turn_deg;

  /// An offset below both limits is smaller than that of good surveys.
  bool is_aligned() const { return shift.norm() < 0.02 && turn_deg < 0.05; }
};

std::optional<Offset> find_offset(const Clouds& clouds, const geometry::M3c2Options& m3c2) {
  const auto found =
      geometry::align_clouds(clouds.cloud, clouds.reference, clouds.centre, m3c2.normal_scale / 2.0,
                             std::max(m3c2.max_distance, 1.0));
  if (!found) return std::nullopt;
  const Vector3d moved = found->correction * found->middle;
  return Offset{
      *found, found->middle - moved,
      Eigen::AngleAxisd(found->correction.linear()).angle() / geometry::radians_per_degree};
}

struct Figures {
  std::size_t known = 0, significant = 0;
  double mean = 0.0, median = 0.0, deviation = 0.0, percentile_5 = 0.0, percentile_95 = 0.0;
  double median_level = 0.0;
};

double quantile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

Figures compute_figures(const std::vector<geometry::M3c2Distance>& distances) {
  Figures figures;
  std::vector<double> values, levels;
  for (const geometry::M3c2Distance& distance : distances) {
    if (!distance.is_known()) continue;
    values.push_back(distance.distance);
    levels.push_back(distance.level_of_detection);
    figures.significant += distance.is_significant() ? 1 : 0;
  }
  figures.known = values.size();
  if (values.empty()) return figures;
  for (const double value : values) figures.mean += value;
  figures.mean /= static_cast<double>(values.size());
  for (const double value : values) {
    figures.deviation += (value - figures.mean) * (value - figures.mean);
  }
  figures.deviation = std::sqrt(figures.deviation / static_cast<double>(values.size()));
  figures.median = quantile(values, 0.5);
  figures.percentile_5 = quantile(values, 0.05);
  figures.percentile_95 = quantile(values, 0.95);
  figures.median_level = quantile(levels, 0.5);
  return figures;
}

/// Returns blue for surface that has receded, red for surface that has grown, both stronger at
/// larger distances; light grey for insignificant distances; dark grey for unknown ones.
Colour change_colour(const geometry::M3c2Distance& distance, double full) {
  if (!distance.is_known()) return {70, 70, 70};
  if (!distance.is_significant()) return {205, 205, 205};
  const double share = std::min(1.0, std::abs(distance.distance) / full);
  const auto fading = static_cast<std::uint8_t>(std::lround(190.0 * (1.0 - share)));
  if (distance.distance > 0.0) return {215, fading, fading};
  return {fading, fading, 225};
}

std::string distances_ply(const Clouds& clouds, const std::vector<Vector3f>& cores,
                          const std::vector<geometry::M3c2Distance>& distances,
                          const std::vector<Colour>& colours) {
  using geometry::PlyType;
  geometry::PlyElement vertex{"vertex", cores.size(), {}};
  vertex.add(PlyType::float64, {"x", "y", "z"});
  vertex.add(PlyType::float32, {"nx", "ny", "nz", "distance", "level_of_detection"});
  vertex.add(PlyType::uint32, {"points1", "points2"});
  vertex.add(PlyType::uint8, {"red", "green", "blue"});
  std::string bytes = geometry::ply_header({&vertex, 1});
  for (std::size_t i = 0; i < cores.size(); ++i) {
    const geometry::M3c2Distance& distance = distances[i];
    geometry::append_value(bytes, Vector3d(cores[i].cast<double>() + clouds.origin));
    geometry::append_value(bytes, Vector3f(distance.normal.cast<float>()));
    geometry::append_value(bytes, static_cast<float>(distance.distance));
    geometry::append_value(bytes, static_cast<float>(distance.level_of_detection));
    geometry::append_value(bytes, static_cast<std::uint32_t>(distance.points1));
    geometry::append_value(bytes, static_cast<std::uint32_t>(distance.points2));
    geometry::append_value(bytes, colours[i]);
  }
  return bytes;
}

/// Draws the core points from the four sides and from above, nearest points in front.
sim::Image draw(const std::vector<Vector3f>& cores, const std::vector<Colour>& colours,
                double spacing) {
  constexpr int panel = 480, panels = 5;
  sim::Image image;
  image.width = panel * panels;
  image.height = panel;
  image.pixels.assign(static_cast<std::size_t>(image.width) * panel, sim::Rgb{255, 255, 255});
  Eigen::AlignedBox3f box;
  for (const Vector3f& core : cores) box.extend(core);
  const double size = std::max(static_cast<double>((box.max() - box.min()).maxCoeff()), spacing);
  const double per_metre = 0.94 * panel / size;
  const int radius = std::clamp(static_cast<int>(0.6 * spacing * per_metre), 0, 8);
  struct Panel {
    Vector3f right, up, front;
  };
  const std::array<Panel, panels> sides = {{{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                            {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                                            {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                            {{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}},
                                            {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  for (int side = 0; side < panels; ++side) {
    const auto& [right, up, front] = sides[static_cast<std::size_t>(side)];
    std::vector<float> depth(static_cast<std::size_t>(panel) * panel,
                             -std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < cores.size(); ++i) {
      const Vector3f offset = cores[i] - box.center();
      const int x = panel / 2 + static_cast<int>(std::lround(offset.dot(right) * per_metre));
      const int y = panel / 2 - static_cast<int>(std::lround(offset.dot(up) * per_metre));
      for (int row = std::max(0, y - radius); row <= std::min(panel - 1, y + radius); ++row) {
        for (int column = std::max(0, x - radius); column <= std::min(panel - 1, x + radius);
             ++column) {
          float& nearest = depth[static_cast<std::size_t>(row * panel + column)];
          if (offset.dot(front) <= nearest) continue;
          nearest = offset.dot(front);
          image.at(side * panel + column, row) = colours[i];
        }
      }
    }
  }
  return image;
}

Json offset_json(const std::optional<Offset>& offset, bool is_applied) {
  if (!offset) return {{"found", false}};
  return {{"found", true},
          {"aligned", is_applied || offset->is_aligned()},
          {"applied", is_applied},
          {"offset_m", {offset->shift.x(), offset->shift.y(), offset->shift.z()}},
          {"rotation_deg", offset->turn_deg},
          {"median_error_before_m", offset->registration.first_error},
          {"median_error_after_m", offset->registration.error}};
}

/// Returns a number with fixed digits, and without the sign of a rounded zero.
std::string signed_text(double value, int digits) {
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string offset_text(const std::optional<Offset>& offset, bool is_applied) {
  if (!offset) return "unknown: the clouds have no common planes";
  const std::string text = fmt::format(
      "offset {}, {}, {} m, rotation {:.3f} deg", signed_text(offset->shift.x(), 3),
      signed_text(offset->shift.y(), 3), signed_text(offset->shift.z(), 3), offset->turn_deg);
  if (is_applied) return "aligned here; " + text + " removed";
  return (offset->is_aligned() ? "aligned; " : "NOT aligned; ") + text;
}

}  // namespace

int evaluate_change(const EvaluateOptions& options, const Console& console) {
  if (options.cloud.empty() || options.shards > 0 || options.density) {
    throw Error(ErrorKind::bad_usage,
                "--reference requires --cloud and conflicts with --pieces and --density");
  }
  ProgressLine progress(console, options.is_quiet || options.is_json);
  progress.show("reading " + options.reference.string());
  Clouds clouds = read_clouds(options, console);
  geometry::M3c2Options m3c2;
  const double spacing =
      std::max(report::compute_spacing(clouds.reference), report::compute_spacing(clouds.cloud));
  constexpr double spacings_per_cylinder = 10.0;
  m3c2.cylinder_diameter =
      options.cylinder > 0.0 ? options.cylinder : std::max(1e-3, spacings_per_cylinder * spacing);
  m3c2.normal_scale =
      options.normal_scale > 0.0 ? options.normal_scale : 2.0 * m3c2.cylinder_diameter;
  m3c2.max_distance = options.max_change > 0.0 ? options.max_change : 5.0 * m3c2.cylinder_diameter;
  m3c2.registration_error = options.registration_error;
  progress.show("aligning");
  const std::optional<Offset> offset = find_offset(clouds, m3c2);
  const bool is_applied = options.is_aligned && offset;
  if (options.is_aligned && !offset) {
    throw Error(ErrorKind::bad_geometry,
                options.cloud.string() + ": cannot be aligned with " + options.reference.string() +
                    ": they have no common planes; remove --align or raise --max-change");
  }
  if (is_applied) {
    for (Vector3f& point : clouds.cloud) {
      point = (offset->registration.correction * point.cast<double>()).cast<float>();
    }
  }
  progress.show("comparing");
  const std::vector<Vector3f> cores = core_points(clouds.reference, m3c2.cylinder_diameter / 2.0);
  const std::vector<Vector3f> others = core_points(clouds.cloud, m3c2.cylinder_diameter / 2.0);
  const std::vector<geometry::M3c2Distance> distances = geometry::m3c2_distances(
      cores, clouds.reference, clouds.cloud, clouds.centre, m3c2, options.threads);
  if (console.stop.stop_requested()) throw Error(ErrorKind::bad_usage, "interrupted");
  const double distance = options.distance.value_or(m3c2.cylinder_diameter / 2.0);
  const double of_reference = completeness(cores, clouds.cloud, distance),
               of_cloud = completeness(others, clouds.reference, distance);
  const Figures figures = compute_figures(distances);
  const double share = figures.known == 0 ? 0.0
                                          : static_cast<double>(figures.significant) /
                                                static_cast<double>(figures.known);
  const Json json = {{"cloud", options.cloud.string()},
                     {"reference", options.reference.string()},
                     {"points", clouds.cloud.size()},
                     {"reference_points", clouds.reference.size()},
                     {"alignment", offset_json(offset, is_applied)},
                     {"normal_scale_m", m3c2.normal_scale},
                     {"cylinder_diameter_m", m3c2.cylinder_diameter},
                     {"max_change_m", m3c2.max_distance},
                     {"registration_error_m", m3c2.registration_error},
                     {"core_points", cores.size()},
                     {"core_points_with_distance", figures.known},
                     {"significant", share},
                     {"distance_m",
                      {{"mean", figures.mean},
                       {"standard_deviation", figures.deviation},
                       {"median", figures.median},
                       {"percentile_5", figures.percentile_5},
                       {"percentile_95", figures.percentile_95}}},
                     {"median_level_of_detection_m", figures.median_level},
                     {"completeness_distance_m", distance},
                     {"completeness_of_reference", of_reference},
                     {"completeness_of_cloud", of_cloud}};
  const std::vector<std::string> facts = {
      fmt::format("alignment: {}", offset_text(offset, is_applied)),
      fmt::format("{} of {} core points have a distance; {:.1f}% of these are significant",
                  figures.known, cores.size(), 100.0 * share),
      fmt::format("distance: median {} m, mean {} m, 5% below {} m, 95% below {} m",
                  signed_text(figures.median, 4), signed_text(figures.mean, 4),
                  signed_text(figures.percentile_5, 4), signed_text(figures.percentile_95, 4)),
      fmt::format("level of detection (95%): median {:.4f} m", figures.median_level),
      fmt::format("within {:.3g} m: {:.1f}% of the reference is in the cloud, {:.1f}% of the cloud "
                  "is in the reference",
                  distance, 100.0 * of_reference, 100.0 * of_cloud)};
  if (options.out) {
    const double full = std::max({std::abs(figures.percentile_5), std::abs(figures.percentile_95),
                                  2.0 * figures.median_level, 1e-6});
    std::vector<Colour> colours;
    colours.reserve(distances.size());
    for (const geometry::M3c2Distance& one : distances) {
      colours.push_back(change_colour(one, full));
    }
    geometry::OutputFolder folder(*options.out);
    folder.write("change.json", support::json_text(json));
    folder.write("change.ply", distances_ply(clouds, cores, distances, colours));
    sim::write_png(draw(cores, colours, m3c2.cylinder_diameter / 2.0), folder.stage("change.png"));
    std::vector<std::string> page_facts = facts;
    page_facts.push_back(fmt::format(
        "red: in front of the reference, blue: behind it (full colour: {:.3g} m); light grey: not "
        "significant; dark grey: no counterpart",
        full));
    folder.write("change.html",
                 report::coloured_points_page(options.cloud.filename().string() + " against " +
                                                  options.reference.filename().string(),
                                              page_facts, cores, colours));
    folder.commit();
  }
  progress.clear();
  if (options.is_json) {
    console.out << support::json_text(json) << std::flush;
    return 0;
  }
  if (options.is_quiet) return 0;
  console.out << fmt::format(
      "{} against {} (d = {:.3g} m, D = {:.3g} m)\n", options.cloud.filename().string(),
      options.reference.filename().string(), m3c2.cylinder_diameter, m3c2.normal_scale);
  for (const std::string& fact : facts) console.out << "  " << fact << "\n";
  if (options.out) console.out << "  results: " << options.out->string() << "\n";
  console.out << std::flush;
  return 0;
}

}  // namespace skycap::missions::cli
