// Keys of the section `inspection`: continuous flights around known structures.
#include "geometry/angle.h"
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

auto inspection(auto member) {
  return [member](auto& m) -> auto& { return m.inspection.*member; };
}

std::vector<Key> motion_keys() {
  return {
      otherwise("2, or the vehicle's maximum if that is less",
                number_key("inspection.max_speed", "m/s", above(0, 100),
                           inspection(&InspectionSection::max_speed),
                           "Maximum speed. The vehicle flies at this speed most of the time. The "
                           "vehicle's maximum climb and descent also apply.")),
      otherwise("1, or the vehicle's maximum if that is less",
                number_key("inspection.max_acceleration", "m/s^2", above(0, 100),
                           inspection(&InspectionSection::max_acceleration),
                           "Maximum acceleration in any direction.")),
      otherwise(
          "0.5, or the vehicle's maximum if that is less",
          number_key("inspection.max_jerk", "m/s^3", above(0, 1000),
                     inspection(&InspectionSection::max_jerk), "Maximum jerk in any direction.")),
      otherwise("60, or the vehicle's maximum if that is less",
                quantity_key(KeyType::number, "inspection.max_yaw_rate_deg", "degrees/s",
                             above(0, 720), inspection(&InspectionSection::max_yaw_rate),
                             "Maximum yaw rate.", geometry::radians_per_degree)),
      otherwise("30, or the vehicle's maximum if that is less",
                quantity_key(KeyType::number, "inspection.max_yaw_acceleration_deg", "degrees/s^2",
                             above(0, 3600), inspection(&InspectionSection::max_yaw_acceleration),
                             "Maximum yaw acceleration.", geometry::radians_per_degree)),
  };
}

std::vector<Key> coverage_keys() {
  return {
      otherwise("none", number_key("inspection.range", "m", above(0, 1000),
                                   inspection(&InspectionSection::range),
                                   "Maximum view distance. Makes the mission an inspection: a "
                                   "continuous flight around a known structure, without stops.")),
      otherwise("the targets of the prior data",
                text_key("inspection.cloud", inspection(&InspectionSection::cloud),
                         "Point cloud of the structure in the mission frame (.ply, .pcd, .las, "
                         ".laz, .e57 or .xyz), relative to the mission file. The median distance "
                         "of the 6th nearest point is kept in addition to flight.clearance, for "
                         "the surface between the points.")),
      number_key("inspection.share", "fraction", above(0, 1), inspection(&InspectionSection::share),
                 "Required fraction of the attainable points: points that are visible from at "
                 "least one candidate view position."),
      angle_key("inspection.max_incidence_deg", above(0, 89),
                inspection(&InspectionSection::max_incidence),
                "Maximum angle of incidence at which a point counts as seen."),
      integer_key("inspection.min_views", "", between(1, 100),
                  inspection(&InspectionSection::min_views),
                  "Number of times a point must be seen to count, at intervals of 0.4 s of "
                  "flight. Raise it for photogrammetry."),
      otherwise("range / 40",
                number_key("inspection.spacing", "m", above(0, 100),
                           inspection(&InspectionSection::spacing),
                           "Distance between the points by which the structure is represented.")),
  };
}

}  // namespace

std::vector<Key> inspection_keys() {
  return joined(
      {coverage_keys(),
       motion_keys(),
       {integer_key("inspection.moves", "", between(1, 100'000'000),
                    inspection(&InspectionSection::moves),
                    "Budget of each search: number of route changes (moves) to try. More moves "
                    "give shorter flights but longer planning times."),
        integer_key("inspection.searches", "", between(1, 1000),
                    inspection(&InspectionSection::searches),
                    "Number of independent searches, of which the best flight is used. They run "
                    "in parallel.")}});
}

}  // namespace skycap::missions::config
