// Prior data of a document: key checks and file access.
#include "missions/config/prior_sources.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "missions/config/derived_values.h"
#include "missions/config/mission_keys.h"
#include "missions/site_data/extrusion.h"

namespace skycap::missions::config {
namespace {

using site_data::Role;
using site_data::Source;

std::string make_key(std::size_t source, const std::string& key) {
  return "prior[" + std::to_string(source) + "]." + key;
}

/// Resolves a path relative to the mission's folder.
void make_absolute(std::filesystem::path& path, const std::filesystem::path& folder) {
  if (path.empty()) return;
  path = std::filesystem::absolute(folder / path);
}

void check_source(const MissionDocument& document, std::size_t i) {
  const Source& source = document.prior[i];
  if (source.pose && !source.crs.empty()) {
    document.reject(make_key(i, "crs"), "conflicts with place; remove one of the two");
  }
  if (!source.crs.empty() && !is_georeferenced(document)) {
    document.reject(make_key(i, "crs"),
                    "requires the georeference of the mission frame; set site.latitude_deg and "
                    "site.longitude_deg");
  }
  if (source.base_on_terrain && source.role == Role::terrain) {
    document.reject(make_key(i, "base"), "the base of terrain must be a number");
  }
  if (source.role == Role::truth && !document.scene.model.empty()) {
    document.reject(make_key(i, "role"), "truth conflicts with scene.model; remove one of the two");
  }
}

/// Returns whether a key differs from its default. Its presence is not sufficient, because missions
/// in packages specify every key.
bool differs_from_default(const MissionDocument& document, const char* path) {
  const Key& key = *find_key(path);
  const auto text = [&](const MissionDocument& given) {
    const auto value = key.get(given);
    return value ? to_text(*value) : std::string();
  };
  return text(document) != text(MissionDocument());
}

}  // namespace

void make_sources_absolute(MissionDocument& document) {
  const std::filesystem::path folder = std::filesystem::path(document.file).parent_path();
  for (Source& source : document.prior) {
    make_absolute(source.file, folder);
    make_absolute(source.select.within, folder);
  }
}

site_data::SiteFrame site_frame(const MissionDocument& document, std::optional<double> geoid) {
  const std::optional<double>& given = document.georeference.geoid_undulation;
  site_data::SiteFrame frame{.ground_z = document.scene.position.z(),
                             .undulation = given ? given : geoid};
  if (const auto& takeoff = document.flight.options.takeoff) {
    frame.takeoff_z = takeoff->z();
    frame.ground_z = *frame.takeoff_z;
  }
  if (is_georeferenced(document)) frame.origin = make_site(document).origin;
  return frame;
}

std::shared_ptr<const site_data::SitePriors> read_priors(const MissionDocument& document,
                                                         const site_data::SiteFrame& frame,
                                                         const Report& report) {
  if (document.prior.empty()) return nullptr;
  MissionDocument placed = document;
  make_sources_absolute(placed);
  const std::vector<Source>& sources = placed.prior;
  for (std::size_t i = 0; i < sources.size(); ++i) check_source(document, i);
  const auto failed = [&](std::size_t i, const std::string& what) {
    document.reject(make_key(i, "file"), what);
  };
  std::size_t begun = 0;
  const auto reading = [&](std::size_t i) {
    if (!report) return;
    report("reading prior data file " + std::to_string(++begun) + " of " +
           std::to_string(sources.size()) + " of prior data, " +
           sources[i].file.filename().string());
  };
  return std::make_shared<const site_data::SitePriors>(
      site_data::read_site_priors(sources, frame, failed, reading));
}

std::shared_ptr<const site_data::SitePriors> make_outline_priors(const MissionDocument& document) {
  if (!has_outline_as_truth(document)) return nullptr;
  const survey::patterns::PatternSettings& settings = document.planner.patterns;
  constexpr double thinnest = 0.2, uncertainty = 1.0;
  site_data::Prior prior{.role = Role::target, .uncertainty = uncertainty, .format = "outline"};
  site_data::Object object{.id = "1", .kind = "outline"};
  const double base = settings.base.value_or(document.scene.position.z());
  const auto add = [&](const std::vector<Eigen::Vector2d>& corners) {
    std::vector<Eigen::Vector3d> bottom, top;
    for (const Eigen::Vector2d& corner : corners) {
      bottom.emplace_back(corner.x(), corner.y(), base);
      top.emplace_back(corner.x(), corner.y(), settings.top.value());
    }
    const std::uint32_t begin[] = {0, static_cast<std::uint32_t>(corners.size())};
    site_data::add_extruded(object, bottom, top, begin);
  };
  if (!settings.polygon.empty()) add(settings.polygon);
  for (std::size_t i = 0; i + 1 < settings.line.size(); ++i) {
    const Eigen::Vector2d& from = settings.line[i];
    const Eigen::Vector2d& to = settings.line[i + 1];
    if (from == to) continue;
    const Eigen::Vector2d along = (to - from).normalized();
    const Eigen::Vector2d side =
        0.5 * std::max(settings.width, thinnest) * Eigen::Vector2d(-along.y(), along.x());
    add({from - side, to - side, to + side, from + side});
  }
  prior.box = geometry::bounding_box(object.mesh);
  prior.objects.push_back(std::move(object));
  site_data::SitePriors site;
  site.sources.push_back({.file = "pattern", .role = Role::target});
  site.priors.push_back(std::move(prior));
  return std::make_shared<const site_data::SitePriors>(std::move(site));
}

void check_truth(const MissionDocument& document) {
  if (!document.scene.is_truth_prior()) return;
  if (prior_truth(document.scene).triangles.empty()) {
    document.reject("scene.model",
                    "prior requires a target or truth with a surface in the prior data");
  }
  for (const char* key : {"scene.up_axis", "scene.rotation_deg", "scene.longest_side",
                          "scene.scale", "scene.copies", "scene.materials"}) {
    if (differs_from_default(document, key)) {
      document.reject(key,
                      "conflicts with ground truth from prior data, which has its own position "
                      "keys; remove it");
    }
  }
}

}  // namespace skycap::missions::config
