/// A mission of photos: the plan, and the verified flight through it.
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
#include "missions/photo/photo_site.h"
#include "survey/photo/photo_plan.h"
#include "survey/photo/photo_planner.h"

namespace skycap::missions::photo {

/// A closed tour through photos, straight and with a stop at each: to compare sets of photos.
struct PhotoTour {
  double length = 0.0;    ///< [m]
  double duration = 0.0;  ///< [s]; without the way from and to the pad; 0 without a vehicle
};

/// A pattern with its tours.
struct PatternTours {
  PhotoTour whole, pruned;
};

struct PhotoMission {
  survey::photo::PhotoPlanResult result;
  survey::photo::PhotoPlan plan;  ///< the photos that are flown to, in the order of the flight
  /// Pairs of plan.photos to be matched, see PhotoPlanResult::matching_pairs.
  std::vector<survey::photo::PhotoPair> pairs;
  PhotoTour tour;                                ///< of the plan
  std::vector<PatternTours> patterns;            ///< of result.patterns
  std::optional<package::SurveyMission> flight;  ///< with a vehicle
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<std::string> warnings;  ///< sentences for the user; the first thing to be read
};

/// The sentence that results of a mission carry which assumes free space.
inline constexpr const char* assumed_space_warning =
    "the airspace around the model is assumed free. Check it for trees, wires and anything that "
    "the model does not contain.";

/// Plans photos and the route through them, verified at the clearance against prior data. Photos
/// that the route cannot reach are replaced by others, up to twice. Throws what plan_photos() and
/// plan_flight() throw. `report` is told what is being done.
PhotoMission plan_photo_mission(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                                const std::stop_token& stop,
                                const std::function<void(const std::string&)>& report);

}  // namespace skycap::missions::photo
