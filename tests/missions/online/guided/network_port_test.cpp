#include "missions/online/guided/network_port.h"

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "missions/config/resolve.h"
#include "missions/online/guided/simulated_autopilot.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions::online {
namespace {

using flight::mavlink::Bytes;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::thrown_message;

constexpr std::uint32_t this_machine = 0x7F000001;

/// Returns a free UDP port of this machine.
std::uint16_t free_port() {
  const int handle = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(handle, reinterpret_cast<const sockaddr*>(&address), size), 0);
  ::getsockname(handle, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(handle);
  return ntohs(address.sin_port);
}

/// Receives until there are `size` bytes, for at most 20 s.
Bytes received(NetworkPort& port, std::size_t size) {
  Bytes all;
  const double end = port.now() + 20.0;
  while (all.size() < size && port.now() < end) {
    const Bytes more = port.receive(0.1);
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

TEST(NetworkAddress, ParsesThreeKinds) {
  const NetworkAddress waits = parse_address("udp:127.0.0.1:14550");
  EXPECT_EQ(waits.kind, NetworkAddress::Kind::udp_wait);
  EXPECT_EQ(waits.host, this_machine);
  EXPECT_EQ(waits.port, 14550);
  EXPECT_TRUE(waits.is_loopback());
  EXPECT_EQ(parse_address("udpout:10.0.0.7:1").kind, NetworkAddress::Kind::udp_send);
  EXPECT_EQ(parse_address("tcp:127.0.0.1:5760").kind, NetworkAddress::Kind::tcp);
  EXPECT_FALSE(parse_address("udp:0.0.0.0:14550").is_loopback());
}

TEST(NetworkAddress, RejectsInvalidAddresses) {
  for (const char* wrong : {"", "udp", "udp:14550", "serial:127.0.0.1:1", "udp:localhost:1",
                            "udp::1", "udp:1.2.3:4:5", "udp:1.2.3.4.5:6"}) {
    EXPECT_THAT(thrown_message([&] { parse_address(wrong); }), HasSubstr("must be udp:HOST:PORT"))
        << wrong;
  }
  for (const char* wrong : {"udp:127.0.0.1:0", "udp:127.0.0.1:65536",
                            "udp:127.0.0.1:", "udp:127.0.0.1:80x", "udp:127.0.0.1:-1"}) {
    EXPECT_THAT(thrown_message([&] { parse_address(wrong); }), HasSubstr("from 1 to 65535"))
        << wrong;
  }
}

TEST(NetworkPort, ReceivesOnlyFromFirstSender) {
  const std::uint16_t number = free_port();
  NetworkPort port({NetworkAddress::Kind::udp_wait, this_machine, number});
  NetworkPort first({NetworkAddress::Kind::udp_send, this_machine, number});
  NetworkPort second({NetworkAddress::Kind::udp_send, this_machine, number});
  port.send(Bytes{9});  // without a receiver
  first.send(Bytes{1, 2});
  EXPECT_EQ(received(port, 2), (Bytes{1, 2}));
  second.send(Bytes{3});
  first.send(Bytes{4});
  EXPECT_EQ(received(port, 1), Bytes{4});
  port.send(Bytes{5});
  EXPECT_EQ(received(first, 1), Bytes{5});
  EXPECT_TRUE(second.receive(0.05).empty());
}

TEST(NetworkPort, RejectsAddressInUse) {
  const std::uint16_t number = free_port();
  const NetworkAddress address{NetworkAddress::Kind::udp_wait, this_machine, number};
  const NetworkPort port(address);
  EXPECT_THAT(thrown_message([&] { NetworkPort other(address); }), HasSubstr("cannot resolve"));
  const NetworkAddress nobody{NetworkAddress::Kind::tcp, this_machine, number};
  EXPECT_THAT(thrown_message([&] { NetworkPort other(nobody); }), HasSubstr("cannot resolve"));
}

std::string flyable(std::string mission) {
  const std::string vehicle = "vehicle: generic";
  return mission.insert(mission.find(vehicle) + vehicle.size(), "_ardupilot");
}

/// Flies in the time of the port and communicates through it until `is_over` returns true.
void fly_in_real_time(SimulatedAutopilot& autopilot, flight::mavlink::Port& port,
                      const std::function<bool()>& is_over) {
  constexpr double listening = 0.02;  ///< [s]
  for (double last = port.now(); !is_over();) {
    autopilot.hear(port.receive(listening));
    const double now = port.now();
    port.send(autopilot.fly_on(now - last));
    last = now;
  }
}

/// Runs the program over the network and in real time, before the take-off.
TEST(FlyCommand, ReportsAutopilotMessages) {
  const tests::TestFolder folder;
  const std::string text = flyable(tests::flight_mission());
  const std::string mission = folder.write("m.yaml", text);
  const std::string number = std::to_string(free_port());
  std::atomic<bool> is_over = false;
  std::jthread vehicle([&] {
    SimulatedAutopilot autopilot(config::parse_mission(text, "m.yaml").flight(), {-75.0, 0.0, 0.0},
                                 {.rejects_arming = true});
    NetworkPort port(parse_address("udpout:127.0.0.1:" + number));
    fly_in_real_time(autopilot, port, [&] { return is_over.load(); });
  });
  const tests::ProgramRun run = tests::run_skycap(
      {"fly", mission, "--survey", folder / "survey", "--connect", "udp:127.0.0.1:" + number});
  is_over = true;
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err,
              HasSubstr("the autopilot rejected the command to arm (result 4): PreArm: Compass"));
  EXPECT_THAT(run.err, HasSubstr("resume the survey in "));
  EXPECT_EQ(run.out, "");
}

/// The survey is flown by the simulated autopilot of the program and is complete afterwards. With
/// the first two seeds, registration moves a scan by more than 1 m, which must not be rejected.
TEST(FlyCommand, FliesWithSimulatedAutopilot) {
  const tests::TestFolder folder;
  const std::string mission = folder.write("m.yaml", flyable(tests::flight_mission()));
  for (const std::string seed : {"1", "2", "3"}) {
    const tests::ProgramRun run =
        tests::run_skycap({"fly", mission, "--survey", folder / seed, "--connect", "simulated",
                           "--no-report", "--set", "seed=" + seed});
    EXPECT_EQ(run.exit_code, 0) << "seed " << seed << ": " << run.err;
    EXPECT_THAT(run.err, AllOf(HasSubstr("taking off to "), HasSubstr("survey completed\n"),
                               HasSubstr("returning to the take-off point\n")));
    EXPECT_THAT(run.out, HasSubstr("verified for every leg"));
  }
}

TEST(FlyCommand, RejectsUnsupportedMissions) {
  const tests::TestFolder folder;
  const auto rejection = [&](const std::string& text, const std::string& address) {
    return tests::run_skycap(
        {"fly", folder.write("m.yaml", text), "--survey", folder / "survey", "--connect", address});
  };
  const std::string here = "udp:127.0.0.1:1";
  const tests::ProgramRun px4 = rejection(tests::flight_mission(), here);
  EXPECT_EQ(px4.exit_code, 2);
  EXPECT_THAT(px4.err, HasSubstr("flight.vehicle generic does not use ArduPilot"));
  EXPECT_THAT(rejection(tests::quick_mission(), here).err, HasSubstr("flight.vehicle is missing"));
  std::string moving = flyable(tests::flight_mission());
  moving.insert(moving.find("sensor: {") + 9, "capture: moving, ");
  EXPECT_THAT(rejection(moving, here).err,
              HasSubstr("sensor.capture: moving conflicts with skycap fly"));
  EXPECT_THAT(rejection(flyable(tests::flight_mission()), "udp:nobody:1").err,
              HasSubstr("--connect udp:nobody:1: must be"));
}

}  // namespace
}  // namespace skycap::missions::online
