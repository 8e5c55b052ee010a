// The keys of `start`, `limits`, `evaluation` and `paper`.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

constexpr double right_angle = 90.0;  // [degrees]

}  // namespace

std::vector<Key> start_keys() {
  return {
      otherwise("at random",
                vector_key(
                    "start.position", "m", between(-1e6, 1e6),
                    [](auto& m) -> auto& { return m.start.position; },
                    "Where the first view is taken from. At random: in a direction drawn by the "
                    "seed, as far from the surface's centroid as the view distance and the mean "
                    "distance of the surface to it, looking at it.")),
      otherwise("-", vector_key(
                         "start.look_at", "m", between(-1e6, 1e6),
                         [](auto& m) -> auto& { return m.start.look_at; },
                         "A point that the first view looks at.")),
      otherwise("-", vector_key(
                         "start.direction", "", between(-1e6, 1e6),
                         [](auto& m) -> auto& { return m.start.direction; },
                         "Which way the first view looks, in place of look_at.")),
  };
}

std::vector<Key> limits_keys() {
  return {
      integer_key(
          "limits.max_views", "", between(1, 1e6),
          [](auto& m) -> auto& { return m.limits.options.max_views; },
          "The survey ends after this many views."),
      otherwise("unlimited",
                number_key(
                    "limits.max_distance", "m", above(0, 1e9),
                    [](auto& m) -> auto& { return m.limits.options.max_distance; },
                    "The survey ends when the straight lines between views add up to this.")),
      otherwise("with a vehicle flight.clearance and 0.01, with ground 0, else unlimited",
                number_key(
                    "limits.ground_clearance", "m", between(-1e6, 1e6),
                    [](auto& m) -> auto& { return m.limits.ground_clearance; },
                    "Least height of a view above the scene's base.")),
      number_key(
          "limits.stand_off", "m", between(0, 1e4),
          [](auto& m) -> auto& { return m.limits.stand_off; },
          "Least distance of a view from everything measured; with skycap, inside the scene's box, "
          "also from space that was not seen to be empty."),
      angle_key(
          "limits.lowest_pitch_deg", between(-right_angle, right_angle),
          [](auto& m) -> auto& { return m.limits.lowest_pitch; },
          "How far down the gimbal turns the sensor; straight down is -90."),
      angle_key(
          "limits.highest_pitch_deg", between(-right_angle, right_angle),
          [](auto& m) -> auto& { return m.limits.highest_pitch; },
          "How far up the gimbal turns the sensor."),
      otherwise("unlimited",
                number_key(
                    "limits.max_minutes", "min", above(0),
                    [](auto& m) -> auto& { return m.limits.max_minutes; },
                    "The survey ends when it would take longer than this, by the two keys below.")),
      number_key(
          "limits.speed", "m/s", above(0, 1e3),
          [](auto& m) -> auto& { return m.limits.options.speed; },
          "How fast the sensor flies from view to view, for limits.max_minutes."),
      number_key(
          "limits.time_per_view", "s", between(0, 1e6),
          [](auto& m) -> auto& { return m.limits.options.time_per_view; },
          "How long a view takes: to stop, turn and measure; for limits.max_minutes."),
  };
}

std::vector<Key> evaluation_keys() {
  return {
      required(number_key(
          "evaluation.registration_distance", "m", between(1e-6, 1e3),
          [](auto& m) -> auto& { return m.evaluation.registration_distance; },
          "r_d: a surface sample with a stored measurement this near is covered.")),
      integer_key(
          "evaluation.samples", "", between(100, 1e7),
          [](auto& m) -> auto& { return m.evaluation.samples; },
          "Points spread evenly over the surface, by which coverage is measured."),
      integer_key(
          "evaluation.visible_directions", "", between(1, 1e4),
          [](auto& m) -> auto& { return m.evaluation.visible_directions; },
          "Directions, spread over the sphere, from which a sample may be seen at the view "
          "distance; if none is free it does not count as visible."),
      integer_key(
          "evaluation.ceiling_views", "", between(0, 1e4),
          [](auto& m) -> auto& { return m.evaluation.ceiling_views; },
          "Views that the attainable coverage is measured with; 0 leaves it out."),
      otherwise("with a vehicle flight.clearance, else limits.stand_off",
                number_key(
                    "evaluation.radius", "m", between(0, 1e3),
                    [](auto& m) -> auto& { return m.evaluation.radius; },
                    "Of the ball that has to fit through all ways from the start to a place, or "
                    "the sensor cannot be there; 0: through any gap.")),
  };
}

std::vector<Key> paper_keys() {
  const std::string tables_row = "Table 1 of the SEE++ paper for a mission of that name, else -";
  return {
      otherwise(tables_row,
                number_key(
                    "paper.views", "", above(0), [](auto& m) -> auto& { return m.paper.views; },
                    "Views a publication needed, printed beside the results of trials.")),
      otherwise(tables_row, number_key(
                                "paper.coverage", "share", between(0, 1),
                                [](auto& m) -> auto& { return m.paper.coverage; },
                                "Coverage a publication reached.")),
      otherwise(tables_row, number_key(
                                "paper.planning_time", "s", above(0),
                                [](auto& m) -> auto& { return m.paper.planning_time; },
                                "Planning time of a publication, for a survey.")),
      otherwise(tables_row, number_key(
                                "paper.distance", "m", above(0),
                                [](auto& m) -> auto& { return m.paper.distance; },
                                "Distance a publication's sensor travelled.")),
  };
}

}  // namespace skycap::missions::config
