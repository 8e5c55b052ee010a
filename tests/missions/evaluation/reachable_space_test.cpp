#include "missions/evaluation/reachable_space.h"

#include <queue>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "geometry/surfaces/mesh_distance.h"
#include "sim/scene/scene.h"
#include "tests/missions/room_scene.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using evaluation::ReachableSpace;
using tests::Room;
using tests::room_mesh;

/// Accepts straight paths that keep the radius from the surface.
ReachableSpace::Joins keeping(double radius, const geometry::MeshDistance& distance) {
  return [&distance, radius](const Vector3d& a, const Vector3d& b) {
    return distance.keeps(a, b, radius);
  };
}

bool leads_inside(const geometry::Mesh& mesh, const ReachableSpace::Config& config,
                  const Vector3d& node_position = {0, 0, 5}) {
  const geometry::MeshDistance distance(mesh);
  const auto joins = keeping(std::max(config.radius, 1e-9), distance);
  return ReachableSpace(distance, geometry::bounding_box(mesh), config, joins)
      .leads_to(node_position, joins);
}

TEST(ReachableSpace, ExcludesSealedRooms) {
  const geometry::Mesh box = sim::models::box({-12, -12, 0}, {12, 12, 24});
  for (const double radius : {0.0, 0.5, 5.0}) {
    EXPECT_FALSE(leads_inside(box, {.radius = radius})) << radius;
    EXPECT_FALSE(leads_inside(box, {.radius = radius}, {11.9, 11.9, 0.1})) << radius;
    EXPECT_TRUE(leads_inside(box, {.radius = radius}, {0, 0, 29.5})) << radius;
    EXPECT_TRUE(leads_inside(box, {.radius = radius}, {500, 0, 1})) << radius;
  }
}

// The door decides: if it is 3.5 cells (an eighth of the radius each) wider than the ball, the room
// counts. If it is narrower than the ball, it does not.
TEST(ReachableSpace, IncludesRoomsWithWideDoors) {
  Room room{.door_width = 5.0, .door_height = 5.0};
  EXPECT_TRUE(leads_inside(room_mesh(room), {.radius = 2.0}));
  EXPECT_FALSE(leads_inside(room_mesh(room), {.radius = 2.6}));
  room.door_width = 3.9;
  EXPECT_FALSE(leads_inside(room_mesh(room), {.radius = 2.0}));
  EXPECT_TRUE(leads_inside(room_mesh(room), {.radius = 1.0}));
  room.door_height = 1.9;
  EXPECT_FALSE(leads_inside(room_mesh(room), {.radius = 1.0}));
  EXPECT_TRUE(leads_inside(room_mesh(room), {.radius = 0.0}));
}

TEST(ReachableSpace, StartsAtConfiguredPosition) {
  const geometry::Mesh sealed = room_mesh({});
  const ReachableSpace::Config inside{.radius = 1.0, .start = Vector3d(3, 3, 3)};
  EXPECT_TRUE(leads_inside(sealed, inside, {-8, -8, 8}));
  EXPECT_FALSE(leads_inside(sealed, inside, {0, 0, 15}));
  EXPECT_FALSE(leads_inside(sealed, inside, {0, 0, 1000}));
  const geometry::Mesh open = room_mesh({.door_width = 5.0, .door_height = 5.0});
  EXPECT_TRUE(leads_inside(open, inside, {0, 0, 1000}));
  const ReachableSpace::Config outside{.radius = 1.0, .start = Vector3d(0, -40, 3)};
  EXPECT_TRUE(leads_inside(open, outside));
  EXPECT_FALSE(leads_inside(sealed, outside));
}

// From a start inside a wall, nothing is reachable.
TEST(ReachableSpace, IsEmptyWhenStartIsEnclosed) {
  const geometry::Mesh mesh = room_mesh({});
  const auto nowhere = [](const Vector3d&, const Vector3d&) { return false; };
  const geometry::MeshDistance surface(mesh);
  const auto is_empty = [&](const ReachableSpace::Config& config) {
    return ReachableSpace(surface, geometry::bounding_box(mesh), config, nowhere).is_empty();
  };
  EXPECT_TRUE(is_empty({.radius = 1.0, .start = Vector3d(10.25, 0, 5)}));
  EXPECT_FALSE(is_empty({.radius = 1.0}));
}

// A bell that is open at the bottom: a path leads in under its rim, unless the minimum height
// prevents it.
TEST(ReachableSpace, RespectsHeightLimits) {
  geometry::Mesh bell = sim::models::box({-10, -10, 20}, {10, 10, 21});
  for (const double x : {-10.0, 9.0}) {
    geometry::append(bell, sim::models::box({x, -10, 10}, {x + 1, 10, 20}));
    geometry::append(bell, sim::models::box({-10, x, 10}, {10, x + 1, 20}));
  }
  const Vector3d inside(0, 0, 15);
  EXPECT_TRUE(leads_inside(bell, {.radius = 1.0}, inside));
  EXPECT_TRUE(leads_inside(bell, {.radius = 1.0, .min_height = 5.0}, inside));
  EXPECT_FALSE(leads_inside(bell, {.radius = 1.0, .min_height = 10.5}, inside));
  EXPECT_FALSE(leads_inside(bell, {.radius = 1.0, .max_height = 9.5}, inside));
  EXPECT_TRUE(leads_inside(bell, {.radius = 1.0, .min_height = 10.5}, {0, 0, 40}));
}

/// Returns a room with a door and random blocks, which create passages of all widths.
geometry::Mesh cluttered_room(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
  };
  geometry::Mesh mesh = room_mesh({.door_width = 6.0, .door_height = 6.0});
  for (int i = 0; i < 14; ++i) {
    const double z = draw(0, 7), y = draw(-14, 8), x = draw(-10, 6);
    const Vector3d low(x, y, z), size{draw(1, 8), draw(1, 8), draw(1, 8)};
    geometry::append(mesh, sim::models::box(low, low + size));
  }
  return mesh;
}

/// Reference: nodes of a plain grid that keep `clearance` and are connected with the grid corner.
class GridFlood {
 public:
  static constexpr int count = 36;
  static constexpr double step = 0.8;

  GridFlood(const std::vector<double>& distances, double clearance) : is_reached(distances.size()) {
    std::queue<int> pending;
    const auto take = [&](int node) {
      if (is_reached[node] || distances[node] < clearance) return;
      is_reached[node] = true;
      pending.push(node);
    };
    take(0);
    for (; !pending.empty(); pending.pop()) {
      const int node = pending.front();
      const int x = node % count, y = node / count % count, z = node / (count * count);
      if (x > 0) take(node - 1);
      if (x + 1 < count) take(node + 1);
      if (y > 0) take(node - count);
      if (y + 1 < count) take(node + count);
      if (z > 0) take(node - count * count);
      if (z + 1 < count) take(node + count * count);
    }
  }

  static Vector3d node_position(int node) {
    const Eigen::Vector3i cell(node % count - count / 2, node / count % count - count / 2,
                               node / (count * count) - count / 4);
    return step * cell.cast<double>();
  }

  std::vector<bool> is_reached;
};

// The result is between two grids: a stricter one, whose paths are also paths of the cells, and a
// looser one, which contains all paths of the cells.
TEST(ReachableSpace, LiesBetweenStricterAndLooserGrids) {
  constexpr double radius = 0.8;
  for (const std::uint64_t seed : {1, 2}) {
    const geometry::Mesh mesh = cluttered_room(seed);
    const geometry::MeshDistance distance(mesh);
    std::vector<double> distances;
    constexpr int nodes = GridFlood::count * GridFlood::count * GridFlood::count;
    distances.reserve(nodes);
    for (int i = 0; i < nodes; ++i) {
      distances.push_back(distance.distance(GridFlood::node_position(i)));
    }
    const auto joins = keeping(radius, distance);
    const ReachableSpace space(distance, geometry::bounding_box(mesh), {.radius = radius}, joins);
    const GridFlood stricter(distances, radius + 1.74 * space.cell() + 0.5 * GridFlood::step);
    const GridFlood looser(distances, radius - 0.87 * GridFlood::step);
    std::size_t inside = 0, kept_out = 0;
    for (int i = 0; i < static_cast<int>(distances.size()); ++i) {
      const bool is_reached = space.leads_to(GridFlood::node_position(i), joins);
      ASSERT_TRUE(is_reached || !stricter.is_reached[i]) << GridFlood::node_position(i).transpose();
      ASSERT_TRUE(!is_reached || looser.is_reached[i]) << GridFlood::node_position(i).transpose();
      ASSERT_TRUE(!is_reached || distances[i] >= radius) << GridFlood::node_position(i).transpose();
      inside += is_reached;
      kept_out += !is_reached && distances[i] >= radius;
    }
    EXPECT_GT(inside, 20'000U);
    EXPECT_GT(kept_out, 0U) << "a scene that proves nothing";
  }
}

TEST(ReachableSpace, IsSameForAnyThreadCount) {
  const geometry::Mesh mesh = cluttered_room(5);
  const geometry::MeshDistance distance(mesh);
  const auto joins = keeping(0.8, distance);
  const ReachableSpace one(distance, geometry::bounding_box(mesh), {.radius = 0.8, .threads = 1},
                           joins);
  const ReachableSpace three(distance, geometry::bounding_box(mesh), {.radius = 0.8, .threads = 3},
                             joins);
  EXPECT_EQ(one.size(), three.size());
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-15.0, 15.0);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d node_position{uniform(random), uniform(random), uniform(random)};
    EXPECT_EQ(one.leads_to(node_position, joins), three.leads_to(node_position, joins));
  }
}

ReachableSpace room_space(const geometry::MeshDistance& distance, const geometry::Mesh& mesh) {
  return {distance, geometry::bounding_box(mesh), {.radius = 1.0}, keeping(1.0, distance)};
}

TEST(ReachableSpace, ReadsBackFromFile) {
  const geometry::Mesh mesh = room_mesh({.door_width = 5.0, .door_height = 5.0});
  const geometry::MeshDistance distance(mesh);
  const ReachableSpace space = room_space(distance, mesh);
  const auto again = ReachableSpace::read(space.bytes());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->bytes(), space.bytes());
  EXPECT_EQ(again->cell(), space.cell());
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> somewhere(-16.0, 16.0);
  for (int i = 0; i < 2000; ++i) {
    const double z = somewhere(random), y = somewhere(random), x = somewhere(random);
    const auto joins = keeping(1.0, distance);
    EXPECT_EQ(again->leads_to({x, y, z}, joins), space.leads_to({x, y, z}, joins));
  }
}

TEST(ReachableSpace, RejectsCorruptedFile) {
  const geometry::Mesh mesh = room_mesh({.door_width = 5.0, .door_height = 5.0});
  const geometry::MeshDistance distance(mesh);
  const std::string whole = room_space(distance, mesh).bytes();
  EXPECT_FALSE(ReachableSpace::read(""));
  EXPECT_FALSE(ReachableSpace::read(whole.substr(0, whole.size() - 4)));
  EXPECT_FALSE(ReachableSpace::read(whole + "more"));
  // File signature, cell size, cell count and cells: none of them may differ.
  for (const std::size_t at : {0UL, 23UL, 48UL, 56UL, 64UL, whole.size() / 2, whole.size() - 1}) {
    std::string other = whole;
    other[at] = static_cast<char>(other[at] ^ 0x40);
    EXPECT_FALSE(ReachableSpace::read(other)) << at;
  }
}

}  // namespace
}  // namespace skycap::missions
