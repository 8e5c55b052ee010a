// Keys of the sections `uniform`, `pb_nbv` and `pattern`.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

using survey::fixed_views::FixedViewSettings;
using survey::patterns::PatternSettings;
using survey::pb_nbv::PbNbvSettings;

auto fixed(auto member) {
  return [member](auto& m) -> auto& { return m.planner.fixed_views.*member; };
}
auto pb(auto member) {
  return [member](auto& m) -> auto& { return m.planner.pb_nbv.*member; };
}

auto pattern(auto member) {
  return [member](auto& m) -> auto& { return m.planner.patterns.*member; };
}

}  // namespace

std::vector<Key> uniform_keys() {
  return {
      integer_key("uniform.views", "views", between(1, 1e4), fixed(&FixedViewSettings::views),
                  "N: total number of views of the planners uniform and random, including the "
                  "first view. The views are on the sphere that the section volumetric defines. By "
                  "default, its centre and radius are computed from the true surface."),
      choice_key(
          "uniform.set", {"fibonacci", "rings", "random"}, fixed(&FixedViewSettings::set),
          "Distribution of the views of the planner uniform. fibonacci: Fibonacci lattice. "
          "rings: horizontal rings. random: independent directions, as for the planner random."),
      integer_key("uniform.rings", "rings", between(1, 1000), fixed(&FixedViewSettings::rings),
                  "Number of rings with uniform.set: rings."),
      choice_key("uniform.order", {"tour", "spread"}, fixed(&FixedViewSettings::order),
                 "Order of the views of the planners uniform and random. tour: short open tour. "
                 "spread: each view is the one farthest from all earlier views."),
  };
}

std::vector<Key> pb_nbv_keys() {
  return {
      integer_key("pb_nbv.views", "views", between(1, 1e6), pb(&PbNbvSettings::views),
                  "Total number of views of the planners pb-nbv and pb-nbv-released, which have no "
                  "stopping rule."),
      integer_key("pb_nbv.candidates", "views", between(1, 1e6), pb(&PbNbvSettings::candidates),
                  "N: approximate number of candidate views."),
      integer_key("pb_nbv.parallels", "", between(2, 1000), pb(&PbNbvSettings::parallels),
                  "alpha: number of parallels on which the candidates are distributed."),
      integer_key("pb_nbv.sectors", "", between(1, 1000), pb(&PbNbvSettings::sectors),
                  "beta: number of sectors of the azimuth that are visited before views are chosen "
                  "freely."),
      integer_key("pb_nbv.max_ellipsoids", "", between(0, 1000), pb(&PbNbvSettings::max_ellipsoids),
                  "T_max: maximum number of ellipsoids for occupied voxels, and for frontiers. 0: "
                  "random choice of candidates (ablation)."),
      number_key("pb_nbv.growth", "voxels", between(0, 1000), pb(&PbNbvSettings::growth),
                 "gamma: growth of the box around frontiers."),
      otherwise("0.06 times the longest edge of the box of the first scan",
                number_key("pb_nbv.voxel", "m", above(0, 1e3), pb(&PbNbvSettings::voxel),
                           "Width of the voxels. The paper uses 0.03 m for objects of about 0.5 "
                           "m.")),
      otherwise("view distance",
                number_key("pb_nbv.working_distance", "m", above(0, 1e6),
                           pb(&PbNbvSettings::working_distance),
                           "d_c: distance of the candidates from the sphere around the box.")),
      choice_key("pb_nbv.region", {"sphere", "hemisphere"}, pb(&PbNbvSettings::region),
                 "Part of the sphere with candidates."),
  };
}

std::vector<Key> pattern_keys() {
  Key polygon = list_key("pattern.polygon", KeyType::polygon, pattern(&PatternSettings::polygon),
                         "Outline of the target of the planners nadir, oblique, dome, facade, "
                         "rings and corridor: corners [east, north] in the mission frame. Replaces "
                         "targets of prior data. Requires pattern.top.");
  Key line = list_key("pattern.line", KeyType::line, pattern(&PatternSettings::line),
                      "Line along the target of a pattern: points [east, north] in the mission "
                      "frame. Conflicts with pattern.polygon. Requires pattern.top.");
  polygon.unit = line.unit = "m";
  return {
      otherwise("outline of the prior data with role: target", polygon),
      otherwise("none; the planner corridor follows the long axis of the target", line),
      number_key("pattern.width", "m", between(0, 1e4), pattern(&PatternSettings::width),
                 "Width of the structure along pattern.line."),
      otherwise("ground",
                number_key("pattern.base", "m", between(-far_away, far_away),
                           pattern(&PatternSettings::base),
                           "z of the base of the target of pattern.polygon or pattern.line.")),
      otherwise("required with pattern.polygon and pattern.line",
                number_key("pattern.top", "m", between(-far_away, far_away),
                           pattern(&PatternSettings::top),
                           "z of the top of the target of pattern.polygon or pattern.line.")),
      number_key("pattern.forward_overlap", "fraction", between(0, 0.95),
                 pattern(&PatternSettings::forward_overlap),
                 "Overlap of consecutive views of a pattern at the view distance, as a fraction."),
      number_key("pattern.side_overlap", "fraction", between(0, 0.95),
                 pattern(&PatternSettings::side_overlap),
                 "Overlap of neighbouring rows of a pattern at the view distance, as a fraction."),
      otherwise("-45 for oblique and corridor, 0 for facade and rings",
                angle_key("pattern.pitch_deg", between(-90, 80), pattern(&PatternSettings::pitch),
                          "Pitch of the tilted grids of oblique, the rows of facade and corridor, "
                          "and rings. Negative is down. The default is changed to the nearest "
                          "pitch that gimbal and limits allow.")),
  };
}

}  // namespace skycap::missions::config
