/// Predicted quality of the reconstruction at samples of the target's surface, for maps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "missions/config/mission_setup.h"
#include "missions/photo/photo_mission.h"
#include "missions/photo/photo_site.h"

namespace skycap::missions::photo {

inline constexpr const char* surface_map_name = "photo_surface.csv";

/// Classes of surface samples, as in survey::photo::PhotoFigures.
enum class SurfaceClass : std::uint8_t { good, weak, missing };
/// Returns the name for files: "good", "weak" or "missing".
const char* to_string(SurfaceClass value);

/// Exposed sample of the target with the photos of the plan that observe it.
struct SurfaceSample {
  Eigen::Vector3f position;  ///< Position in the mission frame [m].
  SurfaceClass quality = SurfaceClass::missing;
  int partners = -2;               ///< Stereo partners k; -2 without observations.
  std::uint32_t observations = 0;  ///< Photos that observe it. Photos at one position count once.
  double gsd = 0.0;                ///< Smallest ground sampling distance, head-on [m]. 0: none.
  double parallax = 0.0;   ///< Largest parallax of a pair of stereo partners [rad]. 0: none.
  double incidence = 0.0;  ///< Smallest angle of incidence [rad].
};

/// Evaluates the photos of a plan at samples that the planner has not used. The result does not
/// depend on the number of threads.
std::vector<SurfaceSample> evaluate_surface(const config::MissionSetup& setup,
                                            const PhotoAirspace& airspace,
                                            const survey::photo::PhotoPlan& plan);

/// Returns a CSV table with the columns x, y, z [m], class, partners, observations, gsd_m,
/// parallax_deg and incidence_deg. The last three are empty without a value.
std::string surface_table(const std::vector<SurfaceSample>& samples);

}  // namespace skycap::missions::photo
