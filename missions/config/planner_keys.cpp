// Keys of the section `planner`.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::config {
namespace {

using See = survey::see::SeeConfig;

/// Returns an accessor of a member of SEE's settings.
auto see(auto member) {
  return [member](auto& m) -> auto& { return m.planner.see.*member; };
}

/// Returns an accessor of a member of the sampling settings of all planners.
auto sampling(auto member) {
  return [member](auto& m) -> auto& { return m.planner.sampling.*member; };
}

Key ablation_switch(const std::string& name, bool survey::surfel::AblationSwitches::*member,
                    const std::string& meaning) {
  return boolean_key(
      "planner.ablation." + name, [member](auto& m) -> auto& { return m.planner.ablation.*member; },
      "skycap: " + meaning);
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
          "skycap with a vehicle, otherwise see++",
          choice_key(
              "planner.name", planner_words(), [](auto& m) -> auto& { return m.planner.name; },
              "Planner. skycap: the planner of this program; uses spacing, view_distance, "
              "scene_box, target_coverage and min_gain of the keys below. see++: SEE++. see: "
              "see++ without optimise_views and visibility_graph. rsv, rse, oa, uv, pc, af, ae: "
              "volumetric; use resolution_radius as voxel width, spacing, view_distance, "
              "scene_box and the section volumetric. pb-nbv, pb-nbv-released: PB-NBV as published "
              "and as in its released code; section pb_nbv. uniform, random: fixed views without "
              "planning; section uniform. nadir, oblique, dome, facade, rings, corridor: standard "
              "patterns around a known target; section pattern. external: the planner in "
              "planner.file.")),
      otherwise(
          "none",
          text_key(
              "planner.file", [](auto& m) -> auto& { return m.planner.file; },
              "Custom planner, used if planner.name is external: a shared library (.so) or a "
              "Python "
              "file (.py), relative to the mission file. The file is code: it is executed only if "
              "the command line names it (--planner FILE), never because a mission file does.")),
      choice_key(
          "planner.preset", {"paper", "building"},
          [](auto& m) -> auto& { return m.planner.preset; },
          "Preset whose values the keys below override. paper: as published. building: tuned for "
          "buildings."),
      otherwise(
          "minutes with a vehicle, otherwise views",
          choice_key(
              "planner.goal", {"minutes", "views"}, [](auto& m) -> auto& { return m.planner.goal; },
              "Goal of the planner skycap: minimise the flight time or the number of views. "
              "minutes: the cost of a view is its stop or, without a vehicle, one view distance of "
              "path. views: the cost of a view is three view distances.")),
  };
}

/// Returns the keys of point storage and classification.
std::vector<Key> density_keys() {
  const auto scene_box = [](auto& m) -> auto& { return m.planner.sampling.scene_box; };
  return {
      number_key("planner.density", "points/m^3", above(0, 1e12),
                 sampling(&SamplingSection::density), "rho: required density of the measurements."),
      otherwise(
          "from planner.density",
          number_key("planner.density_per_m2", "points/m^2", between(1e-4, 1e8),
                     sampling(&SamplingSection::density_per_m2),
                     "Required number of stored points per square metre of surface; replaces "
                     "planner.density. The default values of spacing, resolution_radius and "
                     "view_distance are derived from it. The planner skycap plans until a stored "
                     "point is within 0.62 n^(-1/2) of each position, where n is this density. "
                     "Requires the planner skycap, see++ or see.")),
      number_key("planner.resolution_radius", "m", above(0, 1e3),
                 sampling(&SamplingSection::resolution_radius),
                 "r: radius in which the density is counted."),
      number_key(
          "planner.occlusion_search_distance", "m", above(0, 1e6),
          see(&See::occlusion_search_distance),
          "psi: distance from a frontier up to which occluding measurements are searched for."),
      integer_key("planner.visibility_update_limit", "views", between(1, 1e6),
                  see(&See::visibility_update_limit),
                  "tau: number of views nearest to the sensor that are updated after a scan."),
      otherwise("ceil(4/3 pi r^3 rho); with planner.preset: building, 1.09 (r/epsilon)^2 (rounded) "
                "if that is larger",
                integer_key("planner.core_threshold", "points", between(1, 1e6),
                            see(&See::core_threshold),
                            "k: minimum number of points within r of a core point, including the "
                            "core point itself.")),
      otherwise(
          "rho^(-1/2), or 0.8 evaluation.coverage_distance if smaller, but at least the distance "
          "between adjacent camera rays at the view distance",
          number_key("planner.spacing", "m", above(0, 1e3), sampling(&SamplingSection::spacing),
                     "epsilon: minimum spacing of stored measurements.")),
      otherwise("derived from the sensor and rho",
                number_key("planner.view_distance", "m", above(0, 1e6),
                           sampling(&SamplingSection::view_distance),
                           "d: distance between a frontier and the view proposed for it.")),
      otherwise(
          "unlimited",
          box_corner(
              "planner.scene_box.min", scene_box, false,
              "Lower corner of the region of interest. Measurements outside it are discarded.")),
      otherwise("unlimited", box_corner("planner.scene_box.max", scene_box, true,
                                        "Upper corner of the region of interest.")),
      choice_key("planner.outlier_rule", {"non_core", "labelled"}, see(&See::outlier_rule),
                 "Neighbours that turn a point near a core point into a frontier. non_core: any "
                 "other non-core point. labelled: a point labelled as an outlier (released code; "
                 "depends on the order)."),
      otherwise("k", integer_key("planner.frame_neighbours", "points", between(3, 1000),
                                 see(&See::frame_neighbours),
                                 "Number of nearest points used to estimate a frontier's normal, "
                                 "including the frontier point itself.")),
      boolean_key("planner.free_space_normals", see(&See::free_space_normals),
                  "Flip normals that point into measured surface."),
  };
}

/// Returns the keys of frontier occlusion and of the search for unoccluded views.
std::vector<Key> occlusion_keys() {
  return {
      choice_key("planner.offset_line", {"sight_line", "normal"}, see(&See::offset_line),
                 "Line along which the start of the occlusion test (zeta) is searched for."),
      otherwise("r", number_key("planner.occlusion_radius", "m", between(1e-4, 1e3),
                                see(&See::occlusion_radius),
                                "Ball radius and step of the occlusion test.")),
      choice_key("planner.march_end", {"search_distance", "search_distance_from_offset"},
                 see(&See::march_end), "End of the occlusion test: psi or zeta + psi."),
      boolean_key("planner.optimise_views", see(&See::optimise_views),
                  "Propose views of occluded frontiers from an unoccluded direction (SEE++)."),
      choice_key(
          "planner.cap.policy", {"local", "global", "nonlinear_program"},
          [](auto& m) -> auto& { return m.planner.see.cap.policy; },
          "Choice of the unoccluded direction. local: descent from the observing direction to a "
          "local optimum. "
          "global: centre of the largest empty cap. nonlinear_program: solution of the published "
          "nonlinear program with NLopt."),
      integer_key(
          "planner.cap.max_evaluations", "", between(1, 1e6),
          [](auto& m) -> auto& { return m.planner.see.cap.max_evaluations; },
          "Maximum number of evaluations in each of the two optimisations of nonlinear_program."),
      choice_key("planner.observing_direction", {"ray", "image_axis"},
                 see(&See::observing_direction),
                 "Direction from which a point counts as observed: along its ray or along the "
                 "optical axis."),
      number_key("planner.occluder_spacing", "m", above(0, 1e3), see(&See::occluder_spacing),
                 "Spacing of the sparse cloud used to find the unoccluded direction."),
      otherwise("give_up; with the preset building: defer",
                choice_key("planner.still_occluded", {"give_up", "defer", "keep"},
                           see(&See::still_occluded),
                           "Treatment of frontiers that are still occluded after view "
                           "optimisation: give_up (discard), defer (observe last, from the "
                           "position of their first observation) or keep (observe anyway).")),
  };
}

/// Returns the keys of view selection and of discarding frontiers.
std::vector<Key> view_selection_keys() {
  return {
      boolean_key("planner.visibility_graph", see(&See::visibility_graph),
                  "Weight views by the number of frontiers that they observe (SEE++)."),
      boolean_key("planner.facing_test", see(&See::facing_test),
                  "Count a frontier as seen only if it is viewed from the side of its normal."),
      boolean_key("planner.field_of_view_test", see(&See::field_of_view_test),
                  "Count a frontier as seen only if it is inside the image of the view."),
      number_key(
          "planner.first_view_weight", "", between(0, 1e6), see(&See::first_view_weight),
          "Weight of the distance to the first view when SEE searches for the nearest view."),
      choice_key("planner.nearest", {"exact", "octree"}, see(&See::nearest),
                 "Search method for the nearest view. exact: exact search. octree: approximate "
                 "octree search, as in the released code."),
      choice_key("planner.adjustment", {"rotation", "shift", "none"}, see(&See::adjustment),
                 "Adjustment of a view that failed to resolve its frontier."),
      choice_key("planner.adjustment_centroid", {"whole_scan", "accepted_points"},
                 see(&See::adjustment_centroid),
                 "Points whose centroid is used as the observed surface in the adjustment."),
      integer_key("planner.max_attempts", "views", between(1, 1e6), see(&See::max_attempts),
                  "Maximum number of views of one frontier before it is discarded."),
      boolean_key("planner.stay_on_target", see(&See::stay_on_target),
                  "Aim at one frontier until it is resolved or discarded."),
      number_key("planner.frontier_spacing", "m", between(0, 1e3), see(&See::frontier_spacing),
                 "Distance within which views are proposed for one frontier only. 0: views are "
                 "proposed for every frontier."),
  };
}

std::vector<Key> skycap_keys() {
  using Stop = survey::surfel::StopRule;
  using Switches = survey::surfel::AblationSwitches;
  const auto stop = [](auto member) {
    return [member](auto& m) -> auto& { return m.planner.surfel_stop.*member; };
  };
  return {
      number_key(
          "planner.target_coverage", "fraction", above(0, 1), stop(&Stop::target_coverage),
          "The survey ends when skycap estimates that this fraction of the surface is covered."),
      number_key("planner.min_gain", "fraction", between(0, 1), stop(&Stop::min_gain),
                 "The survey ends when no view is predicted to add at least this fraction of the "
                 "known surface. If seven times the largest area covered by one view is smaller "
                 "than the known surface, it replaces the known surface. Planner skycap only."),
      ablation_switch(
          "coverage_model", &Switches::coverage_model,
          "weight surface observations by their noise; off: one observation is sufficient."),
      ablation_switch("unseen_surface", &Switches::surface_prediction,
                      "predict where the surface continues."),
      ablation_switch("free_space", &Switches::free_space,
                      "discard predicted surface that rays have passed through."),
      ablation_switch("learned_rates", &Switches::learned_rates,
                      "weight predicted surface by the success of earlier predictions."),
      ablation_switch("targeted_views", &Switches::targeted_views,
                      "propose views of missing surface; off: use fixed directions only."),
      ablation_switch("refinement", &Switches::refinement,
                      "optimise the best views around their target."),
      ablation_switch("batch", &Switches::batch,
                      "plan several views ahead; off: the next best view only."),
  };
}

}  // namespace

std::vector<Key> planner_keys() {
  return joined(
      {which_planner(), density_keys(), occlusion_keys(), view_selection_keys(), skycap_keys()});
}

}  // namespace skycap::missions::config
