// resolve() depends only on its arguments, and resolving its result again changes nothing.
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/config/key_texts.h"
#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "missions/session/initial_pattern_flight.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

using config::MissionSetup;
using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using survey::see::SeeConfig;
using survey::surfel::SurfelConfig;
using survey::volumetric::VolumetricConfig;
using testing::HasSubstr;

using Texts = std::map<std::string, std::string>;
using Numbers = std::map<std::string, double>;

Texts make_texts(const MissionSetup& setup) {
  Texts texts;
  for (const config::Key& key : config::mission_keys()) {
    if (config::applies(key, *setup.document)) texts[key.path] = setup.text(key.path);
  }
  return texts;
}

/// Values derived from several keys, by name.
class DerivedValues {
 public:
  explicit DerivedValues(const MissionSetup& setup) {
    add_planner(setup.survey().planner);
    add_survey(setup.survey());
    if (setup.flight().has_vehicle()) add_flight(setup.flight());
  }

  Numbers numbers;

 private:
  void add(const std::string& name, double value) { numbers[name] = value; }
  void add(const std::string& name, const std::optional<double>& value) {
    if (value) numbers[name] = *value;
  }
  void add(const std::string& name, const Vector3d& value) {
    for (int axis = 0; axis < 3; ++axis) add(name + " " + "xyz"[axis], value[axis]);
  }
  void add(const std::string& name, const AlignedBox3d& box) {
    if (box.isEmpty()) return;
    add(name + " min", Vector3d(box.min()));
    add(name + " max", Vector3d(box.max()));
  }

  void add_planner(const survey::PlannerOptions& planner) {
    add("spacing", planner.spacing);
    add("view distance", planner.view_distance);
    add("resolution radius", planner.resolution_radius);
    add("max incidence", planner.max_incidence);
    add("scene box", planner.scene_box.value_or(AlignedBox3d()));
    add("camera width", planner.camera.width);
    add("camera height", planner.camera.height);
    add("camera horizontal", planner.camera.horizontal_fov);
    add("camera vertical", planner.camera.vertical_fov);
    add("camera max range", planner.camera.max_range);
    add("least height", planner.limits.min_height);
    add("most height", planner.limits.max_height);
    add("stand-off", planner.limits.min_standoff);
    add("least pitch", planner.limits.min_pitch);
    add("most pitch", planner.limits.max_pitch);
    if (const auto* see = std::get_if<SeeConfig>(&planner.method)) {
      add("core threshold", see->effective_core_threshold());
      add("occlusion search distance", see->occlusion_search_distance);
      add("frontier spacing", see->frontier_spacing);
      add("occluder spacing", see->occluder_spacing);
      add("see least height", see->min_height);
    } else if (const auto* skycap = std::get_if<SurfelConfig>(&planner.method)) {
      add("view price", skycap->view_price);
      add("frame spacing", skycap->frame_spacing);
      add("counts ways", skycap->counts_en_route ? 1.0 : 0.0);
      add("sees lines", skycap->sees_lines ? 1.0 : 0.0);
    } else {
      const auto& volumetric = std::get<VolumetricConfig>(planner.method);
      add("candidates", static_cast<double>(volumetric.candidates));
    }
  }

  void add_survey(const session::SurveyOptions& survey) {
    add("max views", static_cast<double>(survey.limits.max_views));
    add("max distance", survey.limits.max_distance);
    add("max time", survey.limits.max_time);
    if (survey.start.view) add("first view", survey.start.view->position);
    const auto initial_pattern = session::initial_pattern_views(survey.start, 3);
    for (std::size_t i = 0; i < initial_pattern.size(); ++i) {
      add("opening " + std::to_string(i), initial_pattern[i].position);
    }
  }

  void add_flight(const flight::FlightOptions& flight) {
    add("unknown box", flight.unknown_box);
    const flight::ClearanceBudget budget = flight.budget();
    add("vehicle radius", budget.vehicle_radius);
    add("map error", budget.map_error);
    add("margin", budget.margin);
    const Vector3d pad = flight.pad({-30.0, 0.0, 10.0});
    add("pad", pad);
    const flight::RouteOptions route = flight.route(pad);
    add("climb", route.takeoff_climb);
    add("cruise speed", route.conditions.cruise_speed);
    add("wind x", route.conditions.wind.x());
    add("wind y", route.conditions.wind.y());
    add("order is free", route.order_is_free ? 1.0 : 0.0);
    add("highest return", route.returns->max_height);
    add("rest before", flight.rest_before());
    add("rest after", flight.rest_after());
    add("frame period", flight.capture.frame_period);
    add("moves", flight.capture.is_moving ? 1.0 : 0.0);
    add("fleet", static_cast<double>(flight.fleet.vehicles.size()));
    const flight::MeasuredSpaceConfig space = flight.measured_space();
    add("voxel", space.voxel);
    add("max depth", space.max_depth);
    if (flight.capture.mount) add("look pitch", flight.capture.mount->view_pitch);
    if (flight.capture.rays) {
      add("ray spacing", flight.capture.rays->spacing);
      add("origin spread", flight.capture.rays->origin_spread);
    }
  }
};

/// All arguments of resolve().
struct Inputs {
  config::MissionDocument document;
  config::Profiles profiles;
  std::shared_ptr<const site_data::SitePriors> priors;
  std::optional<double> geoid;

  explicit Inputs(config::MissionDocument given)
      : document(std::move(given)),
        profiles(config::read_profiles(document)),
        geoid(config::geoid_undulation(document)) {
    priors = config::read_priors(document, config::site_frame(document, geoid));
  }

  MissionSetup resolved() const { return config::resolve(document, profiles, priors, geoid); }
};

/// Block of 10 m as a target.
const std::string house =
    "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nv -5 -5 8\nv 5 -5 8\nv 5 5 8\nv -5 5 8\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

class ResolvePurity : public testing::Test {
 protected:
  ResolvePurity() { folder_.file("house.obj", house); }

  config::MissionDocument document(const std::string& text) const {
    return config::parse_mission_document(text, (folder_.path() / "m.yaml").string());
  }

  /// Returns missions for each kind of sensor and planner, with and without vehicles.
  static Texts missions() {
    const std::string scene =
        "scene: {model: 'builtin:teapot', longest_side: 10}\n"
        "evaluation: {coverage_distance: 0.2}\n";
    const std::string sparse = "planner: {density: 100, resolution_radius: 0.2}\n";
    const std::string flight_mission =
        sparse + "flight: {vehicle: m350_rtk, unknown_box: {min: [-8, -8, 0], max: [8, 8, 9]}}\n";
    const std::string prior =
        "evaluation: {coverage_distance: 0.2}\n" + flight_mission +
        "prior: [{file: house.obj, role: target, place: {heading_deg: 30}}]\n";
    return {
        {"camera", scene + sparse},
        {"building", scene + "sensor: {preset: high_resolution}\n"
                             "planner: {preset: building, density: 213, resolution_radius: 0.15}\n"
                             "start: {position: [-30, 0, 5], look_at: [0, 0, 4]}\n"},
        {"volumetric", scene + "planner: {name: rsv, density: 100, resolution_radius: 0.2}\n"},
        {"spinning", scene + sparse + "sensor: {lidar: velodyne_vlp16}\n"},
        {"rosette", scene + sparse + "sensor: {lidar: livox_avia}\n"},
        {"flown camera", scene + flight_mission + "limits: {max_minutes: 12}\n"},
        {"flown, moving", scene + flight_mission + "sensor: {capture: moving}\n"},
        {"flown spinning", scene + flight_mission + "sensor: {lidar: velodyne_vlp16}\n"},
        {"flown line", scene + flight_mission + "sensor: {lidar: riegl_vux_1uav}\n"},
        {"flown rosette", scene + flight_mission + "sensor: {lidar: livox_avia}\n"},
        {"fleet", scene + sparse +
                      "flight: {vehicles: [m350_rtk, generic], pads: [[-30, 0, 0], [-30, 20, 0]],\n"
                      "         unknown_box: {min: [-8, -8, 0], max: [8, 8, 9]}}\n"
                      "site: {latitude_deg: 47.1, longitude_deg: 8.2}\n"},
        {"one vehicle of a fleet",
         scene + sparse +
             "flight: {vehicles: [m350_rtk], pads: [[-30, 0, 0]],\n"
             "         unknown_box: {min: [-8, -8, 0], max: [8, 8, 9]}}\n"},
        {"prior target", "scene: {model: prior, ground: true}\n" + prior},
        {"live", prior + "start: {position: [-30, 0, 10], look_at: [0, 0, 4]}\n"}};
  }

  testing_support::TemporaryFolder folder_;
};

TEST_F(ResolvePurity, ReturnsSameSetupForSameArguments) {
  for (const auto& [name, text] : missions()) {
    SCOPED_TRACE(name);
    const Inputs inputs(document(text));
    const MissionSetup first = inputs.resolved();
    config::parse_mission(
        "scene: {model: 'builtin:teapot', scale: 3}\nevaluation: {coverage_distance: 0.01}\n",
        "other.yaml");
    const MissionSetup second = inputs.resolved();
    EXPECT_THAT(make_texts(second), testing::ContainerEq(make_texts(first)));
    EXPECT_THAT(DerivedValues(second).numbers, testing::ContainerEq(DerivedValues(first).numbers));
    EXPECT_EQ(second.simulation.attainable_inputs, first.simulation.attainable_inputs);
  }
}

// Resolving again keeps a resolved document bitwise equal.
TEST_F(ResolvePurity, KeepsResolvedDocumentUnchanged) {
  for (const auto& [name, text] : missions()) {
    SCOPED_TRACE(name);
    const Inputs inputs(document(text));
    const MissionSetup setup = inputs.resolved();
    const MissionSetup again =
        config::resolve(*setup.document, inputs.profiles, inputs.priors, inputs.geoid);
    EXPECT_THAT(make_texts(again), testing::ContainerEq(make_texts(setup)));
    EXPECT_THAT(DerivedValues(again).numbers, testing::ContainerEq(DerivedValues(setup).numbers));
    EXPECT_EQ(again.simulation.attainable_inputs, setup.simulation.attainable_inputs);
  }
}

/// Returns a document with all keys of the setup. With a scanner, the keys of the camera are
/// rejected and therefore omitted.
config::MissionDocument make_document(const MissionSetup& setup, const std::string& file) {
  std::vector<config::KeyOverride> keys;
  for (const auto& [path, text] : make_texts(setup)) {
    const bool is_flight_key = path == "sensor.capture" || path == "sensor.frame_period";
    const bool is_camera_key = path.starts_with("sensor.") && path != "sensor.lidar" &&
                               !(is_flight_key && setup.sensor().mount);
    if (text == "-" || (setup.lidar && is_camera_key)) continue;
    keys.push_back({"the setup", path, text});
  }
  return config::parse_mission_document("seed: 1\n", file, keys);
}

TEST_F(ResolvePurity, ReturnsSameSetupForWrittenKeys) {
  constexpr double digits = 1e-9;  // key values have twelve digits in text
  for (const auto& [name, text] : missions()) {
    SCOPED_TRACE(name);
    const MissionSetup setup = Inputs(document(text)).resolved();
    const std::string file = (folder_.path() / "m.yaml").string();
    const MissionSetup again = Inputs(make_document(setup, file)).resolved();
    EXPECT_THAT(make_texts(again), testing::ContainerEq(make_texts(setup)));
    const Numbers before = DerivedValues(setup).numbers, after = DerivedValues(again).numbers;
    ASSERT_EQ(before.size(), after.size());
    for (const auto& [value, number] : before) {
      ASSERT_TRUE(after.contains(value)) << value;
      EXPECT_NEAR(after.at(value), number, digits * std::max(1.0, std::abs(number))) << value;
    }
  }
}

// Equal to a file with the same keys, except for settings of the run.
TEST_F(ResolvePurity, MatchesFileWithSameKeysWhenOverridden) {
  const std::vector<config::KeyOverride> changes{{"the test", "flight.clearance", "3"},
                                                 {"the test", "planner.view_distance", "7"}};
  for (const auto& [name, text] : missions()) {
    SCOPED_TRACE(name);
    const Inputs inputs(document(text));
    MissionSetup setup = inputs.resolved();
    setup.run = {77, 2};
    setup.name = "another";
    const MissionSetup changed = config::with_keys(setup, changes);
    EXPECT_EQ(changed.run.seed, 77U);
    EXPECT_EQ(changed.run.threads, 2U);
    EXPECT_EQ(changed.name, "another");
    EXPECT_EQ(changed.scene().priors, setup.scene().priors) << "is read again";
    const MissionSetup given =
        Inputs(config::parse_mission_document(text, inputs.document.file, changes)).resolved();
    EXPECT_THAT(make_texts(changed), testing::ContainerEq(make_texts(given)));
    EXPECT_THAT(DerivedValues(changed).numbers, testing::ContainerEq(DerivedValues(given).numbers));
  }
}

TEST_F(ResolvePurity, NamesOriginOfInvalidOverrides) {
  const MissionSetup setup = Inputs(document(missions().at("camera"))).resolved();
  EXPECT_EQ(testing_support::thrown_message([&] {
              config::with_keys(setup, {{"--views", "limits.max_views", "0"}});
            }),
            "--views: key limits.max_views is 0; it must be an integer from 1 to 1000000");
  EXPECT_THAT(testing_support::thrown_message([&] {
                config::with_keys(setup, {{"--set", "planner.densty", "1"}});
              }),
              HasSubstr("did you mean planner.density?"));
}

TEST_F(ResolvePurity, ReturnsTextOfKnownKeysOnly) {
  const MissionSetup setup = Inputs(document(missions().at("camera"))).resolved();
  EXPECT_EQ(setup.text("planner.density"), "100");
  EXPECT_EQ(setup.text("start.position"), "-");
  EXPECT_THROW(setup.text("planner.densty"), std::out_of_range);
}

}  // namespace
}  // namespace skycap::missions
