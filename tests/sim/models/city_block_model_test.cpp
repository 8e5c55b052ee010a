#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/models/city_block.h"
#include "sim/models/models.h"
#include "sim/scene/scene.h"
#include "tests/sim/models/closed_solids.h"
#include "tests/support/not_empty.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

/// Returns the bounding boxes of the buildings by the number in their part names.
std::map<int, Eigen::AlignedBox3d> buildings(const models::Parts& parts) {
  std::map<int, Eigen::AlignedBox3d> boxes;
  for (const models::Part& part : parts) {
    if (part.name.starts_with("building ")) {
      boxes[std::stoi(part.name.substr(9))].extend(bounding_box(part.mesh));
    }
  }
  return boxes;
}

bool has(const models::Parts& parts, const std::string& what) {
  return std::any_of(parts.begin(), parts.end(), [&](const models::Part& part) {
    return part.name.find(what) != std::string::npos;
  });
}

TEST(CityBlock, HasNineToSixteenSeparateBuildingsOnItsGround) {
  std::set<std::size_t> counts;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const models::Parts parts = models::city_block({seed, {0.1}});
    const auto boxes = buildings(parts);
    EXPECT_THAT(boxes.size(), testing::AllOf(testing::Ge(9U), testing::Le(16U)));
    counts.insert(boxes.size());
    for (const auto& [one, box] : boxes) {
      EXPECT_LE(box.max().head<2>().cwiseAbs().maxCoeff(), 100.0);
      EXPECT_LE(box.min().head<2>().cwiseAbs().maxCoeff(), 100.0);
      EXPECT_NEAR(box.min().z(), 0.0, 1e-9);
      for (const auto& [other, its_box] : boxes) {
        EXPECT_EQ(box.intersects(its_box), one == other) << "seed " << seed;
      }
    }
    for (const char* what : {"arcade pier", "tower spire", "tree crown", "pavement"}) {
      EXPECT_TRUE(has(parts, what)) << what << ", seed " << seed;
    }
  }
  EXPECT_GT(counts.size(), 2U);  // the number depends on the seed
}

TEST(CityBlock, HasClosedPartsThatFaceOutward) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const models::Part& part :
         testing_support::not_empty(models::city_block({seed, {0.02}}))) {
      ASSERT_EQ(models::closedness_error(part.mesh), "") << part.name << ", seed " << seed;
    }
  }
}

TEST(CityBlock, ShowsNoBackFaceFromAbove) {
  const Scene scene(builtin_model("city-block"));
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> coordinate(-100.0, 100.0), height(0.5, 60.0);
  int backs = 0, hits = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vector3d from{coordinate(random), coordinate(random), 80.0};
    const Vector3d to{coordinate(random), coordinate(random), height(random) * 0.2};
    const auto hit = scene.first_hit(from, (to - from).normalized());
    if (!hit) continue;
    ++hits;
    backs += hit->normal.dot(to - from) > 0.0;
  }
  EXPECT_GT(hits, 90000);
  EXPECT_EQ(backs, 0);
}

TEST(CityBlock, HasArcadesThatAreOpenAlongWalkAndThroughArches) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const models::Parts parts = models::city_block({seed, {0.02}});
    const Scene scene(join(parts));
    int arcades = 0;
    for (const auto& [name, mesh, surface] : parts) {
      if (name.find("arcade wall") == std::string::npos) continue;
      ++arcades;
      const Eigen::AlignedBox3d wall = bounding_box(mesh);
      // The walkway behind the wall is 2.9 m wide.
      const double eye = 1.6, walk = wall.max().y() + 1.45;
      EXPECT_FALSE(scene.is_blocked({wall.min().x(), walk, eye}, {wall.max().x(), walk, eye}));
      int rays = 0, through = 0;
      for (double x = wall.min().x(); x < wall.max().x(); x += 0.05, ++rays) {
        through += !scene.is_blocked({x, wall.min().y() - 0.3, eye}, {x, walk, eye});
      }
      // Piers of 0.9 m in bays of 4.2 to 5.6 m.
      EXPECT_GT(through, 0.7 * rays);
      EXPECT_LT(through, 0.9 * rays);
    }
    EXPECT_GT(arcades, 0);
  }
}

TEST(CityBlock, HasCourtsEnclosedByWingsAndOpenToSky) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const models::Parts parts = models::city_block({seed, {0.02}});
    const Scene scene(join(parts));
    int courts = 0;
    for (const auto& [number, box] : buildings(parts)) {
      const Vector3d middle(box.center().x(), box.center().y(), 2.0);
      if (scene.is_blocked(middle + Vector3d(0, 0, 80), middle)) continue;
      int walls = 0;
      for (const Vector3d& side :
           {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0)}) {
        walls += scene.is_blocked(middle, middle + 0.5 * box.sizes().cwiseProduct(side));
      }
      courts += walls == 4;
    }
    EXPECT_GE(courts, 2) << "one in each row of backs, seed " << seed;
  }
}

TEST(CityBlock, DependsOnlyOnSeed) {
  ModelOptions options;
  options.detail = LevelOfDetail::coarse;
  options.seed = 4;
  const geometry::Mesh one = builtin_model("city-block", options);
  EXPECT_EQ(builtin_model("city-block", options).vertices, one.vertices);
  options.seed = 5;
  EXPECT_NE(builtin_model("city-block", options).vertices.size(), one.vertices.size());
}

TEST(BuiltinModel, HasGroundOnRequest) {
  ModelOptions options;
  options.detail = LevelOfDetail::coarse;
  for (const std::string_view name : testing_support::not_empty(builtin_models())) {
    options.has_ground = false;
    const geometry::Mesh bare = builtin_model(name, options);
    options.has_ground = true;
    const geometry::Mesh grounded = builtin_model(name, options);
    EXPECT_EQ(grounded.triangles.size(), bare.triangles.size() + 2) << name;
    const auto hit = Scene(grounded).first_hit(
        bounding_box(grounded).max() - Vector3d(0.1, 0.1, 0.0), {0.0, 0.0, -1.0});
    ASSERT_TRUE(hit) << name;
    EXPECT_GT(hit->normal.z(), 0.99) << name;
  }
}

TEST(BuiltinModel, ListsModelsWhenNameIsUnknown) {
  try {
    builtin_model("bodleian");
    FAIL() << "made a model without a name";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_config);
    EXPECT_THAT(
        error.what(),
        testing::AllOf(testing::HasSubstr("'bodleian'"), testing::HasSubstr("city-block"),
                       testing::HasSubstr("radcliffe-camera"), testing::HasSubstr("teapot")));
  }
}

}  // namespace
}  // namespace skycap::sim
