/// Photo mission: plan of photos and verified route through them.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "missions/config/mission_setup.h"
#include "missions/package/flight_files.h"
#include "missions/photo/control_points.h"
#include "missions/photo/photo_site.h"
#include "survey/photo/photo_plan.h"
#include "survey/photo/photo_planner.h"

namespace skycap::missions::photo {

/// Closed tour through photos with straight legs and a stop at each photo, for the comparison of
/// sets of photos.
struct PhotoTour {
  double length = 0.0;  ///< Length [m].
  double duration =
      0.0;  ///< Duration without the legs from and to the pad [s]. 0 without a vehicle.
};

/// Tour through the first photos of the plan, most useful first.
struct TimeCurvePoint {
  std::size_t photos = 0;
  double completeness = 0.0;  ///< Expected completeness of the exposed surface.
  PhotoTour tour;
};

/// Tours of a pattern.
struct PatternTours {
  PhotoTour whole, pruned;
};

struct PhotoMission {
  survey::photo::PhotoPlanResult result;
  survey::photo::PhotoPlan plan;  ///< Photos of the route, in flight order.
  /// Pairs of plan.photos to be matched, see PhotoPlanResult::matching_pairs.
  std::vector<survey::photo::PhotoPair> pairs;
  PhotoTour tour;                                ///< Tour of the plan.
  std::vector<TimeCurvePoint> time_curve;        ///< Ascending numbers of photos.
  std::vector<PatternTours> patterns;            ///< Tours of result.patterns.
  std::optional<package::SurveyMission> flight;  ///< Flight, if the mission has a vehicle.
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<ControlPoint> control_points;  ///< Surveyed points, see control_table().
  std::vector<std::string> warnings;         ///< Warnings for the user, displayed first.
};

/// Warning in the results of a mission that assumes free space.
inline constexpr const char* assumed_space_warning =
    "the airspace around the model is assumed free. Check it for trees, wires and anything that "
    "the model does not contain";

/// Plans photos and the route through them, verified at the clearance against prior data. Replaces
/// photos that the route cannot reach, up to twice. Throws the same errors as plan_photos() and
/// plan_flight(). `report` receives progress messages.
PhotoMission plan_photo_mission(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                                const std::stop_token& stop,
                                const std::function<void(const std::string&)>& report);

}  // namespace skycap::missions::photo
