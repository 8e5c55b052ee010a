// The autopilot of the tests as a program, for manual tests of live surveys in real time, without
// faults.
//
// test_autopilot MISSION PORT
//
// It sends to udp:127.0.0.1:PORT. Its vehicle starts on the mission's pad. The program ends after
// the landing.
#include <filesystem>
#include <iostream>
#include <string>

#include "geometry/error.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/online/guided/network_port.h"
#include "tests/missions/online/guided/test_autopilot.h"

int main(int argc, char** argv) {
  using namespace skycap::missions;
  if (argc != 3) {
    std::cerr << "test_autopilot MISSION PORT\n";
    return 2;
  }
  try {
    const std::filesystem::path file = argv[1];
    const config::MissionSetup setup = config::read_mission(file);
    const evaluation::SurveyScene scene(setup.simulation, file.parent_path(), setup.run.threads);
    online::TestAutopilot autopilot(
        setup.flight(), setup.flight().pad(scene.first_view(setup.run.seed).position), {});
    online::NetworkPort port(online::parse_address(std::string("udpout:127.0.0.1:") + argv[2]));
    double elapsed = 0.0;
    online::fly_in_real_time(autopilot, port, [&] {
      constexpr double farewell = 5.0;  // time to report the landing [s]
      if (!autopilot.has_landed()) elapsed = autopilot.time();
      return autopilot.time() > elapsed + farewell;
    });
  } catch (const skycap::Error& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
