/// A live survey in a simulated world, where it is known what has to come out.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "missions/derived/resolved_mission.h"
#include "missions/derived/survey_sensor.h"
#include "missions/live/live_survey.h"
#include "missions/run/survey_runner.h"
#include "missions/scene/survey_scene.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions::live {

/// A mission, its scene, and a sensor in it that takes the place of a real one.
class Rehearsal {
 public:
  /// `folder` is what the mission's files are named from; zero threads: all processors.
  explicit Rehearsal(const std::string& mission, const std::filesystem::path& folder = "",
                     unsigned threads = 1)
      : mission_(derived::parse_mission(mission, "m.yaml")),
        scene_(mission_, folder),
        sensor_(mission_.sensor, mission_.seed),
        threads_(threads) {}

  run::SurveyRecord planned() const {
    return run::run_survey(mission_, scene_, mission_.seed, threads_);
  }

  LiveSurvey open(const std::filesystem::path& folder) const {
    return {run::trial_mission(mission_, scene_, mission_.seed), folder,
            scene_.first_view(mission_.seed), threads_};
  }

  /// What `plan` would measure from the proposed view.
  geometry::Scan scan(const LiveSurvey& survey) const {
    return sensor_.scan(scene_.scene(), *survey.proposal().view, survey.views().size(), threads_);
  }

  /// Without a vehicle `plan` knows from the scene, and a crew by looking, what is walled in.
  bool can_reach(const LiveSurvey& survey) const {
    return mission_.flight.is_flown() || survey.views().empty() ||
           scene_.is_reachable(survey.proposal().view->position);
  }

  void add_one(LiveSurvey& survey) const {
    survey.add(scan(survey), "scan " + std::to_string(survey.views().size()));
  }

  const file::Mission& mission() const { return mission_; }

 private:
  file::Mission mission_;
  scene::SurveyScene scene_;
  derived::SurveySensor sensor_;
  unsigned threads_;
};

inline std::vector<Eigen::Vector3d> places(const std::vector<run::JudgedView>& views) {
  std::vector<Eigen::Vector3d> places;
  for (const run::JudgedView& view : views) {
    places.push_back(view.surveyed.view.position);
    places.push_back(view.surveyed.view.direction);
  }
  return places;
}

/// All that both kinds of survey know, to the last bit.
inline void expect_same(const run::SurveyRecord& live, const run::SurveyRecord& planned) {
  EXPECT_EQ(live.stop_reason, planned.stop_reason);
  const std::vector<Eigen::Vector3d> ours = places(live.views), theirs = places(planned.views);
  const auto other = std::ranges::mismatch(ours, theirs).in1 - ours.begin();
  EXPECT_TRUE(ours == theirs) << "they differ from view " << other / 2 << " on";
  EXPECT_TRUE(live.cloud.positions == planned.cloud.positions);
  EXPECT_TRUE(live.cloud.views == planned.cloud.views);
  ASSERT_EQ(live.flown.has_value(), planned.flown.has_value());
  if (!live.flown) return;
  EXPECT_EQ(live.flown->refused, planned.flown->refused);
  EXPECT_EQ(live.flown->length(), planned.flown->length());
  EXPECT_EQ(live.flown->min_clearance(), planned.flown->min_clearance());
}

/// Five views at most, and by another planner if one is named.
inline std::string short_mission(std::string mission, const std::string& planner = "") {
  const std::string limit = "max_views: ", section = "planner: {";
  const std::size_t at = mission.find(limit) + limit.size();
  mission.replace(at, mission.find('}', at) - at, "5");
  if (planner.empty()) return mission;
  return mission.insert(mission.find(section) + section.size(), "name: " + planner + ", ");
}

/// The teapot, measured well enough for poses to be looked at, and what `live` says.
inline std::string fine_mission(const std::string& live = "") {
  std::string mission = short_mission(tests::quick_mission(live), "see++");
  const std::string noise = "sigma: 0.03";
  return mission.replace(mission.find(noise), noise.size(), "sigma: 0.001");
}

}  // namespace skycap::missions::live
