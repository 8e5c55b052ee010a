#include "missions/report/cloud_page.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/io/cloud_io.h"
#include "geometry/io/cloud_sample.h"
#include "geometry/io/file.h"
#include "missions/report/page.h"
#include "missions/report/point_figures.h"
#include "missions/report/results.h"
#include "missions/report/scene_outline.h"
#include "missions/site_data/site_priors.h"
#include "missions/site_data/surface_points.h"
#include "missions/support/number_text.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;

using Colour = std::array<std::uint8_t, 3>;

/// Reduced set of colours, and the colour index of each point.
struct Palette {
  std::vector<Colour> colours;
  std::vector<std::uint16_t> point_colours;
};

/// Replaces the lowest `bits` of each channel by a constant.
Colour rounded(Colour colour, int bits) {
  for (std::uint8_t& channel : colour) {
    channel = static_cast<std::uint8_t>(channel >> bits << bits | ((1 << bits) >> 1));
  }
  return colour;
}

/// Returns a palette of up to 256 colours, because the report stores one byte per point. Colours
/// are rounded only as far as necessary.
Palette make_palette(const std::vector<Colour>& colours) {
  constexpr std::size_t max = 256;
  for (int bits = 0;; ++bits) {
    std::map<Colour, std::uint16_t> indices;
    for (std::size_t i = 0; i < colours.size() && indices.size() <= max; ++i) {
      indices.emplace(rounded(colours[i], bits), 0);
    }
    if (indices.size() > max) continue;
    Palette palette;
    for (auto& [colour, index] : indices) {
      index = static_cast<std::uint16_t>(palette.colours.size());
      palette.colours.push_back(colour);
    }
    for (const Colour& colour : colours) {
      palette.point_colours.push_back(indices.at(rounded(colour, bits)));
    }
    return palette;
  }
}

/// Reads a large LAS or LAZ file in part, because only default_report_points are shown.
geometry::CloudSample read_sample(const std::filesystem::path& file) {
  const std::string extension = geometry::lower_extension(file);
  if (extension == ".las" || extension == ".laz") {
    return geometry::sample_las_cloud(file, default_report_points);
  }
  geometry::CloudSample sample{.cloud = geometry::read_cloud(file)};
  sample.of = sample.cloud.positions.size();
  return sample;
}

Json sample_facts(const geometry::CloudSample& sample) {
  const std::size_t read = sample.cloud.positions.size();
  Json facts = Json::array({support::counted(sample.of, "point")});
  if (read < sample.of) facts.push_back("sample of " + support::counted(read, "point"));
  if (!sample.offset.isZero()) {
    facts.push_back(
        fmt::format("coordinates minus {:.0f}, {:.0f} m", sample.offset.x(), sample.offset.y()));
  }
  return facts;
}

}  // namespace

std::string cloud_page(const std::filesystem::path& file) {
  const geometry::CloudSample sample = read_sample(file);
  const geometry::AttributedCloud& cloud = sample.cloud;
  const std::vector<std::uint16_t> views = view_numbers(cloud);
  std::vector<CloudAttribute> attributes;
  if (!views.empty()) attributes.push_back({"view", views});
  const Palette palette = make_palette(cloud.colours);
  if (!palette.point_colours.empty()) attributes.push_back({"colour", palette.point_colours});
  const std::string name = file.filename().string();
  const Json data = {{"kind", "cloud"},
                     {"title", name},
                     {"facts", sample_facts(sample)},
                     {"palette", palette.colours}};
  CloudCode code = encode_cloud(cloud.positions, attributes, default_report_points);
  code.of = sample.of;  // for densities
  return page_text(name, data, {{"measured", std::move(code)}});
}

std::string coloured_points_page(const std::string& title, const std::vector<std::string>& facts,
                                 std::span<const Eigen::Vector3f> points,
                                 const std::vector<Colour>& colours) {
  const Palette palette = make_palette(colours);
  const Json data = {
      {"kind", "cloud"}, {"title", title}, {"facts", facts}, {"palette", palette.colours}};
  return page_text(title, data,
                   {{"measured", encode_cloud(points, {{{"colour", palette.point_colours}}},
                                              default_report_points)}});
}

/// Points on the targets of the prior data.
std::vector<Eigen::Vector3f> target_points(const scene::SceneOptions& scene) {
  constexpr std::size_t max_points = 100'000;
  constexpr double spacing = 0.1;
  std::vector<Eigen::Vector3f> points;
  if (!scene.priors) return points;
  for (const site_data::Prior& prior : scene.priors->priors) {
    if (prior.role != site_data::Role::target) continue;
    for (const site_data::Object& object : prior.objects) {
      const std::vector<Eigen::Vector3f> own =
          site_data::spread_over(object, max_points, spacing).positions;
      points.insert(points.end(), own.begin(), own.end());
    }
  }
  return points;
}

std::string mission_page(const std::string& name, const session::SurveyOptions& survey,
                         const scene::SceneOptions& scene, std::span<const Eigen::Vector3f> surface,
                         const std::optional<Eigen::Vector3d>& pad) {
  const Json facts = scene.model.empty()
                         ? Json{"target from prior data"}
                         : Json{scene.model, "model of the simulation, not yet measured"};
  const Json data = {{"kind", "mission"},
                     {"title", name},
                     {"facts", facts},
                     {"scene", scene_outline(survey, scene, pad)}};
  return page_text(name, data, {{"model", encode_cloud(surface, {}, default_report_points)}});
}

}  // namespace skycap::missions::report
