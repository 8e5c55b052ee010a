#include "missions/config/resolve.h"

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/support/number_text.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using survey::see::SeeConfig;
using survey::surfel::SurfelConfig;
using testing::HasSubstr;

const std::string smallest =
    "scene: {model: 'builtin:teapot'}\nevaluation: {coverage_distance: 0.005}\n";

config::MissionSetup parsed(const std::string& more) {
  return config::parse_mission(smallest + more, "some/folder/vase.yaml");
}

const SeeConfig& see_config(const config::MissionSetup& setup) {
  return std::get<SeeConfig>(setup.survey().planner.method);
}

std::string error_message(const std::string& text) {
  return testing_support::thrown_message([&] { config::parse_mission(text, "m.yaml"); });
}

// echo 51.7534 -1.254 0 | cs2cs EPSG:4326+5773 EPSG:4979 -f %.6f
TEST(Resolve, UsesEgm96WhenGeoidIsRequiredButUnset) {
  const std::string location = "site: {latitude_deg: 51.7534, longitude_deg: -1.254";
  const auto undulation = [&](const std::string& text) {
    return parsed(text).flight().site.geoid_undulation;
  };
  const std::string flight =
      "}\nflight: {vehicle: generic, unknown_box: {min: [0, 0, 0], max: [1, 1, 1]}}\n";
  EXPECT_NEAR(undulation(location + flight).value(), 47.760744, 1e-6);
  EXPECT_EQ(undulation(location + ", geoid_undulation: 40" + flight), 40.0);
  EXPECT_FALSE(undulation(location + "}\n")) << "nobody asks";
  EXPECT_FALSE(undulation(location + "}\nscan: {crs: utm}\n"))
      << "maps have ellipsoid heights, too";
  EXPECT_FALSE(undulation("flight: {vehicle: none}\n"));
}

// Specification: psi = d, one frontier for a twentieth of d, occluders 2 r apart, tau above the
// number of clusters.
TEST(Resolve, DerivesBuildingPresetFromSensorAndDensity) {
  const std::string building =
      "sensor: {preset: high_resolution}\n"
      "planner: {preset: building, density: 213, spacing: 0.0685, resolution_radius: 0.15";
  const SeeConfig see = see_config(parsed(building + "}"));
  EXPECT_NEAR(see.occlusion_search_distance, 41.29, 5e-3);  // published value of d
  EXPECT_NEAR(see.frontier_spacing, 2.0645, 5e-4);
  EXPECT_DOUBLE_EQ(see.occluder_spacing, 0.3);
  EXPECT_EQ(see.visibility_update_limit, 1000U);
  EXPECT_EQ(see.still_occluded, survey::see::StillOccluded::deferred);
  EXPECT_EQ(see.core_threshold, 5);  // 10.5 points on a disc at this spacing

  const SeeConfig overridden =
      see_config(parsed(building + ", occlusion_search_distance: 10, visibility_update_limit: 5}"));
  EXPECT_EQ(overridden.occlusion_search_distance, 10.0);
  EXPECT_EQ(overridden.visibility_update_limit, 5U);
  EXPECT_NEAR(overridden.frontier_spacing, 2.0645, 5e-4);
  EXPECT_EQ(see_config(parsed(building + ", core_threshold: 4}")).core_threshold, 4);
  const config::MissionSetup published = parsed("planner: {density: 213, resolution_radius: 0.15}");
  EXPECT_EQ(see_config(published).core_threshold, std::nullopt);
}

// The point spacing of the paper would leave gaps that do not count as covered.
TEST(Resolve, LimitsSpacingToCoverageDistance) {
  const auto spacing = [](const std::string& distance, const std::string& more) {
    return config::parse_mission(
               "scene: {model: 'builtin:teapot'}\n"
               "planner: {density: 400, resolution_radius: 0.15" +
                   more + "}\nevaluation: {coverage_distance: " + distance + "}\n",
               "m.yaml")
        .survey()
        .planner.spacing;
  };
  EXPECT_DOUBLE_EQ(spacing("0.1", ""), 0.05) << "the paper's, rho^(-1/2)";
  EXPECT_DOUBLE_EQ(spacing("0.05", ""), 0.04);
  EXPECT_DOUBLE_EQ(spacing("0.05", ", spacing: 0.06"), 0.06) << "as the mission says";
  // At 1 m, the image of a D435 is 2 tan(69.4 deg / 2) = 1.385 m wide.
  EXPECT_NEAR(spacing("0.001", ", view_distance: 10"), 10 * 1.385 / 848, 1e-4) << "as rays meet it";
}

config::MissionSetup with_density(const std::string& planner) {
  return config::parse_mission("scene: {model: 'builtin:teapot'}\nplanner: {" + planner +
                                   "}\nevaluation: {coverage_distance: 1}\n",
                               "m.yaml");
}

// Of all coverings of a plane by discs, the hexagonal lattice has the fewest discs. Its cells have
// the side a, the area sqrt(3) / 2 a^2 per point, and corners a / sqrt(3) from the points.
TEST(Resolve, PlansCoverageThatGuaranteesDensityPerSquareMetre) {
  const config::MissionSetup setup = with_density("name: skycap, density_per_m2: 100");
  const double side = std::sqrt(2.0 / (std::sqrt(3.0) * 100.0));
  const auto& config = std::get<SurfelConfig>(setup.survey().planner.method);
  EXPECT_NEAR(config.coverage_radius, side / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(setup.survey().planner.spacing, 0.8 * side / std::sqrt(3.0), 1e-12);
  EXPECT_EQ(setup.evaluation().registration_distance, 1.0) << "the evaluation does not change";
  EXPECT_NEAR(std::get<SurfelConfig>(
                  parsed("planner: {name: skycap, density_per_m2: 100}\n").survey().planner.method)
                  .coverage_radius,
              0.005, 1e-12)
      << "the coverage distance of the mission is smaller";
}

// SEE and SEE++ count points in discs of radius r: 100 pi r^2.
TEST(Resolve, ConvertsDensityPerSquareMetreForSee) {
  const SeeConfig derived = see_config(with_density("name: see++, density_per_m2: 100"));
  EXPECT_NEAR(derived.resolution_radius, 0.2, 1e-12);
  EXPECT_EQ(derived.effective_core_threshold(), 13);
  const SeeConfig given =
      see_config(with_density("name: see++, density_per_m2: 100, resolution_radius: 0.5"));
  EXPECT_EQ(given.effective_core_threshold(), 79);
}

TEST(Resolve, RejectsKeysThatConflictWithDensityPerSquareMetre) {
  const auto message = [](const std::string& planner) {
    return testing_support::thrown_message([&] { with_density(planner); });
  };
  EXPECT_THAT(message("name: skycap, density_per_m2: 100, density: 213"),
              HasSubstr("key planner.density conflicts with planner.density_per_m2; remove one"));
  EXPECT_THAT(message("name: skycap, density_per_m2: 100, spacing: 0.07"),
              HasSubstr("key planner.spacing must be at most 0.06204 m for 100 points per square "
                        "metre; lower it or remove it"));
  EXPECT_THAT(message("name: oa, density_per_m2: 100"),
              HasSubstr("key planner.density_per_m2 requires the planner skycap, see++ or see"));
  EXPECT_EQ(message("name: skycap, density_per_m2: 100, spacing: 0.06"), "");
}

// A vehicle has a flight time; without one, only the number of views is known.
TEST(Resolve, MinimisesTimeWithVehicle) {
  const auto goal = [](const std::string& more) {
    return parsed("planner: {name: skycap" + more).text("planner.goal");
  };
  const std::string with_vehicle =
      "}\nflight: {vehicle: generic, unknown_box: {min: [0, 0, 0], max: [1, 1, 1]}}\n";
  EXPECT_EQ(goal("}\n"), "views");
  EXPECT_EQ(goal(with_vehicle), "minutes");
  EXPECT_EQ(goal(", goal: views" + with_vehicle), "views");
}

// In surveys with the M350 at 4 m/s, the measured cost of a view is 6.5 to 8 s. The stop includes
// another 0.5 s of rest.
TEST(ViewPrice, DependsOnViewDistanceOrStopTime) {
  const auto price = [](const std::string& more) {
    const config::MissionSetup setup =
        parsed("planner: {name: skycap, view_distance: 20, goal: " + more);
    return std::get<SurfelConfig>(setup.survey().planner.method).view_price;
  };
  EXPECT_EQ(price("views}\n"), std::nullopt);
  EXPECT_EQ(price("minutes}\n"), 20.0);
  const std::string flight_mission =
      "}\nflight: {vehicle: m350_rtk, unknown_box: {min: [0, 0, 0], max: [1, 1, 1]}}\n";
  EXPECT_EQ(price("views" + flight_mission), std::nullopt);
  EXPECT_GE(price("minutes" + flight_mission), 26.0);
  EXPECT_LE(price("minutes" + flight_mission), 34.0);
}

TEST(Resolve, ReadsSiteAirspace) {
  const config::MissionSetup mission = parsed(
      "site:\n"
      "  geofence: [[-50, -40], [50, -40], [50.5, 40]]\n"
      "  no_fly:\n"
      "    - {corners: [[0, 0], [5, 0], [0, 5]], floor: 0, ceiling: 30}\n"
      "  min_height: 3\n"
      "  max_height: 120\n"
      "limits: {ground_clearance: 5, stand_off: 2, min_pitch_deg: -90, max_pitch_deg: "
      "30}\n");
  const survey::ViewLimits& limits = mission.survey().planner.limits;
  ASSERT_EQ(limits.geofence.size(), 3U);
  EXPECT_EQ(limits.geofence[2], Eigen::Vector2d(50.5, 40.0));
  ASSERT_EQ(limits.no_fly.size(), 1U);
  EXPECT_EQ(limits.no_fly[0].footprint[1], Eigen::Vector2d(5.0, 0.0));
  EXPECT_EQ(limits.no_fly[0].ceiling, 30.0);
  EXPECT_EQ(limits.min_height, 5.0);  // the higher of the two limits
  EXPECT_EQ(limits.max_height, 120.0);
  EXPECT_EQ(limits.min_standoff, 2.0);
  EXPECT_NEAR(limits.max_pitch, 0.5235988, 1e-6);
  EXPECT_NO_THROW(limits.validate());
}

TEST(Resolve, RejectsInvalidAirspaces) {
  EXPECT_THAT(error_message("site: {geofence: [[0, 0], [1, 0]]}"),
              HasSubstr("three or more corners"));
  EXPECT_THAT(error_message("site: {geofence: [[0, 0], [1, 0], [1, x]]}"),
              HasSubstr("site.geofence"));
  const std::string corners = "corners: [[0, 0], [1, 0], [0, 1]]";
  EXPECT_THAT(error_message("site: {no_fly: [{" + corners + ", floor: 3, ceiling: 3}]}"),
              HasSubstr("site.no_fly"));
  EXPECT_THAT(error_message("site: {no_fly: [{" + corners + ", floor: 0, roof: 3}]}"),
              HasSubstr("a list of {corners, floor, ceiling}"));
  EXPECT_THAT(parsed("site: {no_fly: []}").flight().airspace.no_fly, testing::IsEmpty());
  EXPECT_THAT(error_message(std::string(smallest) + "site: {min_height: 5, max_height: 5}"),
              HasSubstr("site.max_height must be greater than"));
  EXPECT_THAT(
      error_message(std::string(smallest) + "limits: {min_pitch_deg: 9, max_pitch_deg: -9}"),
      HasSubstr("limits.max_pitch_deg must be greater than"));
}

TEST(Resolve, MeasuresGroundClearanceFromSceneBase) {
  const config::MissionSetup mission = config::parse_mission(
      "scene: {model: 'builtin:teapot', position: [0, 0, 60]}\n"
      "evaluation: {coverage_distance: 0.005}\nlimits: {ground_clearance: 2}\n",
      "m.yaml");
  EXPECT_EQ(see_config(mission).min_height, 62.0);
  EXPECT_EQ(mission.survey().planner.limits.min_height, 62.0);
}

TEST(Resolve, DefaultsToSkycapPlannerForFlights) {
  const std::string flight_mission = smallest +
                                     "flight: {vehicle: generic, unknown_box: {min: [0, 0, 0], "
                                     "max: [1, 1, 1]}}\n";
  const auto planner = [](const std::string& text) {
    return config::parse_mission(text, "m.yaml").survey().planner.name;
  };
  EXPECT_EQ(planner(smallest), survey::PlannerName::see_plus_plus);
  EXPECT_EQ(planner(flight_mission), survey::PlannerName::skycap);
  EXPECT_EQ(planner(flight_mission + "planner: {name: see}\n"), survey::PlannerName::see);
}

// k = 1 admits no frontiers, so SEE cannot use it. Other planners ignore k.
TEST(Resolve, ChecksDensityOnlyForSee) {
  const std::string sparse = smallest + "planner: {density: 1000, resolution_radius: 0.05, name: ";
  for (const char* name : {"see", "see++"}) {
    EXPECT_THAT(error_message(sparse + name + "}\n"),
                HasSubstr("with which no point can be a frontier"))
        << name;
  }
  for (const char* name : {"skycap", "rsv", "rse", "oa", "uv", "pc", "af", "ae"}) {
    EXPECT_EQ(error_message(sparse + name + "}\n"), "") << name;
  }
}

// 51.7534 is not a binary fraction. Conversion to radians and back would give 51.753399999999999.
TEST(Resolve, KeepsExactSitePosition) {
  for (const double latitude : {51.7534, -33.856784, 0.1, 47.3}) {
    const flight::GeodeticPoint origin =
        parsed("site: {latitude_deg: " + support::exact_text(latitude) +
               ", longitude_deg: -1.254}\n")
            .flight()
            .site.origin;
    EXPECT_EQ(origin.latitude_deg, latitude);
    EXPECT_EQ(origin.longitude_deg, -1.254);
  }
}

/// Setting that its own planner rejects and other planners ignore.
struct RejectedSetting {
  const char* planner;
  const char* more;
  const char* message;  ///< prefix of the message
};

TEST(Resolve, ChecksPlannerSettingsAndNamesTheirLine) {
  const std::vector<RejectedSetting> settings{
      {"see", "planner:\n  core_threshold: 3\n",
       "m.yaml:4: key planner.core_threshold is 3; it must be at least 4"},
      {"skycap", "planner:\n  min_gain: 1\n",
       "m.yaml:4: key planner.min_gain is 1; it must be at least 0 and below 1"},
      {"oa", "volumetric:\n  thinned: true\n  shadow_length: 1e3\n",
       "m.yaml:5: key volumetric.shadow_length is 1000; it must be positive and less than"},
      {"ae", "volumetric: {window_begin: 0.6, window_end: 0.5}\n",
       "m.yaml:3: key volumetric.window_begin is 0.6; it must be at least 0 and below window_end"},
      {"uv", "volumetric: {view_limit: 1, candidates_per_view: 0.1}\n",
       "m.yaml:3: key volumetric.candidates_per_view is 0.1; it must be large enough"},
      {"af",
       "limits: {ground_clearance: 3}\nvolumetric: {sphere_centre: [0, 0, 0], sphere_radius: "
       "2}\n",
       "m.yaml:4: key volumetric.sphere_radius is 2; the sphere must reach above the minimum "
       "height of 3 m"},
  };
  for (const RejectedSetting& setting : settings) {
    const std::string mission = smallest + setting.more;
    for (const char* name : {"see", "skycap", "oa"}) {
      const bool is_volumetric = std::string(setting.more).find("volumetric:") != std::string::npos;
      const bool is_its_own =
          name == std::string(setting.planner) || (is_volumetric && name == std::string("oa"));
      std::string message;
      try {
        config::parse_mission(mission, "m.yaml", {{"--planner", "planner.name", name}});
      } catch (const Error& error) {
        message = error.what();
      }
      if (is_its_own) {
        EXPECT_THAT(message, testing::StartsWith(setting.message)) << name;
      } else {
        EXPECT_EQ(message, "") << name << ": " << setting.more;
      }
    }
  }
}

}  // namespace
}  // namespace skycap::missions
