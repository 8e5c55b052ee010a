// Random small targets, cameras and limits: each mission is verified, or rejected with one line.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/config/mission_document.h"
#include "missions/config/photo_camera_reader.h"
#include "missions/config/resolve.h"
#include "missions/config/vehicle_reader.h"
#include "missions/photo/photo_mission.h"
#include "missions/site_data/site_priors.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

/// Draws numbers in a defined order.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  std::size_t below(std::size_t count) { return engine_() % count; }
  template <typename List>
  auto pick(const List& list) {
    return list[below(list.size())];
  }

 private:
  std::mt19937_64 engine_;
};

/// Boxes on the ground: one, or a second one beside or on top of it.
std::string boxes_obj(Draw& draw) {
  std::string text;
  const std::size_t count = 1 + draw.below(2);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = draw.between(-3, 3), y = draw.between(-3, 3), z = draw.below(4) == 0 ? 2 : 0;
    const double a = draw.between(0.5, 5), b = draw.between(0.5, 5), h = draw.between(0.5, 8);
    for (int corner = 0; corner < 8; ++corner) {
      text += fmt::format("v {:.3f} {:.3f} {:.3f}\n", x + ((corner & 1) != 0 ? a : -a),
                          y + ((corner & 2) != 0 ? b : -b), z + ((corner & 4) != 0 ? h : 0.0));
    }
    for (const auto& [p, q, r, s] : std::vector<std::array<int, 4>>{
             {1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {2, 4, 8, 6}, {4, 3, 7, 8}, {3, 1, 5, 7}}) {
      const int first = 8 * static_cast<int>(i);
      text += fmt::format("f {} {} {} {}\n", first + p, first + q, first + r, first + s);
    }
  }
  return text;
}

std::string mission_text(Draw& draw) {
  const std::string camera(draw.pick(config::photo_camera_presets()));
  const std::string vehicle(draw.pick(config::vehicle_presets()));
  const double gsd = draw.between(0.0008, 0.006);
  const char* patterns = draw.below(2) == 0 ? "[]" : "[dome]";
  const auto max_photos = 4 + draw.below(20);
  const auto min_partners = 2 + draw.below(3);
  std::string text = fmt::format(
      "sensor: {{photo_camera: {}}}\n"
      "photo:\n  gsd: {:.5f}\n  patterns: {}\n  max_photos: {}\n  min_partners: {}\n",
      camera, gsd, patterns, max_photos, min_partners);
  if (draw.below(3) == 0) text += "  poses: unknown\n";
  text += "prior: [{file: boxes.obj, role: target, uncertainty: 0.1}]\n";
  text += fmt::format("limits:\n  stand_off: {:.2f}\n", draw.between(0.5, 5));
  const double clearance = draw.between(1, 4);
  const char* free_space = draw.below(4) == 0 ? "measured" : "assumed";
  text += fmt::format(
      "flight:\n  vehicle: {}\n  clearance: {:.2f}\n  position_error: 0.1\n  free_space: {}\n",
      vehicle, clearance, free_space);
  if (draw.below(4) == 0)
    text += fmt::format("site: {{max_height: {:.1f}}}\n", draw.between(5, 60));
  return text;
}

/// The environment variable SKYCAP_RANDOM_PHOTO_MISSIONS sets another number of missions.
std::size_t number_of_missions() {
  constexpr std::size_t usual = 1;
  const char* requested = std::getenv("SKYCAP_RANDOM_PHOTO_MISSIONS");
  return requested == nullptr ? usual : std::stoul(requested);
}

void expect_verified(const config::MissionSetup& setup, const photo::PhotoMission& mission) {
  ASSERT_TRUE(mission.flight);
  const flight::Route& route = mission.flight->route;
  const double required = setup.flight().budget().total();
  EXPECT_GE(route.min_clearance, required);
  EXPECT_FALSE(route.capture_points.empty());
  EXPECT_EQ(mission.plan.photos.size(), route.capture_points.size());
  // Independent of the planner's space: exact distances to the target's surface.
  const geometry::MeshDistance target(make_surfaces(*setup.scene().priors, site_data::Role::target),
                                      1);
  for (const flight::CapturePoint& point : route.capture_points) {
    EXPECT_GE(target.distance(point.view.position), required);
  }
  for (const flight::Leg& leg : route.legs) {
    for (std::size_t i = 1; i < leg.points.size(); ++i) {
      for (int part = 0; part <= 10; ++part) {
        const Eigen::Vector3d position =
            leg.points[i - 1] + 0.1 * part * (leg.points[i] - leg.points[i - 1]);
        EXPECT_GE(target.distance(position), required - 1e-6);
      }
    }
  }
}

TEST(RandomPhotoMissions, AreVerifiedOrRejectedWithOneLine) {
  const testing_support::TemporaryFolder folder;
  const std::size_t count = number_of_missions();
  std::size_t verified = 0;
  for (std::size_t seed = 1; seed <= count; ++seed) {
    Draw draw(seed);
    std::ofstream(folder.path() / "boxes.obj") << boxes_obj(draw);
    const std::string text = mission_text(draw);
    SCOPED_TRACE(fmt::format("seed {}\n{}", seed, text));
    std::ofstream(folder.path() / "mission.yaml") << text;
    try {
      const config::MissionSetup setup = config::read_mission(folder.path() / "mission.yaml", {});
      const photo::PhotoAirspace airspace(setup, 1);
      const photo::PhotoMission mission =
          photo::plan_photo_mission(setup, airspace, {}, [](const std::string&) {});
      expect_verified(setup, mission);
      ++verified;
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_FALSE(message.empty());
      EXPECT_EQ(std::ranges::count(message, '\n'), 0) << message;
      if (count > 3) fmt::print("seed {}: {}\n", seed, message);
    }
  }
  if (count > 3) fmt::print("{} of {} missions verified\n", verified, count);
  EXPECT_GE(verified, count / 4);
}

}  // namespace
}  // namespace skycap::missions
