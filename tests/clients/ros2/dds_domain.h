/// DDS domain for one process and its child processes, restricted to this machine.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

#include <unistd.h>

namespace skycap::ros2 {

/// Returns a domain derived from the process id. Other processes may share it by chance, so topic
/// names must start with topics().
inline std::uint32_t own_domain() {
  ::setenv("CYCLONEDDS_URI",
           "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
           "<AllowMulticast>false</AllowMulticast></General><Discovery>"
           "<ParticipantIndex>auto</ParticipantIndex>"
           "<MaxAutoParticipantIndex>30</MaxAutoParticipantIndex>"
           "<Peers><Peer address=\"localhost\"/></Peers></Discovery></Domain></CycloneDDS>",
           1);
  return 20 + static_cast<std::uint32_t>(::getpid()) % 60;
}

inline std::string topics() { return "/test" + std::to_string(::getpid()); }

}  // namespace skycap::ros2
