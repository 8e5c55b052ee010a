// The autopilot of the tests as a program, to fly a live survey by hand: real time, no faults.
//
//     test_autopilot MISSION PORT
//
// sends to udp:127.0.0.1:PORT until its vehicle, which stands on the mission's pad, has landed.
#include <filesystem>
#include <iostream>
#include <string>

#include "geometry/error.h"
#include "missions/derived/mission_flight.h"
#include "missions/derived/resolved_mission.h"
#include "missions/fly/network_port.h"
#include "missions/scene/survey_scene.h"
#include "tests/missions/fly/test_autopilot.h"

int main(int argc, char** argv) {
  using namespace skycap::missions;
  if (argc != 3) {
    std::cerr << "test_autopilot MISSION PORT\n";
    return 2;
  }
  try {
    const std::filesystem::path file = argv[1];
    const file::Mission mission = derived::read_mission(file);
    const scene::SurveyScene scene(mission, file.parent_path());
    fly::TestAutopilot autopilot(
        mission, derived::pad_of(mission, scene.first_view(mission.seed).position), {});
    fly::NetworkPort port(fly::parse_address(std::string("udpout:127.0.0.1:") + argv[2]));
    double flown = 0.0;
    fly::fly_in_real_time(autopilot, port, [&] {
      constexpr double farewell = 5.0;  // to say that it has landed [s]
      if (!autopilot.has_landed()) flown = autopilot.time();
      return autopilot.time() > flown + farewell;
    });
  } catch (const skycap::Error& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
