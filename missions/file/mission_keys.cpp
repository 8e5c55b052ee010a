#include "missions/file/mission_keys.h"

#include <algorithm>
#include <iterator>

#include "missions/file/key_builders.h"
#include "missions/file/volumetric_keys.h"

namespace skycap::missions::file {
namespace {

std::vector<Key> general_keys() {
  return {
      otherwise("the file's name", text(
                                       "name", [](Mission & m) -> auto& { return m.name; },
                                       "Names the folder of the results.")),
      integer(
          "seed", "", between(0, 1e15), [](Mission & m) -> auto& { return m.seed; },
          "Of the start view and the sensor's noise; the same seed gives the same results."),
      integer(
          "threads", "", between(0, 1024), [](Mission & m) -> auto& { return m.threads; },
          "How many threads to use, 0 for all processors; does not change the results."),
  };
}

Key copies_key() {
  Key key = key_for(
      "scene.copies", KeyType::vectors, [](Mission & m) -> auto& { return m.scene.copies; },
      "The same model at more places, each [east, north, turn_deg]: metres from position, and "
      "a turn anticlockwise about its own upright.");
  key.range = between(-1e6, 1e6);
  const auto turned = [](const KeyValue& value, double factor) {
    auto copies = std::get<std::vector<Eigen::Vector3d>>(value);
    for (Eigen::Vector3d& copy : copies) copy.z() *= factor;
    return copies;
  };
  key.set = [set = key.set, turned](Mission& mission, const KeyValue& value) {
    set(mission, turned(value, radians_per_degree));
  };
  key.get = [get = key.get, turned](const Mission& mission) -> std::optional<KeyValue> {
    return turned(*get(mission), 1.0 / radians_per_degree);
  };
  return key;
}

Key detail_key() {
  Key key = choice(
      "scene.detail", {"coarse", "standard", "fine"},
      [](Mission & m) -> auto& { return m.scene.detail; },
      "Level of detail of a builtin model: the same shape in more and smaller triangles.");
  key.get = [get = key.get](const Mission& mission) -> std::optional<KeyValue> {
    if (!mission.scene.model.starts_with("builtin:")) return std::nullopt;
    return get(mission);
  };
  return otherwise("standard", key);
}

std::vector<Key> scene_keys() {
  return {
      required(text(
          "scene.model", [](Mission & m) -> auto& { return m.scene.model; },
          "What is surveyed: builtin:NAME, model:NAME, or the path of a PLY, OBJ, STL or "
          "OFF file, relative to the mission file.")),
      detail_key(),
      choice(
          "scene.up_axis", {"z", "y"}, [](Mission & m) -> auto& { return m.scene.up_axis; },
          "Which axis of the model's own frame points up."),
      vector(
          "scene.rotation_deg", "degrees", between(-360, 360),
          [](Mission & m) -> auto& { return m.scene.rotation; },
          "Turns the upright model about the x, then the y, then the z axis."),
      otherwise("the model's own size",
                number(
                    "scene.longest_side", "m", above(0, 1e6),
                    [](Mission & m) -> auto& { return m.scene.longest_side; },
                    "Scales the model until the longest side of its bounding box has this "
                    "length.")),
      otherwise("1", number(
                         "scene.scale", "", above(0, far_away),
                         [](Mission & m) -> auto& { return m.scene.scale; },
                         "Scales the model by a factor, in place of longest_side.")),
      vector(
          "scene.position", "m", between(-1e6, 1e6),
          [](Mission & m) -> auto& { return m.scene.position; },
          "Where the middle of the base of the model's bounding box is put."),
      copies_key(),
      boolean(
          "scene.ground", [](Mission & m) -> auto& { return m.scene.ground; },
          "Whether the sensor also sees a ground plane under the model. It is not part of the "
          "coverage; planner.scene_box has to keep it out of the plan."),
  };
}

std::vector<Key> sensor_keys() {
  return {
      choice(
          "sensor.preset", {"d435", "high_resolution"},
          [](Mission & m) -> auto& { return m.sensor.preset; },
          "Depth camera whose values the keys below override: d435 is an Intel RealSense D435 "
          "(848 x 480 pixels, 69.4 x 42.5 degrees), high_resolution the paper's for buildings "
          "(2400 x 1750 pixels, 60 x 40 degrees)."),
      otherwise("-", text(
                         "sensor.lidar", [](Mission & m) -> auto& { return m.sensor.lidar; },
                         "In place of a depth camera, a spinning laser scanner that stops at each "
                         "view and turns once: a preset of sim/sensors/presets, or the path of a "
                         "description (NAME.yaml), relative to the mission file. No other key of "
                         "the section sensor goes with it.")),
      integer(
          "sensor.width", "px", between(1, 32768),
          [](Mission & m) -> auto& { return m.sensor.camera.camera.width; },
          "Columns of the image."),
      integer(
          "sensor.height", "px", between(1, 32768),
          [](Mission & m) -> auto& { return m.sensor.camera.camera.height; }, "Rows of the image."),
      number(
          "sensor.horizontal_fov_deg", "degrees", between(0.1, 179),
          [](Mission & m) -> auto& { return m.sensor.camera.camera.horizontal_fov; },
          "Full horizontal angle of view."),
      number(
          "sensor.vertical_fov_deg", "degrees", between(0.1, 179),
          [](Mission & m) -> auto& { return m.sensor.camera.camera.vertical_fov; },
          "Full vertical angle of view."),
      number(
          "sensor.min_range", "m", between(0, 1e6),
          [](Mission & m) -> auto& { return m.sensor.camera.camera.min_range; },
          "Nearest depth, along the optical axis, that is measured."),
      number(
          "sensor.max_range", "m", above(0, 1e6),
          [](Mission & m) -> auto& { return m.sensor.camera.camera.max_range; },
          "Farthest depth, along the optical axis, that is measured."),
      number(
          "sensor.max_incidence_deg", "degrees", above(0, 90),
          [](Mission & m) -> auto& { return m.sensor.camera.max_incidence; },
          "Surfaces whose normal makes a larger angle than this with the ray give no return; 90 "
          "switches the limit off."),
      number(
          "sensor.noise.sigma", "m", between(0, 1e3),
          [](Mission & m) -> auto& { return m.sensor.camera.noise.sigma; },
          "Standard deviation of the Gaussian noise of the measured points."),
      choice(
          "sensor.noise.direction", {"isotropic", "along_ray"},
          [](Mission & m) -> auto& { return m.sensor.camera.noise.direction; },
          "Whether the noise moves a point in x, y and z alike or along its ray only."),
  };
}

std::vector<Key> survey_keys() {
  return {
      otherwise("at random",
                vector(
                    "start.position", "m", between(-1e6, 1e6),
                    [](Mission & m) -> auto& { return m.start.position; },
                    "Where the first view is taken from. At random: in a direction drawn by the "
                    "seed, as far from the surface's centroid as the view distance and the mean "
                    "distance of the surface to it, looking at it.")),
      otherwise("-", vector(
                         "start.look_at", "m", between(-1e6, 1e6),
                         [](Mission & m) -> auto& { return m.start.look_at; },
                         "A point that the first view looks at.")),
      otherwise("-", vector(
                         "start.direction", "", between(-1e6, 1e6),
                         [](Mission & m) -> auto& { return m.start.direction; },
                         "Which way the first view looks, in place of look_at.")),
      integer(
          "limits.max_views", "", between(1, 1e6),
          [](Mission & m) -> auto& { return m.limits.max_views; },
          "The survey ends after this many views."),
      otherwise("unlimited",
                number(
                    "limits.max_distance", "m", above(0, 1e9),
                    [](Mission & m) -> auto& { return m.limits.max_distance; },
                    "The survey ends when the straight lines between views add up to this.")),
      otherwise("with a vehicle flight.clearance and 0.01, with ground 0, else unlimited",
                number(
                    "limits.ground_clearance", "m", between(-1e6, 1e6),
                    [](Mission & m) -> auto& { return m.limits.ground_clearance; },
                    "Least height of a view above the scene's base.")),
      required(number(
          "evaluation.registration_distance", "m", above(0, 1e3),
          [](Mission & m) -> auto& { return m.evaluation.registration_distance; },
          "r_d: a surface sample with a stored measurement this near is covered.")),
      integer(
          "evaluation.samples", "", between(100, 1e8),
          [](Mission & m) -> auto& { return m.evaluation.samples; },
          "Points spread evenly over the surface, by which coverage is measured."),
      integer(
          "evaluation.visible_directions", "", between(1, 1e4),
          [](Mission & m) -> auto& { return m.evaluation.visible_directions; },
          "Directions, spread over the sphere, from which a sample may be seen at the view "
          "distance; if none is free it does not count as visible."),
      integer(
          "evaluation.ceiling_views", "", between(0, 1e4),
          [](Mission & m) -> auto& { return m.evaluation.ceiling_views; },
          "Views that the attainable coverage is measured with; 0 leaves it out."),
      otherwise("-",
                number(
                    "paper.views", "", above(0), [](Mission & m) -> auto& { return m.paper.views; },
                    "Views a publication needed, printed beside the results of trials.")),
      otherwise("-", number(
                         "paper.coverage", "share", between(0, 1),
                         [](Mission & m) -> auto& { return m.paper.coverage; },
                         "Coverage a publication reached.")),
      otherwise("-", number(
                         "paper.planning_time", "s", above(0),
                         [](Mission & m) -> auto& { return m.paper.planning_time; },
                         "Planning time of a publication, for a survey.")),
      otherwise("-", number(
                         "paper.distance", "m", above(0),
                         [](Mission & m) -> auto& { return m.paper.distance; },
                         "Distance a publication's sensor travelled.")),
  };
}

std::vector<Key> planner_keys() {
  const auto see = [](auto member) {
    return [member](Mission & m) -> auto& { return m.planner.see.*member; };
  };
  const auto scene_box = [](Mission & m) -> auto& { return m.planner.see.scene_box; };
  using See = survey::see::SeeConfig;
  const auto skycap_stop = [](auto member) {
    return [member](Mission & m) -> auto& { return m.planner.skycap_stop.*member; };
  };
  using Stop = survey::skycap::StopRule;
  return {
      otherwise(
          "skycap with a vehicle, else see++",
          choice(
              "planner.name",
              {"see++", "see", "skycap", "rsv", "rse", "oa", "uv", "pc", "af", "ae"},
              [](Mission & m) -> auto& { return m.planner.name; },
              "The planner. see is see++ without optimise_views and visibility_graph; skycap is "
              "our "
              "own, which of the keys below uses spacing, view_distance, scene_box, "
              "wanted_coverage "
              "and least_gain. The others are volumetric: of the keys below they use "
              "resolution_radius as the width of voxels, spacing, view_distance and scene_box, and "
              "those of the section volumetric.")),
      choice(
          "planner.preset", {"paper", "building"},
          [](Mission & m) -> auto& { return m.planner.preset; },
          "Values that the keys below override: paper as published, building as described "
          "below."),
      number("planner.density", "points/m^3", above(0, 1e12), see(&See::density),
             "rho: wanted density of the measurements."),
      number("planner.resolution_radius", "m", above(0, 1e3), see(&See::resolution_radius),
             "r: radius in which the density is counted."),
      number("planner.occlusion_search_distance", "m", above(0, 1e6),
             see(&See::occlusion_search_distance),
             "psi: how far from a frontier occluding measurements are looked for."),
      integer("planner.visibility_update_limit", "views", between(1, 1e6),
              see(&See::visibility_update_limit),
              "tau: how many views nearest the sensor are kept up to date after a scan."),
      otherwise(
          "ceil(4/3 pi r^3 rho)",
          integer("planner.core_threshold", "points", between(1, 1e6), see(&See::core_threshold),
                  "k: points within r, itself counted, that make a point core.")),
      otherwise("rho^(-1/2)", number("planner.spacing", "m", above(0, 1e3), see(&See::spacing),
                                     "epsilon: least distance of stored measurements.")),
      otherwise("from the sensor and rho",
                number("planner.view_distance", "m", above(0, 1e6), see(&See::view_distance),
                       "d: distance from a frontier to the view proposed for it.")),
      otherwise("unlimited",
                box_corner("planner.scene_box.min", scene_box, false,
                           "Lower corner of the box outside which measurements are dropped.")),
      otherwise("unlimited",
                box_corner("planner.scene_box.max", scene_box, true, "Upper corner of that box.")),
      choice("planner.outlier_rule", {"non_core", "labelled"}, see(&See::outlier_rule),
             "Which neighbours make a point beside a core point a frontier: any other that is not "
             "core, or one labelled outlier (released code, depends on the order)."),
      otherwise("k", integer("planner.frame_neighbours", "points", between(3, 1000),
                             see(&See::frame_neighbours),
                             "Nearest points, itself counted, that a frontier's normal is "
                             "estimated from.")),
      boolean("planner.free_space_normals", see(&See::free_space_normals),
              "Whether normals that point into measured surface are turned round."),
      choice("planner.offset_line", {"sight_line", "normal"}, see(&See::offset_line),
             "Along which line the start of the occlusion test (zeta) is looked for."),
      otherwise("r",
                number("planner.occlusion_radius", "m", above(0, 1e3), see(&See::occlusion_radius),
                       "Ball radius and step of the occlusion test.")),
      choice("planner.march_end", {"search_distance", "search_distance_from_offset"},
             see(&See::march_end), "Whether the occlusion test ends at psi or at zeta + psi."),
      boolean("planner.optimise_views", see(&See::optimise_views),
              "Whether occluded frontiers are given a view from a clear direction (SEE++)."),
      choice(
          "planner.cap.policy", {"local", "global", "nonlinear_program"},
          [](Mission & m) -> auto& { return m.planner.see.cap.policy; },
          "Which clear direction: the one downhill from the observing direction, the centre of "
          "the largest empty cap, or what the published program finds with NLopt."),
      integer(
          "planner.cap.max_evaluations", "", between(1, 1e6),
          [](Mission & m) -> auto& { return m.planner.see.cap.max_evaluations; },
          "Evaluations in each of the published program's two optimisations."),
      choice("planner.observing_direction", {"ray", "image_axis"}, see(&See::observing_direction),
             "What is called the observing direction of a point: its ray, or the optical axis."),
      number("planner.occluder_spacing", "m", above(0, 1e3), see(&See::occluder_spacing),
             "Spacing of the sparse cloud in which the clear direction is looked for."),
      boolean("planner.drop_if_still_occluded", see(&See::drop_if_still_occluded),
              "Whether frontiers that even the optimised view does not see are given up."),
      boolean("planner.visibility_graph", see(&See::visibility_graph),
              "Whether views are weighed by how many frontiers they see (SEE++)."),
      boolean("planner.facing_test", see(&See::facing_test),
              "Whether a frontier counts as seen only from the side of its normal."),
      boolean("planner.field_of_view_test", see(&See::field_of_view_test),
              "Whether a frontier counts as seen only inside the view's image."),
      number("planner.first_view_weight", "", between(0, 1e6), see(&See::first_view_weight),
             "SEE adds this times the distance to the first view when it looks for the nearest."),
      choice("planner.nearest", {"exact", "octree"}, see(&See::nearest),
             "How the nearest view is found: exactly, or with an approximate octree as in the "
             "released code."),
      choice("planner.adjustment", {"rotation", "shift", "none"}, see(&See::adjustment),
             "How a view is moved that failed to resolve its frontier."),
      choice("planner.adjustment_centroid", {"whole_scan", "accepted_points"},
             see(&See::adjustment_centroid),
             "Whose centroid tells the adjustment where the surface was seen."),
      integer("planner.max_attempts", "views", between(1, 1e6), see(&See::max_attempts),
              "Views aimed at one frontier before it is given up."),
      boolean("planner.stay_on_target", see(&See::stay_on_target),
              "Whether views aim at one frontier until it is resolved or given up."),
      number("planner.frontier_spacing", "m", between(0, 1e3), see(&See::frontier_spacing),
             "Views are proposed for one frontier within this distance; 0 for every one."),
      number("planner.wanted_coverage", "share", above(0, 1), skycap_stop(&Stop::wanted_coverage),
             "skycap ends when it believes this share of the surface covered."),
      number("planner.least_gain", "share", between(0, 1), skycap_stop(&Stop::least_gain),
             "skycap ends when no view promises this share of the known surface, or of seven times "
             "what one view covered at most, if that is less."),
  };
}

}  // namespace

std::span<const Key> mission_keys() {
  static const std::vector<Key> keys = [] {
    std::vector<Key> all = general_keys();
    for (auto section : {scene_keys, sensor_keys, planner_keys, volumetric_keys, survey_keys,
                         constraint_keys, flight_keys, scan_keys}) {
      std::ranges::move(section(), std::back_inserter(all));
    }
    return all;
  }();
  return keys;
}

const Key* find_key(std::string_view path) {
  const auto keys = mission_keys();
  const auto key = std::ranges::find(keys, path, &Key::path);
  return key == keys.end() ? nullptr : &*key;
}

}  // namespace skycap::missions::file
