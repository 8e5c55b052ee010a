#include "missions/package/target_coverage.h"

#include <array>
#include <cstdint>

#include <fmt/format.h>

#include "missions/evaluation/coverage.h"
#include "missions/site_data/site_priors.h"
#include "missions/site_data/surface_points.h"

namespace skycap::missions::package {
namespace {

using site_data::SurfaceKind;

/// Maximum number of points on an object, which resolves fractions of 0.1%.
constexpr std::size_t max_points = 100'000;

/// Number of points per radius, where this gives fewer points.
constexpr double points_per_radius = 2.0;

struct NamedKind {
  SurfaceKind kind;
  const char* name;
};
constexpr std::array<NamedKind, 4> reported_kinds{{{SurfaceKind::wall, "wall"},
                                                   {SurfaceKind::roof, "roof"},
                                                   {SurfaceKind::opening, "opening"},
                                                   {SurfaceKind::other, "other"}}};

template <typename IsMeant>
CoveredPart make_part(const std::string& name, const site_data::SurfacePoints& points,
                      std::span<const std::uint8_t> is_covered, IsMeant is_meant) {
  std::size_t all = 0, covered = 0;
  for (std::size_t i = 0; i < points.kinds.size(); ++i) {
    if (!is_meant(points.kinds[i])) continue;
    ++all;
    covered += is_covered[i];
  }
  return {name, points.area_per_point * static_cast<double>(all),
          all > 0 ? static_cast<double>(covered) / static_cast<double>(all) : 0.0};
}

std::string to_string(const CoveredPart& part) {
  return fmt::format("{:.2f}% of {:.4g} m^2", 100.0 * part.covered, part.area);
}

}  // namespace

struct TargetMeter::Target {
  const site_data::Object* object;
  site_data::SurfacePoints points;
  double radius;
  evaluation::CoverageMeter meter;

  TargetCoverage coverage() const {
    const auto& is_covered = meter.is_covered();
    TargetCoverage coverage{.radius = radius};
    coverage.object = make_part(object->id, points, is_covered, [](SurfaceKind) { return true; });
    for (const auto& [kind, name] : reported_kinds) {
      const auto is_meant = [kind = kind](SurfaceKind other) { return other == kind; };
      CoveredPart part = make_part(name, points, is_covered, is_meant);
      if (part.area > 0.0) coverage.kinds.push_back(std::move(part));
    }
    return coverage;
  }
};

TargetMeter::TargetMeter(const scene::SceneOptions& scene, double registration_distance) {
  if (!scene.priors) return;
  const site_data::SitePriors& site = *scene.priors;
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != site_data::Role::target) continue;
    const double radius = registration_distance + site.priors[i].uncertainty;
    for (const site_data::Object& object : site.priors[i].objects) {
      site_data::SurfacePoints points =
          site_data::spread_over(object, max_points, radius / points_per_radius);
      if (points.positions.empty()) continue;
      evaluation::CoverageMeter meter(points.positions, radius);
      targets_.push_back({&object, std::move(points), radius, std::move(meter)});
    }
  }
}

TargetMeter::TargetMeter(TargetMeter&&) noexcept = default;
TargetMeter::~TargetMeter() = default;

void TargetMeter::add(std::span<const Eigen::Vector3f> measured) {
  for (Target& target : targets_) target.meter.add(measured);
}

std::vector<TargetCoverage> TargetMeter::coverage() const {
  std::vector<TargetCoverage> all;
  for (const Target& target : targets_) all.push_back(target.coverage());
  return all;
}

std::vector<TargetCoverage> target_coverage(const scene::SceneOptions& scene,
                                            double registration_distance,
                                            std::span<const Eigen::Vector3f> measured) {
  TargetMeter meter(scene, registration_distance);
  meter.add(measured);
  return meter.coverage();
}

std::string target_text(const std::vector<TargetCoverage>& targets, const std::string& label) {
  std::string text;
  for (const TargetCoverage& target : targets) {
    text += fmt::format("  {:<9} {}: {}", label, target.object.name, to_string(target.object));
    for (const CoveredPart& kind : target.kinds) text += ", " + kind.name + " " + to_string(kind);
    text += fmt::format("; within {:.2f} m of the map's surface\n", target.radius);
  }
  return text;
}

}  // namespace skycap::missions::package
