/// A domain of DDS for one process and those that it starts, on this machine alone.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

#include <unistd.h>

namespace skycap::ros2 {

/// Other processes may be in the same domain by chance; names that begin with topics() differ.
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
