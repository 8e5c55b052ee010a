#include "missions/evaluation/survey_scene.h"

#include <algorithm>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/io/mesh_io.h"
#include "missions/config/resolve.h"
#include "tests/missions/room_scene.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using testing_support::thrown_message;
using tests::TestFolder;

/// A room of 20 m with a window. Its planners use a view distance of 6 m. The position offset keeps
/// view positions from lying exactly on a surface.
class WindowedRoom {
 public:
  explicit WindowedRoom(double width, double height = 5.0) {
    geometry::write_mesh(
        folder_ / "room.ply",
        tests::room_mesh({.wall = 0.67, .door_width = width, .door_height = height}));
  }

  config::MissionSetup mission(const std::vector<config::KeyOverride>& more) const {
    return config::parse_mission(
        "scene: {model: room.ply, position: [0, 0, -0.67]}\n"  // the floor inside is at z = 0
        "sensor: {width: 160, height: 100, noise: {sigma: 0.05}}\n"
        "planner: {density: 25, resolution_radius: 0.7, view_distance: 6, occluder_spacing: 0.4,\n"
        "          max_attempts: 2, occlusion_search_distance: 6}\n"
        "evaluation: {coverage_distance: 0.4, samples: 4000, visible_directions: 60,\n"
        "             attainable_views: 60}\n"
        "limits: {max_views: 40}\n",
        "m.yaml", more);
  }

  evaluation::SurveyScene scene(const std::vector<config::KeyOverride>& more,
                                const std::filesystem::path& kept = {}) const {
    return {mission(more).simulation, folder_.path(), 0, kept};
  }

 private:
  TestFolder folder_;
};

bool is_on_inside(const Eigen::Vector3f& point) {
  return Eigen::AlignedBox3f(Eigen::Vector3f(-10.01F, -10.01F, -0.01F),
                             Eigen::Vector3f(10.01F, 10.01F, 10.01F))
      .contains(point);
}

// The interior of a sealed room is neither visible nor attainable for any radius. The whole
// exterior is. The walls of closed solids have no other surface.
TEST(SurveyScene, ExcludesSealedRoomsFromCoverage) {
  const WindowedRoom sealed(0.0);
  const evaluation::SurveyScene scene = sealed.scene({});
  const std::vector<std::uint8_t> visible = scene.visible(2);
  const auto attainable = scene.attainable(visible, 2);
  ASSERT_TRUE(attainable);
  EXPECT_FALSE(scene.is_reachable({0, 0, 5}));
  EXPECT_TRUE(scene.is_reachable({0, 0, 20}));
  std::size_t missed = 0, outside = 0;
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const Eigen::Vector3f& point = scene.samples().points[i];
    if (is_on_inside(point)) {
      ASSERT_EQ(visible[i], 0) << point.transpose();
      ASSERT_EQ((*attainable)[i], 0) << point.transpose();
    } else if (point.cwiseAbs().head<2>().maxCoeff() > 10.66F || point.z() > 10.66F) {
      ++outside;
      missed += visible[i] == 0;
    }
  }
  EXPECT_GT(outside, 1000U);
  EXPECT_LT(missed, outside / 100);  // 60 directions are few, so some samples are missed
}

// An opening 3 m wide is passable for a ball of 1 m but not for one of 2 m. This applies to the
// evaluation and to the planners.
TEST(SurveyScene, IncludesRoomsPassableForRadius) {
  const WindowedRoom room(3.0);
  const auto seen_inside = [&](const char* radius) {
    const evaluation::SurveyScene scene =
        room.scene({{"--set", "evaluation.passage_radius", radius}});
    const std::vector<std::uint8_t> visible = scene.visible(2);
    std::size_t seen = 0, inside = 0;
    for (std::size_t i = 0; i < visible.size(); ++i) {
      const Eigen::Vector3f& point = scene.samples().points[i];
      if (point.y() < 5.0F || !is_on_inside(point)) continue;  // hardly visible through the window
      ++inside;
      seen += visible[i];
    }
    EXPECT_EQ(scene.is_reachable({0, 0, 5}), std::string_view(radius) != "2") << radius;
    return static_cast<double>(seen) / static_cast<double>(inside);
  };
  EXPECT_GT(seen_inside("0"), 0.95);
  EXPECT_GT(seen_inside("1"), 0.85);  // view positions keep 1 m from the walls
  EXPECT_LT(seen_inside("2"), 0.2);
}

// The evaluation must not change the survey.
TEST(SurveyScene, DrawsTheFirstViewIndependentlyOfTheSamples) {
  const WindowedRoom room(3.0);
  const geometry::View few = room.scene({{"--set", "evaluation.samples", "1000"}}).first_view(7);
  const geometry::View many = room.scene({{"--set", "evaluation.samples", "9000"}}).first_view(7);
  EXPECT_EQ(few.position, many.position);
  EXPECT_EQ(few.direction, many.direction);
}

TEST(SurveyScene, RejectsStartInsideWall) {
  const WindowedRoom room(3.0);
  const evaluation::SurveyScene scene = room.scene({{"--set", "start.position", "[10.25, 0, 5]"},
                                                    {"--set", "start.look_at", "[0, 0, 5]"},
                                                    {"--set", "evaluation.passage_radius", "1"}});
  EXPECT_THAT(thrown_message([&] { scene.first_view(1); }),
              HasSubstr("start.position is inside the model"));
}

// The file is bound to the mission and its model. Reading it avoids the computation.
TEST(SurveyScene, CachesReachableSpaceInFile) {
  const WindowedRoom room(3.0);
  const TestFolder folder;
  const std::filesystem::path kept = folder.path() / "reached";
  const std::vector<config::KeyOverride> wide{{"--set", "evaluation.passage_radius", "1"}};
  EXPECT_TRUE(room.scene(wide, kept).is_reachable({0, 0, 5}));
  ASSERT_TRUE(std::filesystem::exists(kept));
  // The stored result is used, even with a different radius.
  EXPECT_TRUE(
      room.scene({{"--set", "evaluation.passage_radius", "2"}}, kept).is_reachable({0, 0, 5}));
  folder.write("reached", "spoiled");
  EXPECT_FALSE(
      room.scene({{"--set", "evaluation.passage_radius", "2"}}, kept).is_reachable({0, 0, 5}));
  EXPECT_GT(std::filesystem::file_size(kept), 100U);
}

/// Returns a mission with a surveyed cube of 4 m and a neighbouring cube 6 m away as an obstacle.
std::string two_cubes(const TestFolder& folder, const char* neighbours) {
  geometry::Mesh cube = sim::models::box({-2, -2, 0}, {2, 2, 4});
  geometry::write_mesh(folder / "cube.obj", cube);
  geometry::write_mesh(folder / "beside.obj", sim::models::box({8, -2, 0}, {12, 2, 4}));
  const std::string near = "uncertainty: 0.1}";
  return "scene: {model: prior, neighbours: " + std::string(neighbours) +
         "}\nprior:\n  - {file: '" + folder / "cube.obj" + "', role: target, " + near +
         "\n  - {file: '" + folder / "cube.obj" + "', role: obstacle, " + near + "\n  - {file: '" +
         folder / "beside.obj" + "', role: obstacle, " + near +
         "\nevaluation: {coverage_distance: 0.1, samples: 2000, passage_radius: 0.5}\n";
}

// Rays end on the neighbours and the sensor keeps its distance from them, but they are not
// evaluated.
TEST(SurveyScene, ExcludesNeighboursFromEvaluation) {
  const TestFolder folder;
  const auto make_mission = [&](const char* neighbours) {
    return config::parse_mission(two_cubes(folder, neighbours), "m.yaml");
  };
  const auto make_scene = [&](const char* neighbours) {
    return evaluation::SurveyScene(make_mission(neighbours).simulation, "", 0);
  };
  const evaluation::SurveyScene alone = make_scene("false"), with_surroundings = make_scene("true");
  EXPECT_EQ(with_surroundings.model().triangles.size(), 12U);
  EXPECT_EQ(with_surroundings.samples().points, alone.samples().points);
  EXPECT_FALSE(alone.scene().is_blocked({6, 0, 2}, {14, 0, 2}));
  EXPECT_TRUE(with_surroundings.scene().is_blocked({6, 0, 2}, {14, 0, 2}));
  // The target, which is an obstacle as well, is not included twice.
  EXPECT_EQ(scene::prior_neighbours(make_mission("true").scene()).triangles.size(), 12U);
  EXPECT_TRUE(scene::prior_neighbours(make_mission("false").scene()).triangles.empty());
  const auto allows = [](const evaluation::SurveyScene& scene, double x) {
    return scene.admissible().allows(geometry::look_at({x, 0, 2}, {0, 0, 2}));
  };
  EXPECT_TRUE(allows(alone, 7.8));
  EXPECT_FALSE(allows(with_surroundings, 7.8));
  EXPECT_TRUE(allows(with_surroundings, 5.0));
}

}  // namespace
}  // namespace skycap::missions
