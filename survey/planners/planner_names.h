/// Names of all planners in files and tables.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "survey/patterns/patterns.h"
#include "survey/volumetric/volumetric_config.h"

namespace skycap::survey {

enum class PlannerName {
  see_plus_plus,
  see,
  skycap,
  rsv,
  rse,
  oa,
  uv,
  pc,
  af,
  ae,
  pb_nbv,           ///< PB-NBV as published
  pb_nbv_released,  ///< PB-NBV as in the released code
  uniform,          ///< fixed views, evenly distributed: no planning
  random,           ///< fixed views, independently distributed: no planning
  nadir,            ///< standard patterns: no planning
  oblique,
  dome,
  facade,
  rings,
  corridor,
  external,  ///< planner of a user
};

struct PlannerTitle {
  PlannerName name;
  std::string_view word;   ///< value of planner.name in mission files and on the command line
  std::string_view title;  ///< name in tables and plots
  /// Gain metric of a volumetric planner; nullopt for other planners.
  std::optional<volumetric::VolumetricMetric> metric = std::nullopt;
};

/// Sorted in the order of PlannerName.
inline constexpr std::array<PlannerTitle, 21> planner_titles = [] {
  using enum PlannerName;
  using enum volumetric::VolumetricMetric;
  return std::array<PlannerTitle, 21>{{{see_plus_plus, "see++", "SEE++"},
                                       {see, "see", "SEE"},
                                       {skycap, "skycap", "Skycap"},
                                       {rsv, "rsv", "RSV", rear_side_voxel},
                                       {rse, "rse", "RSE", rear_side_entropy},
                                       {oa, "oa", "OA", occlusion_aware},
                                       {uv, "uv", "UV", unobserved_voxel},
                                       {pc, "pc", "PC", proximity_count},
                                       {af, "af", "AF", area_factor},
                                       {ae, "ae", "AE", average_entropy},
                                       {pb_nbv, "pb-nbv", "PB-NBV"},
                                       {pb_nbv_released, "pb-nbv-released", "PB-NBV (released)"},
                                       {uniform, "uniform", "Uniform"},
                                       {random, "random", "Random"},
                                       {nadir, "nadir", "Nadir"},
                                       {oblique, "oblique", "Oblique"},
                                       {dome, "dome", "Dome"},
                                       {facade, "facade", "Facade"},
                                       {rings, "rings", "Rings"},
                                       {corridor, "corridor", "Corridor"},
                                       {external, "external", "External"}}};
}();

static_assert([] {
  for (std::size_t i = 0; i < planner_titles.size(); ++i) {
    if (planner_titles[i].name != static_cast<PlannerName>(i)) return false;
  }
  return true;
}());

constexpr const PlannerTitle& find_title(PlannerName name) {
  return planner_titles[static_cast<std::size_t>(name)];
}

/// Returns whether the planner takes a fixed set of views without planning.
constexpr bool has_fixed_views(PlannerName name) {
  return name == PlannerName::uniform || name == PlannerName::random;
}

constexpr bool is_pb_nbv(PlannerName name) {
  return name == PlannerName::pb_nbv || name == PlannerName::pb_nbv_released;
}

/// Returns the pattern that replaces the planner, or nullopt for other planners.
constexpr std::optional<patterns::Pattern> pattern_of(PlannerName name) {
  if (name < PlannerName::nadir || name > PlannerName::corridor) return std::nullopt;
  return static_cast<patterns::Pattern>(static_cast<int>(name) -
                                        static_cast<int>(PlannerName::nadir));
}

/// Returns the planner with this name in files, or nullopt.
constexpr std::optional<PlannerName> planner_called(std::string_view word) {
  const auto found = std::ranges::find(planner_titles, word, &PlannerTitle::word);
  return found == planner_titles.end() ? std::nullopt : std::optional(found->name);
}

}  // namespace skycap::survey
