#include "sim/models/families/families.h"

#include <algorithm>
#include <map>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/models/models.h"
#include "sim/scene/scene.h"
#include "tests/sim/models/closed_solids.h"
#include "tests/support/not_empty.h"

namespace skycap::sim::models {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr Fineness coarse{0.02};

class Families : public testing::TestWithParam<std::string_view> {
 protected:
  static FamilyScene make_scene(std::uint64_t seed) {
    const auto all = families();
    geometry::RandomNumbers draw(seed);
    return std::ranges::find(all, GetParam(), &Family::name)->make(draw, coarse);
  }
};

/// Random positions for the rays of a test.
class Positions {
 public:
  Vector3d within(const AlignedBox3d& box) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const double x = share(random_), y = share(random_), z = share(random_);
    return box.min() + Vector3d(x, y, z).cwiseProduct(box.sizes());
  }
  /// Returns a position outside all scenes, above z = 0.5.
  Vector3d around() {
    std::normal_distribution<double> normal;
    const double x = normal(random_), y = normal(random_), z = normal(random_);
    Vector3d position = 90.0 * Vector3d(x, y, z).normalized();
    position.z() = 0.5 + std::abs(position.z());
    return position;
  }

 private:
  std::mt19937_64 random_{7};
};

TEST_P(Families, AreClosedSolidsThatFaceOutward) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    for (const Part& part : testing_support::not_empty(make_scene(seed).parts)) {
      ASSERT_EQ(closedness_error(part.mesh), "") << part.name << ", seed " << seed;
    }
  }
}

TEST_P(Families, AreOnGroundAroundOrigin) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const AlignedBox3d box = bounding_box(join(make_scene(seed).parts));
    EXPECT_NEAR(box.min().z(), 0.0, 1e-9) << seed;
    EXPECT_LE(box.sizes().head<2>().maxCoeff(), 65.0) << seed;
    EXPECT_LE(box.max().z(), 55.0) << seed;
    EXPECT_TRUE(box.contains(Vector3d(0.0, 0.0, 0.5))) << seed;
  }
}

TEST_P(Families, DependOnlyOnSeed) {
  const geometry::Mesh one = join(make_scene(1).parts);
  EXPECT_EQ(join(make_scene(1).parts).vertices, one.vertices);
  EXPECT_NE(join(make_scene(2).parts).vertices, one.vertices);
}

TEST_P(Families, BlockRaysIntoSealedRoomsOnly) {
  Positions positions;
  std::size_t rooms = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const FamilyScene made = make_scene(seed);
    rooms += made.sealed_rooms.size() + made.open_rooms.size();
    const Scene scene(join(made.parts));
    for (const AlignedBox3d& room : made.sealed_rooms) {
      for (int i = 0; i < 2000; ++i) {
        ASSERT_TRUE(scene.is_blocked(positions.around(), positions.within(room)))
            << "seed " << seed;
      }
    }
    for (const AlignedBox3d& room : made.open_rooms) {
      int seen = 0;
      for (int i = 0; i < 20000; ++i) {
        seen += scene.is_blocked(positions.around(), positions.within(room)) ? 0 : 1;
      }
      EXPECT_GT(seen, 5) << "seed " << seed << ", room at " << room.center().transpose();
    }
  }
  if (rooms == 0) GTEST_SKIP() << "a family without rooms";
}

TEST(FamilyScenes, HaveSealedAndOpenRooms) {
  std::size_t sealed = 0, open = 0;
  for (const Family& family : families()) {
    geometry::RandomNumbers draw(1);
    const FamilyScene made = family.make(draw, coarse);
    sealed += made.sealed_rooms.size();
    open += made.open_rooms.size();
  }
  EXPECT_GT(sealed, 0U);
  EXPECT_GT(open, 0U);
}

std::string param_name(const testing::TestParamInfo<std::string_view>& family) {
  std::string name(family.param);
  std::ranges::replace(name, '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, Families,
                         testing::ValuesIn(model_families().begin(), model_families().end()),
                         param_name);

/// Returns the number of parts with each name.
std::map<std::string, int> count_objects(const FamilyScene& scene) {
  std::map<std::string, int> counts;
  for (const Part& part : scene.parts) ++counts[part.name];
  return counts;
}

FamilyScene drawn(FamilyScene (*make)(geometry::RandomNumbers&, const Fineness&),
                  std::uint64_t seed) {
  geometry::RandomNumbers draw(seed);
  return make(draw, coarse);
}

TEST(FamilyScenes, HaveTheNamedObjects) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    for (const Part& part : testing_support::not_empty(drawn(factory, seed).parts)) {
      const Vector3d size = bounding_box(part.mesh).sizes();
      if (part.name == "chimney") {
        EXPECT_GE(size.z(), 10.0 * size.x()) << "not slender";
      }
    }
    auto tower = count_objects(drawn(lattice_tower, seed));
    EXPECT_EQ(tower["brace"], 2 * tower["leg"]);
    EXPECT_EQ(tower["strut"], tower["leg"]);
    EXPECT_EQ(count_objects(drawn(fences, seed))["wire"], 18);
    const FamilyScene decks = drawn(garage, seed);
    EXPECT_EQ(decks.open_rooms.size() + 1, static_cast<std::size_t>(count_objects(decks)["deck"]));
    EXPECT_EQ(count_objects(drawn(statue, seed))["staff"], 1);
    EXPECT_EQ(count_objects(drawn(church, seed))["spire"], 1);
    EXPECT_EQ(count_objects(drawn(hillside, seed))["hill"], 1);
    EXPECT_GE(count_objects(drawn(grove, seed))["tree crown"], 7);
  }
}

TEST(FamilyScenes, HaveOldTownLanesWideEnoughToFlyThrough) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::vector<AlignedBox3d> houses;
    for (const Part& part : drawn(old_town, seed).parts) {
      if (part.name == "walls") houses.push_back(bounding_box(part.mesh));
    }
    ASSERT_FALSE(houses.empty());
    for (std::size_t i = 0; i < houses.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GE(houses[i].exteriorDistance(houses[j]), 2.6 - 1e-9);
      }
    }
  }
}

TEST(FamilyScenes, HaveGlassAndMirrorInGlassHouseOnly) {
  for (const std::string_view name : testing_support::not_empty(model_families())) {
    const std::vector<Surface> surfaces = builtin_surfaces(name);
    if (name != "glass-house") {
      EXPECT_TRUE(surfaces.empty()) << name;
      continue;
    }
    EXPECT_EQ(surfaces.size(), builtin_model(name).triangles.size());
    EXPECT_EQ(std::ranges::count(surfaces, Surface::glass),
              // Three fronts and one single surface.
              3 * std::ranges::count(surfaces, Surface::mirror));
    EXPECT_GT(std::ranges::count(surfaces, Surface::matt), 0);
  }
}

}  // namespace
}  // namespace skycap::sim::models
