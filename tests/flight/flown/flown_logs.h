/// Writes logs of simulated flights in the formats of ArduPilot and PX4.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/export/geodesy.h"
#include "flight/flown/flown_track.h"

namespace skycap::flight {

/// State of a simulated flight in the mission's frame.
struct FlownState {
  TrackState state;
  bool is_capture = false;
};

/// Returns a flight along a polyline at `speed` [m/s], with a rest of `rest` [s] and a capture at
/// each of the positions with these indices. The camera looks north, 20 degrees down. States are
/// 0.1 s apart.
std::vector<FlownState> fly_polyline(const std::vector<Eigen::Vector3d>& points,
                                     const std::vector<std::size_t>& captures, double speed = 4.0,
                                     double rest = 2.0);

/// Message layouts of ArduPilot versions. That of 2014 has neither POS nor captures.
enum class DataflashLayout {
  copter_3_2_of_2014,
  copter_3_6_of_2019,
  copter_4_1_of_2021,
  copter_4_6_of_2025
};

/// Returns an ArduPilot log with POS, ATT, MNT (since 2022) and CAM messages. Heights are those of
/// `site`, which must have a geoid undulation; `pad` is the take-off point.
std::string write_dataflash(const std::vector<FlownState>& flight, const Site& site,
                            const Eigen::Vector3d& pad,
                            DataflashLayout layout = DataflashLayout::copter_4_6_of_2025);

/// Topics of PX4 versions.
enum class UlogLayout { px4_1_9_of_2019, px4_1_16_of_2025 };

/// Returns a PX4 log with position, attitude, gimbal (since 2021) and camera_capture.
std::string write_ulog(const std::vector<FlownState>& flight, const Site& site,
                       const Eigen::Vector3d& pad,
                       UlogLayout layout = UlogLayout::px4_1_16_of_2025);

}  // namespace skycap::flight
