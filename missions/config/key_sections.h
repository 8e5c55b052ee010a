/// Sections of the mission file in the order of the reference manual.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "missions/config/key.h"

namespace skycap::missions::config {

std::vector<Key> general_keys();
std::vector<Key> scene_keys();
std::vector<Key> sensor_keys();
std::vector<Key> photo_keys();
std::vector<Key> inspection_keys();
std::vector<Key> planner_keys();
std::vector<Key> volumetric_keys();
std::vector<Key> uniform_keys();
std::vector<Key> pb_nbv_keys();
std::vector<Key> pattern_keys();
std::vector<Key> start_keys();
std::vector<Key> limits_keys();
std::vector<Key> evaluation_keys();
std::vector<Key> paper_keys();
std::vector<Key> site_keys();
std::vector<Key> flight_keys();
std::vector<Key> scan_keys();
std::vector<Key> live_keys();
std::vector<Key> prior_keys();

struct KeySection {
  std::string_view name;  ///< prefix of the section's keys; empty for top-level keys
  std::vector<Key> (*keys)();
};

inline constexpr std::array<KeySection, 19> key_sections{{{"", general_keys},
                                                          {"scene", scene_keys},
                                                          {"sensor", sensor_keys},
                                                          {"photo", photo_keys},
                                                          {"inspection", inspection_keys},
                                                          {"planner", planner_keys},
                                                          {"volumetric", volumetric_keys},
                                                          {"uniform", uniform_keys},
                                                          {"pb_nbv", pb_nbv_keys},
                                                          {"pattern", pattern_keys},
                                                          {"start", start_keys},
                                                          {"limits", limits_keys},
                                                          {"evaluation", evaluation_keys},
                                                          {"paper", paper_keys},
                                                          {"site", site_keys},
                                                          {"flight", flight_keys},
                                                          {"scan", scan_keys},
                                                          {"live", live_keys},
                                                          {"prior", prior_keys}}};

}  // namespace skycap::missions::config
