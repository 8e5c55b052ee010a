/// Labels of a survey compared with their definition after each view. The reference uses
/// nanoflann's neighbour search, which shares no code with Skycap.
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <nanoflann.hpp>

#include "geometry/error.h"
#include "geometry/points/density.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "sim/sensors/depth_camera.h"
#include "survey/see/see.h"
#include "survey/survey_loop.h"

namespace skycap::missions {
namespace {

using geometry::PointLabel;

struct Points {
  const std::vector<Eigen::Vector3f>& positions;
  std::size_t kdtree_get_point_count() const { return positions.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return positions[index][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// Returns labels by definition, without the memory of discarded frontiers.
std::vector<PointLabel> recomputed_labels(const std::vector<Eigen::Vector3f>& positions,
                                          double radius, std::size_t core_threshold) {
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3>;
  const Points points{positions};
  Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  tree.buildIndex();
  // nanoflann's balls are open. The next larger number makes them closed.
  const float squared_radius =
      std::nextafter(static_cast<float>(radius * radius), static_cast<float>(1.0));
  std::vector<std::vector<std::pair<std::uint32_t, float>>> near(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    tree.radiusSearch(positions[i].data(), squared_radius, near[i], {32, 0.0F, false});
  }
  std::vector<PointLabel> labels(positions.size(), PointLabel::core);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    if (near[i].size() >= core_threshold) continue;
    bool has_core = false, has_other = false;
    for (const auto& [j, distance] : near[i]) {
      if (j != i) (near[j].size() >= core_threshold ? has_core : has_other) = true;
    }
    labels[i] = has_core && has_other ? PointLabel::frontier : PointLabel::outlier;
  }
  return labels;
}

// A sixteenth of the D435's pixels and of the density, so that the recomputation takes 1 s.
TEST(BunnySurvey, MatchesFullRecomputationOfLabelsAfterEveryView) {
  const config::MissionSetup mission = config::read_mission(
      SKYCAP_SOURCE_DIR "/missions/bunny.yaml", {{"--set", "sensor.width", "212"},
                                                 {"--set", "sensor.height", "120"},
                                                 {"--set", "planner.density", "9125"},
                                                 {"--set", "planner.resolution_radius", "0.0429"}});
  std::optional<evaluation::SurveyScene> scene;
  try {
    scene.emplace(mission.simulation, "", 0);
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }

  const auto& see = std::get<survey::see::SeeConfig>(mission.survey().planner.method);
  const auto threshold = see.effective_core_threshold();
  geometry::DensityMap map({.radius = see.resolution_radius,
                            .core_threshold = threshold,
                            .spacing = see.effective_spacing()});
  survey::see::SeePlanner planner(see, geometry::Camera(mission.survey().planner.camera));
  const sim::DepthCamera camera(mission.sensor().camera);
  std::uint32_t frame = 0;
  std::size_t frontiers = 0;
  const auto check = [&](const survey::SurveyedView&, const geometry::Scan& scan) {
    map.insert(scan.points, frame);
    map.relabel();
    ASSERT_EQ(map.labels(), recomputed_labels(map.cloud().positions, see.resolution_radius,
                                              static_cast<std::size_t>(threshold)))
        << "view " << frame;
    for (const PointLabel label : map.labels()) frontiers += label == PointLabel::frontier ? 1 : 0;
  };
  survey::run_survey(planner, scene->first_view(mission.run.seed), {.max_views = 40},
                     {.sense =
                          [&](const geometry::View& view, geometry::Scan buffer) {
                            return camera.scan(scene->scene(), view, frame++, 1, std::move(buffer));
                          },
                      .report = check});
  EXPECT_GT(frame, 5U);
  EXPECT_GT(frontiers, 20U);
}

}  // namespace
}  // namespace skycap::missions
