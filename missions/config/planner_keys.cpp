// The keys of `planner`.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::config {
namespace {

using See = survey::see::SeeConfig;

/// The field of SEE's settings that `member` points to.
auto see(auto member) {
  return [member](auto& m) -> auto& { return m.planner.see.*member; };
}

/// The same of what every planner uses.
auto sampling(auto member) {
  return [member](auto& m) -> auto& { return m.planner.sampling.*member; };
}

Key idea(const std::string& name, bool survey::skycap::SkycapIdeas::*member,
         const std::string& meaning) {
  return boolean_key(
      "planner.ideas." + name,
      [member](auto& m) -> auto& { return m.planner.skycap_ideas.*member; }, "skycap: " + meaning);
}

std::vector<std::string> planner_words() {
  std::vector<std::string> words;
  words.reserve(std::size(survey::planner_titles));
  for (const survey::PlannerTitle& planner : survey::planner_titles)
    words.emplace_back(planner.word);
  return words;
}

std::vector<Key> which_planner() {
  return {
      otherwise(
          "skycap with a vehicle, else see++",
          choice_key(
              "planner.name", planner_words(), [](auto& m) -> auto& { return m.planner.name; },
              "The planner. see is see++ without optimise_views and visibility_graph; skycap is "
              "our "
              "own, which of the keys below uses spacing, view_distance, scene_box, "
              "wanted_coverage "
              "and least_gain. The others are volumetric: of the keys below they use "
              "resolution_radius as the width of voxels, spacing, view_distance and scene_box, and "
              "those of the section volumetric.")),
      choice_key(
          "planner.preset", {"paper", "building"},
          [](auto& m) -> auto& { return m.planner.preset; },
          "Values that the keys below override: paper as published, building as described "
          "below."),
      otherwise(
          "minutes with sensor.capture: moving, else views",
          choice_key(
              "planner.goal", {"minutes", "views"}, [](auto& m) -> auto& { return m.planner.goal; },
              "What skycap spares. minutes: a view costs what its stop costs, or without a vehicle "
              "one view distance of way; views: it costs three view distances.")),
  };
}

/// How measurements are kept and classified.
std::vector<Key> density_keys() {
  const auto scene_box = [](auto& m) -> auto& { return m.planner.sampling.scene_box; };
  return {
      number_key("planner.density", "points/m^3", above(0, 1e12),
                 sampling(&SamplingSection::density), "rho: wanted density of the measurements."),
      number_key("planner.resolution_radius", "m", above(0, 1e3),
                 sampling(&SamplingSection::resolution_radius),
                 "r: radius in which the density is counted."),
      number_key("planner.occlusion_search_distance", "m", above(0, 1e6),
                 see(&See::occlusion_search_distance),
                 "psi: how far from a frontier occluding measurements are looked for."),
      integer_key("planner.visibility_update_limit", "views", between(1, 1e6),
                  see(&See::visibility_update_limit),
                  "tau: how many views nearest the sensor are kept up to date after a scan."),
      otherwise(
          "ceil(4/3 pi r^3 rho); in preset building 1.09 (r/epsilon)^2, rounded, if that is more",
          integer_key("planner.core_threshold", "points", between(1, 1e6),
                      see(&See::core_threshold),
                      "k: points within r, itself counted, that make a point core.")),
      otherwise(
          "rho^(-1/2), or 0.8 evaluation.registration_distance if that is less, but then no less "
          "than a camera's rays are apart at the view distance",
          number_key("planner.spacing", "m", above(0, 1e3), sampling(&SamplingSection::spacing),
                     "epsilon: least distance of stored measurements.")),
      otherwise("from the sensor and rho",
                number_key("planner.view_distance", "m", above(0, 1e6),
                           sampling(&SamplingSection::view_distance),
                           "d: distance from a frontier to the view proposed for it.")),
      otherwise("unlimited",
                box_corner("planner.scene_box.min", scene_box, false,
                           "Lower corner of the box outside which measurements are dropped.")),
      otherwise("unlimited",
                box_corner("planner.scene_box.max", scene_box, true, "Upper corner of that box.")),
      choice_key(
          "planner.outlier_rule", {"non_core", "labelled"}, see(&See::outlier_rule),
          "Which neighbours make a point beside a core point a frontier: any other that is not "
          "core, or one labelled outlier (released code, depends on the order)."),
      otherwise("k", integer_key("planner.frame_neighbours", "points", between(3, 1000),
                                 see(&See::frame_neighbours),
                                 "Nearest points, itself counted, that a frontier's normal is "
                                 "estimated from.")),
      boolean_key("planner.free_space_normals", see(&See::free_space_normals),
                  "Whether normals that point into measured surface are turned round."),
  };
}

/// What hides frontiers, and where a clear view of them is looked for.
std::vector<Key> occlusion_keys() {
  return {
      choice_key("planner.offset_line", {"sight_line", "normal"}, see(&See::offset_line),
                 "Along which line the start of the occlusion test (zeta) is looked for."),
      otherwise("r", number_key("planner.occlusion_radius", "m", between(1e-4, 1e3),
                                see(&See::occlusion_radius),
                                "Ball radius and step of the occlusion test.")),
      choice_key("planner.march_end", {"search_distance", "search_distance_from_offset"},
                 see(&See::march_end), "Whether the occlusion test ends at psi or at zeta + psi."),
      boolean_key("planner.optimise_views", see(&See::optimise_views),
                  "Whether occluded frontiers are given a view from a clear direction (SEE++)."),
      choice_key(
          "planner.cap.policy", {"local", "global", "nonlinear_program"},
          [](auto& m) -> auto& { return m.planner.see.cap.policy; },
          "Which clear direction: the one downhill from the observing direction, the centre of "
          "the largest empty cap, or what the published program finds with NLopt."),
      integer_key(
          "planner.cap.max_evaluations", "", between(1, 1e6),
          [](auto& m) -> auto& { return m.planner.see.cap.max_evaluations; },
          "Evaluations in each of the published program's two optimisations."),
      choice_key(
          "planner.observing_direction", {"ray", "image_axis"}, see(&See::observing_direction),
          "What is called the observing direction of a point: its ray, or the optical axis."),
      number_key("planner.occluder_spacing", "m", above(0, 1e3), see(&See::occluder_spacing),
                 "Spacing of the sparse cloud in which the clear direction is looked for."),
      otherwise("give_up; in preset building put_off",
                choice_key("planner.still_occluded", {"give_up", "put_off", "keep"},
                           see(&See::still_occluded),
                           "What becomes of frontiers that even the optimised view does not see: "
                           "given up, looked "
                           "at from where they were seen when nothing else is left, or looked at "
                           "all the same.")),
  };
}

/// Which view is next, and when a frontier is given up.
std::vector<Key> choice_of_view_keys() {
  return {
      boolean_key("planner.visibility_graph", see(&See::visibility_graph),
                  "Whether views are weighed by how many frontiers they see (SEE++)."),
      boolean_key("planner.facing_test", see(&See::facing_test),
                  "Whether a frontier counts as seen only from the side of its normal."),
      boolean_key("planner.field_of_view_test", see(&See::field_of_view_test),
                  "Whether a frontier counts as seen only inside the view's image."),
      number_key(
          "planner.first_view_weight", "", between(0, 1e6), see(&See::first_view_weight),
          "SEE adds this times the distance to the first view when it looks for the nearest."),
      choice_key("planner.nearest", {"exact", "octree"}, see(&See::nearest),
                 "How the nearest view is found: exactly, or with an approximate octree as in the "
                 "released code."),
      choice_key("planner.adjustment", {"rotation", "shift", "none"}, see(&See::adjustment),
                 "How a view is moved that failed to resolve its frontier."),
      choice_key("planner.adjustment_centroid", {"whole_scan", "accepted_points"},
                 see(&See::adjustment_centroid),
                 "Whose centroid tells the adjustment where the surface was seen."),
      integer_key("planner.max_attempts", "views", between(1, 1e6), see(&See::max_attempts),
                  "Views aimed at one frontier before it is given up."),
      boolean_key("planner.stay_on_target", see(&See::stay_on_target),
                  "Whether views aim at one frontier until it is resolved or given up."),
      number_key("planner.frontier_spacing", "m", between(0, 1e3), see(&See::frontier_spacing),
                 "Views are proposed for one frontier within this distance; 0 for every one."),
  };
}

std::vector<Key> skycap_keys() {
  using Stop = survey::skycap::StopRule;
  using Ideas = survey::skycap::SkycapIdeas;
  const auto stop = [](auto member) {
    return [member](auto& m) -> auto& { return m.planner.skycap_stop.*member; };
  };
  return {
      number_key("planner.wanted_coverage", "share", above(0, 1), stop(&Stop::wanted_coverage),
                 "skycap ends when it believes this share of the surface covered."),
      number_key("planner.least_gain", "share", between(0, 1), stop(&Stop::least_gain),
                 "skycap ends when no view promises this share of the known surface, or of "
                 "seven times what one view covered at most, if that is less."),
      idea("dose", &Ideas::dose, "weigh looks at a surface by the noise; off: one look covers it."),
      idea("unseen_surface", &Ideas::unseen_surface, "guess where the surface goes on."),
      idea("free_space", &Ideas::free_space, "drop guesses where the sensor saw through."),
      idea("learned_rates", &Ideas::learned_rates,
           "grade the guesses by what became of earlier ones."),
      idea("targeted_views", &Ideas::targeted_views,
           "propose views for what is missing; off: from fixed directions only."),
      idea("refinement", &Ideas::refinement, "move the best views about their target."),
      idea("batch", &Ideas::batch, "plan several views ahead; off: the best next one only."),
  };
}

}  // namespace

std::vector<Key> planner_keys() {
  return joined(
      {which_planner(), density_keys(), occlusion_keys(), choice_of_view_keys(), skycap_keys()});
}

}  // namespace skycap::missions::config
