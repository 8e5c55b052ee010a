/// Live survey in a simulated world with known results.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/online/live/live_survey.h"
#include "missions/simulation/mounted_sensor.h"
#include "missions/simulation/survey_runner.h"
#include "sim/sensors/survey_sensor.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions::online {

/// A mission, its scene, and a simulated sensor that replaces the real one.
class Rehearsal {
 public:
  /// `folder` is the base of the mission's file names. 0 threads: all processors.
  explicit Rehearsal(const std::string& mission, const std::filesystem::path& folder = "",
                     unsigned threads = 1)
      : setup_(config::parse_mission(mission, "m.yaml")),
        scene_(setup_.simulation, folder, setup_.run.threads),
        sensor_(setup_.sensor(), setup_.run.seed),
        first_view_(scene_.first_view(setup_.run.seed)),
        threads_(threads) {}

  session::SurveyRecord planned() const {
    return simulation::run_survey(setup_.simulation, scene_, setup_.run.seed, threads_);
  }

  LiveSurvey open(const std::filesystem::path& folder) const {
    return {setup_.survey(),
            setup_.live,
            setup_.identity(),
            folder,
            {first_view_, scene_.view_sphere()},
            threads_};
  }

  /// Returns the scan that `plan` would simulate from the proposed view.
  geometry::Scan scan(const LiveSurvey& survey) const {
    return sensor_.scan(scene_.scene(), *survey.proposal().view, survey.views().size(), threads_);
  }

  /// Returns false for enclosed views. Without a vehicle, `plan` derives this from the scene, and a
  /// crew sees it.
  bool can_reach(const LiveSurvey& survey) const {
    return setup_.flight().has_vehicle() || survey.views().empty() ||
           scene_.is_reachable(survey.proposal().view->position);
  }

  geometry::Scan scan(simulation::MountedSensor& mounted, const session::ViewInFlight& at,
                      std::uint64_t scans) const {
    return mounted.scan(scene_.scene(), at, scans, threads_);
  }

  void add_one(LiveSurvey& survey) const {
    survey.add(scan(survey), "scan " + std::to_string(survey.views().size()));
  }

  const config::MissionSetup& setup() const { return setup_; }

 private:
  config::MissionSetup setup_;
  evaluation::SurveyScene scene_;
  sim::SurveySensor sensor_;
  geometry::View first_view_;
  unsigned threads_;
};

/// Simulated sensor on its vehicle, which also measures en route.
class Platform {
 public:
  explicit Platform(const Rehearsal& rehearsal)
      : rehearsal_(rehearsal), sensor_(rehearsal.setup().simulation, rehearsal.setup().run.seed) {}

  struct RehearsedScan {
    geometry::Scan scan;
    bool is_en_route;
  };

  /// Returns the next scan of `plan`: the next frame en route to the proposed view, or the scan
  /// from the view.
  RehearsedScan next(LiveSurvey& survey) {
    const std::vector<session::ViewInFlight> frames = survey.frames();
    const geometry::View& view = *survey.proposal().view;
    session::ViewInFlight at =
        frames.empty() ? session::ViewInFlight{.view = view} : frames.front();
    if (frames.empty() && survey.flight() != nullptr && !survey.views().empty()) {
      elapsed_ += survey.flight()->time(survey.views().back().view, view);
    }
    at.time += elapsed_;
    return {rehearsal_.scan(sensor_, at, scans_++), !frames.empty()};
  }

  void add_next(LiveSurvey& survey) {
    const RehearsedScan taken = next(survey);
    const std::string id = "scan " + std::to_string(scans_);
    taken.is_en_route ? survey.add_en_route(taken.scan, id) : survey.add(taken.scan, id);
  }

 private:
  const Rehearsal& rehearsal_;
  simulation::MountedSensor sensor_;
  std::uint64_t scans_ = 0;
  double elapsed_ = 0.0;  ///< [s]
};

inline std::vector<Eigen::Vector3d> positions(const std::vector<session::EvaluatedView>& views) {
  std::vector<Eigen::Vector3d> positions;
  for (const session::EvaluatedView& view : views) {
    positions.push_back(view.surveyed.view.position);
    positions.push_back(view.surveyed.view.direction);
  }
  return positions;
}

/// Expects bitwise equality of all data that both kinds of surveys have.
inline void expect_same(const session::SurveyRecord& live, const session::SurveyRecord& planned) {
  EXPECT_EQ(live.stop_reason, planned.stop_reason);
  const std::vector<Eigen::Vector3d> ours = positions(live.views),
                                     theirs = positions(planned.views);
  const auto other = std::ranges::mismatch(ours, theirs).in1 - ours.begin();
  EXPECT_TRUE(ours == theirs) << "they differ from view " << other / 2 << " on";
  EXPECT_TRUE(live.cloud.positions == planned.cloud.positions);
  EXPECT_TRUE(live.cloud.views == planned.cloud.views);
  ASSERT_EQ(live.flight_record.has_value(), planned.flight_record.has_value());
  if (!live.flight_record) return;
  EXPECT_EQ(live.flight_record->rejected, planned.flight_record->rejected);
  EXPECT_EQ(live.flight_record->length(), planned.flight_record->length());
  EXPECT_EQ(live.flight_record->min_clearance(), planned.flight_record->min_clearance());
  EXPECT_EQ(live.en_route_frames(), planned.en_route_frames());
  EXPECT_EQ(live.flight_record->times, planned.flight_record->times);
}

/// Limits the mission to `views` views and optionally sets another planner.
inline std::string short_mission(std::string mission, const std::string& planner = "",
                                 int views = 5) {
  const std::string limit = "max_views: ", section = "planner: {";
  const std::size_t at = mission.find(limit) + limit.size();
  mission.replace(at, mission.find('}', at) - at, std::to_string(views));
  if (planner.empty()) return mission;
  return mission.insert(mission.find(section) + section.size(), "name: " + planner + ", ");
}

/// Returns a mission with a vehicle whose camera also measures en route. Its teapot is too distant
/// and too round for the pose check, which would suspect some of the many frames.
inline std::string moving_mission(const std::string& live = "", int views = 5) {
  std::string mission = short_mission(tests::flight_mission(live), "", views);
  const std::string section = "sensor: {";
  return mission.insert(mission.find(section) + section.size(), "capture: moving, ");
}

/// Returns the teapot mission, measured finely enough for the pose check, with the keys in `live`.
inline std::string fine_mission(const std::string& live = "") {
  std::string mission = short_mission(tests::quick_mission(live), "see++");
  const std::string noise = "sigma: 0.03";
  return mission.replace(mission.find(noise), noise.size(), "sigma: 0.001");
}

}  // namespace skycap::missions::online
