#include "missions/site_data/prior_text.h"

#include <array>
#include <optional>

#include <fmt/format.h>

#include "missions/support/number_text.h"

namespace skycap::missions::site_data {
namespace {

/// Describes the contents: "3 objects with 154 triangles, 20 points".
std::string describe_contents(const Prior& prior) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (!prior.objects.empty()) {
    std::size_t triangles = 0;
    for (const Object& object : prior.objects) triangles += object.mesh.triangles.size();
    add(support::counted(prior.objects.size(), "object") + " with " +
        support::counted(triangles, "triangle"));
  }
  if (!prior.points.empty()) add(fmt::format("{} points", prior.points.size()));
  if (prior.grid.rows > 0) {
    add(fmt::format("a grid of {} x {} heights", prior.grid.columns, prior.grid.rows));
  }
  return text.empty() ? "nothing" : text;
}

std::string heights_text(const char* above, const std::optional<HeightRange>& heights) {
  if (!heights) return "";
  return fmt::format("; {} {:.2f} to {:.2f} m", above, heights->min, heights->max);
}

std::string format_priors(const Source& source, const Prior& prior) {
  std::string text = fmt::format("  prior     {}: {}, {}, {}\n", source.file.filename().string(),
                                 to_string(source.role), prior.format, describe_contents(prior));
  constexpr const char* indent = "            ";
  if (!prior.box.isEmpty()) {
    const Eigen::Vector3d size = prior.box.sizes();
    text += fmt::format("{}{:.3f} x {:.3f} x {:.3f} m, z {:.2f} to {:.2f} m", indent, size.x(),
                        size.y(), size.z(), prior.box.min().z(), prior.box.max().z());
    // Absolute heights are those of the site, which may be unknown.
    if (source.vertical != HeightDatum::takeoff) {
      text += heights_text("above the ellipsoid", prior.ellipsoid_heights);
      text += heights_text("above mean sea level", prior.sea_level_heights);
    }
    text += fmt::format("\n{}{:.1f} m from the site's origin, uncertainty {:.2f} m\n", indent,
                        prior.box.exteriorDistance(Eigen::Vector3d::Zero()), prior.uncertainty);
    if (!prior.crs.empty()) text += fmt::format("{}coordinate system {}\n", indent, prior.crs);
  }
  if (prior.dropped_polygons > 0) {
    text += fmt::format("{}{} polygons without area ignored\n", indent, prior.dropped_polygons);
  }
  for (const std::string& note : prior.notes) text += indent + note + "\n";
  return text;
}

}  // namespace

const char* to_string(Role role) {
  constexpr std::array names{"target", "obstacle", "terrain", "truth"};
  return names[static_cast<std::size_t>(role)];
}

const char* to_string(HeightDatum datum) {
  constexpr std::array names{"ellipsoid", "geoid", "takeoff"};
  return names[static_cast<std::size_t>(datum)];
}

std::string format_priors(const SitePriors& site) {
  std::string text;
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    text += format_priors(site.sources[i], site.priors[i]);
  }
  if (!site.ground_note.empty()) text += "  ground    " + site.ground_note + "\n";
  return text;
}

}  // namespace skycap::missions::site_data
