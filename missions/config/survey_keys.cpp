// Keys of the sections `start`, `limits`, `evaluation` and `paper`.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

constexpr double right_angle = 90.0;  // [degrees]

}  // namespace

std::vector<Key> start_keys() {
  return {
      otherwise("random", vector_key(
                              "start.position", "m", between(-1e6, 1e6),
                              [](auto& m) -> auto& { return m.start.position; },
                              "Position of the first view. Random: in a direction derived from the "
                              "seed, at the view distance plus the mean distance of the surface "
                              "from its centroid, looking at the centroid.")),
      otherwise("-", vector_key(
                         "start.look_at", "m", between(-1e6, 1e6),
                         [](auto& m) -> auto& { return m.start.look_at; },
                         "Point that the first view looks at.")),
      otherwise("-", vector_key(
                         "start.direction", "", between(-1e6, 1e6),
                         [](auto& m) -> auto& { return m.start.direction; },
                         "Direction of the first view, instead of look_at.")),
  };
}

std::vector<Key> limits_keys() {
  return {
      integer_key(
          "limits.max_views", "", between(1, 1e6),
          [](auto& m) -> auto& { return m.limits.options.max_views; }, "Maximum number of views."),
      otherwise("unlimited", number_key(
                                 "limits.max_distance", "m", above(0, 1e9),
                                 [](auto& m) -> auto& { return m.limits.options.max_distance; },
                                 "Maximum length of the survey, as the sum of the straight-line "
                                 "distances between views.")),
      otherwise("with a vehicle: flight.clearance + 0.01; with ground: 0; otherwise unlimited",
                number_key(
                    "limits.ground_clearance", "m", between(-1e6, 1e6),
                    [](auto& m) -> auto& { return m.limits.ground_clearance; },
                    "Minimum height of a view above the scene's base.")),
      number_key(
          "limits.stand_off", "m", between(0, 1e4),
          [](auto& m) -> auto& { return m.limits.min_standoff; },
          "Minimum distance from a view to any measured surface. With the planner skycap, it also "
          "applies to unknown space inside planner.scene_box."),
      angle_key(
          "limits.min_pitch_deg", between(-right_angle, right_angle),
          [](auto& m) -> auto& { return m.limits.min_pitch; },
          "Minimum pitch of the gimbal; straight down is -90."),
      angle_key(
          "limits.max_pitch_deg", between(-right_angle, right_angle),
          [](auto& m) -> auto& { return m.limits.max_pitch; }, "Maximum pitch of the gimbal."),
      otherwise("unlimited", number_key(
                                 "limits.max_minutes", "min", above(0),
                                 [](auto& m) -> auto& { return m.limits.max_minutes; },
                                 "Maximum duration of the survey. The duration is estimated from "
                                 "limits.speed and limits.time_per_view.")),
      number_key(
          "limits.speed", "m/s", above(0, 1e3),
          [](auto& m) -> auto& { return m.limits.options.speed; },
          "Speed of the sensor between views, for limits.max_minutes."),
      number_key(
          "limits.time_per_view", "s", between(0, 1e6),
          [](auto& m) -> auto& { return m.limits.options.time_per_view; },
          "Time per view to stop, turn and measure, for limits.max_minutes."),
  };
}

std::vector<Key> evaluation_keys() {
  return {
      required(number_key(
          "evaluation.coverage_distance", "m", between(1e-6, 1e3),
          [](auto& m) -> auto& { return m.evaluation.registration_distance; },
          "r_d: coverage distance. A surface sample is covered if a stored measurement is within "
          "this distance.")),
      integer_key(
          "evaluation.samples", "", between(100, 1e7),
          [](auto& m) -> auto& { return m.evaluation.samples; },
          "Number of samples, evenly distributed over the surface, used to measure coverage."),
      integer_key(
          "evaluation.visible_directions", "", between(1, 1e4),
          [](auto& m) -> auto& { return m.evaluation.visible_directions; },
          "Number of directions in which the visibility of a sample from the view distance is "
          "tested. A sample is visible if at least one of these directions is unoccluded."),
      integer_key(
          "evaluation.attainable_views", "", between(0, 1e4),
          [](auto& m) -> auto& { return m.evaluation.attainable_views; },
          "Number of views used to compute the attainable coverage; 0: not computed."),
      otherwise("with a vehicle: flight.clearance; otherwise limits.stand_off",
                number_key(
                    "evaluation.passage_radius", "m", between(0, 1e3),
                    [](auto& m) -> auto& { return m.evaluation.radius; },
                    "Radius of the sphere that must fit through a passage for the space behind it "
                    "to count as reachable. 0: any gap is passable.")),
  };
}

std::vector<Key> paper_keys() {
  const std::string tables_row =
      "from Table 1 of the SEE++ paper for a mission of that name, otherwise -";
  return {
      otherwise(tables_row,
                number_key(
                    "paper.views", "", above(0), [](auto& m) -> auto& { return m.paper.views; },
                    "Published number of views, printed next to the results of trials.")),
      otherwise(tables_row, number_key(
                                "paper.coverage", "fraction", between(0, 1),
                                [](auto& m) -> auto& { return m.paper.coverage; },
                                "Published coverage of a survey.")),
      otherwise(tables_row, number_key(
                                "paper.planning_time", "s", above(0),
                                [](auto& m) -> auto& { return m.paper.planning_time; },
                                "Published planning time of a survey.")),
      otherwise(tables_row, number_key(
                                "paper.distance", "m", above(0),
                                [](auto& m) -> auto& { return m.paper.distance; },
                                "Published path length of a survey.")),
  };
}

}  // namespace skycap::missions::config
