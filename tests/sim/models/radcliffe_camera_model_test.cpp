#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/pose/pose.h"
#include "sim/models/models.h"
#include "sim/models/radcliffe_camera.h"
#include "sim/scene/scene.h"
#include "tests/sim/models/closed_solids.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double full_size = 42.672 / 40.0;  // metres of the building for each metre of the model
const models::RadcliffeTable table;

const geometry::Mesh& building() {
  static const geometry::Mesh mesh = builtin_model("radcliffe-camera");
  return mesh;
}

const Scene& scene() {
  static const Scene model_scene(building());
  return model_scene;
}

/// Returns the full-size radius at which a level ray towards the axis meets the building at height
/// z. Returns 0 if the ray misses.
double radius_at(double azimuth, double z) {
  const Vector3d out(std::cos(azimuth), std::sin(azimuth), 0.0);
  const Vector3d from = 30.0 * out + Vector3d(0.0, 0.0, z / full_size);
  const auto hit = scene().first_hit(from, -out, 30.0);
  return hit ? (30.0 - hit->distance) * full_size : 0.0;
}

/// Returns the number of separate intervals on the ring at height z whose radius meets the
/// condition. With 14,400 rays, the step at the wall is 6 mm.
template <typename Condition>
int stretches(double z, Condition condition) {
  constexpr int rays = 14400;
  int count = 0;
  bool before = condition(radius_at(-pi / rays, z));
  for (int i = 0; i < rays; ++i) {
    const bool now = condition(radius_at(2.0 * pi * (i + 0.5) / rays, z));
    count += now && !before;
    before = now;
  }
  return count;
}

int count_beyond(double radius, double z) {
  return stretches(z, [&](double r) { return r > radius; });
}
int count_within(double radius, double z) {
  return stretches(z, [&](double r) { return r < radius; });
}

// A chord error of 4 mm in model size. Rays hit facets anywhere on their chord.
constexpr double facet = 0.006;

TEST(RadcliffeCamera, IsFortyMetresTall) {
  const Eigen::AlignedBox3d box = bounding_box(building());
  EXPECT_NEAR(box.min().z(), 0.0, 1e-9);
  EXPECT_NEAR(box.max().z(), 40.0, 1e-9);
  EXPECT_LT(box.sizes().head<2>().maxCoeff(), 40.0);
  // 100 ft across two projections, on the east-west axis without the steps.
  EXPECT_NEAR(2 * radius_at(0.0, 6.2), 30.48, 0.4);  // on a keystone or next to it
}

TEST(RadcliffeCamera, HasStageHeightsOfTable) {
  // Source: 80 ft to the balustrade and 60 ft above it.
  EXPECT_NEAR(table.balustrade_top(), 24.4, 0.02);
  EXPECT_NEAR(table.total_height - table.balustrade_top(), 60 * 0.3048, 0.05);
  // The coping of the balustrade and the roof of the drum's walkway, measured from above.
  const auto height_at = [&](double azimuth, double radius) {
    const Vector3d from(radius / full_size * std::cos(azimuth),
                        radius / full_size * std::sin(azimuth), 60.0);
    const auto hit = scene().first_hit(from, -Vector3d::UnitZ());
    return hit ? (60.0 - hit->distance) * full_size : 0.0;
  };
  const double between_piers = pi / 8;  // middle of a niche bay
  EXPECT_NEAR(height_at(between_piers, table.balustrade_radius), table.balustrade_top(), 0.03);
  EXPECT_NEAR(height_at(pi / 4, 14.85), table.balustrade_foot(), 0.06);  // cornice
  // Below the entablature, heights are measured from the side: the edge of the ground stage's
  // cornice.
  const double edge = table.ground_wall_radius + table.ground_cornice_overhang;
  EXPECT_NEAR(radius_at(pi / 8, table.ground_stage_top() - 0.03), edge, 0.03);
  EXPECT_LT(radius_at(pi / 8, table.ground_stage_top() + 0.03), edge - 0.04);
  EXPECT_LT(radius_at(pi / 8, table.column_foot() + 0.03), table.wall_radius + 0.3);
}

TEST(RadcliffeCamera, HasStageRadiiOfTable) {
  const double niche_bay = pi / 8;
  EXPECT_NEAR(radius_at(niche_bay + 0.09, 3.0), 14.0, facet);  // next to the niche
  EXPECT_NEAR(radius_at(niche_bay, 8.3), 14.3, facet);         // plinth
  EXPECT_NEAR(radius_at(niche_bay + 0.075, 17.5), 13.2, facet);
  EXPECT_NEAR(radius_at(pi / 16, 28.6), 8.5, facet);  // drum, between window and buttress
  EXPECT_NEAR(radius_at(pi / 4, 39.0), table.lantern_radius - 0.25, 0.02);  // in an opening
}

TEST(RadcliffeCamera, HasSixteenAlternatingBays) {
  EXPECT_EQ(count_beyond(14.8, 6.1), 8);  // projections
  EXPECT_EQ(count_within(14.8, 6.1), 8);  // bays between the projections
  EXPECT_EQ(count_within(13.6, 3.0), 8);  // niches in the projections
  // Below the crown of each arch is the glazing, 0.9 m behind the front, or a bar 8 cm in front of
  // it.
  for (int bay = 0; bay < 8; ++bay) {
    const double aside = 0.03, panel = table.projection_front - table.arch_depth;
    EXPECT_NEAR(radius_at(bay * pi / 4 + aside, 5.3), panel / std::cos(aside) + 0.04, 0.05);
  }
}

TEST(RadcliffeCamera, HasThirtyTwoColumnsInPairs) {
  EXPECT_EQ(count_beyond(13.6, 17.9), 32);
  EXPECT_EQ(count_beyond(13.6, 10.0), 32);
  // Three quarters of the shaft are free. Its front is at the column's axis radius plus its own
  // radius.
  double max = 0.0;
  for (int i = 0; i < 2000; ++i) max = std::max(max, radius_at(2 * pi * i / 2000, 11.0));
  EXPECT_NEAR(max, table.column_axis_radius + table.column_radius, 0.01);
}

TEST(RadcliffeCamera, HasWindowsAndNichesInTwoTiers) {
  const double foot = table.column_foot();
  // 0.25 m behind the wall, including bars.
  const auto is_open = [](double r) { return r < 12.95; };
  EXPECT_EQ(stretches(foot + table.window_sill + 0.3, is_open), 8);  // below the upper niches
  EXPECT_EQ(stretches(foot + table.upper_niche_sill + 1.0, is_open), 16);
  EXPECT_EQ(stretches(foot + table.mezzanine_sill + 0.4, is_open), 16);
}

TEST(RadcliffeCamera, HasVasesOnColumnsAndButtressesOnDrum) {
  EXPECT_EQ(count_beyond(13.3, table.balustrade_top() + 0.7), 32);  // vases
  EXPECT_EQ(count_beyond(9.3, table.balustrade_top() + 2.2), 8);    // buttresses
  EXPECT_EQ(count_within(8.3, table.balustrade_top() + 2.9), 8);    // drum windows
  const double top = table.balustrade_foot();
  EXPECT_EQ(count_beyond(14.5, top - 0.36), 96);  // modillions
  EXPECT_EQ(count_beyond(14.06, top - 0.71), 16 * table.dentils_in_a_bay);
}

TEST(RadcliffeCamera, HasRibbedDomeAndOpenLantern) {
  // At a height on the dome, the shell has the minimum radius of the ring. Ribs and rolls have
  // larger radii.
  const double z = table.dome_foot() + 3.0;
  double shell = 100.0;
  for (int i = 0; i < 3000; ++i) shell = std::min(shell, radius_at(2 * pi * i / 3000, z));
  EXPECT_EQ(count_beyond(shell + 0.1, z), 16);  // ribs have 0.2 m, rolls 0.04 m
  EXPECT_EQ(count_beyond(shell + 0.02, z), 16 * (1 + table.lead_rolls_between_ribs));
  EXPECT_EQ(count_within(table.lantern_radius - 0.15, table.lantern_foot() + 1.2), 8);
}

TEST(RadcliffeCamera, IsSymmetricExceptForEntrance) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> azimuth(-pi / 8, pi / 8), height(1.0, 42.0);
  for (int i = 0; i < 500; ++i) {
    // Opposite positions. Rays that graze an edge may differ. Window pediments are alternately
    // triangular and segmental, so every second window is compared.
    const double a = azimuth(random), z = height(random);
    const double one = radius_at(a, z), other = radius_at(a + pi, z);
    if (std::abs(one - radius_at(a + 1e-4, z)) > 1e-2) continue;
    if (std::abs(other - radius_at(a + pi + 1e-4, z)) > 1e-2) continue;
    EXPECT_NEAR(one, other, 0.01) << "azimuth " << a << ", z " << z;
  }
}

TEST(RadcliffeCamera, HasClosedPartsThatFaceOutward) {
  for (const bool is_fluted : {false, true}) {
    for (const double chord_error : {0.1, 0.02, 0.004}) {
      std::set<std::string> failures;
      for (const models::Part& part : models::radcliffe_camera(table, {{chord_error}, is_fluted})) {
        const std::string reason = models::closedness_error(part.mesh);
        if (!reason.empty()) failures.insert(part.name + ": " + reason);
      }
      EXPECT_THAT(failures, testing::IsEmpty()) << "chord error " << chord_error;
    }
  }
}

/// Returns true if the full-size point is inside the solid interior, which no ray from outside may
/// reach.
bool is_inside(const Vector3d& point) {
  const double r = point.head<2>().norm() * full_size, z = point.z() * full_size;
  if (z < 0.05) return false;
  if (z < table.balustrade_foot()) return r < 12.55;  // behind windows and niches
  if (z < table.dome_foot()) return r < 8.05;
  if (z < table.dome_foot() + 4.0) return r < 6.5;
  return r < 1.0 && z < table.cap_foot();
}

/// Returns true if the surface is visible from the back. At 50 m, single precision has a resolution
/// of 4 micrometres. A ray that touches a sharp edge may miss its front and hit its back, and so
/// may its two neighbours along the edge. A back that is really visible is visible on one side of
/// the ray as well.
bool is_seen_from_behind(const Scene& model, const Vector3d& origin, const Vector3d& direction) {
  const Vector3d right = geometry::any_orthogonal(direction), up = direction.cross(right);
  int backs = 0;
  for (int k = 0; k < 8; ++k) {
    const double angle = pi * k / 4.0;
    const Vector3d aside = std::cos(angle) * right + std::sin(angle) * up;
    const auto hit = model.first_hit(origin + 2e-5 * aside, direction);
    backs += hit && hit->normal.dot(direction) > 0.0;
  }
  return backs > 2;
}

struct RayCounts {
  long hits = 0;
  long backs = 0;    ///< hits on the back of a triangle
  long entered = 0;  ///< hits inside the building
};

/// Casts `count` rays at the building. Half start far outside. The other half start just in front
/// of those hits, in random directions: out of niches and between balusters.
RayCounts cast_rays(const Scene& model, const Eigen::AlignedBox3d& box, long count) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const auto random_direction = [&] {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Vector3d(x, y, z).normalized();
  };
  RayCounts counts;
  const auto cast = [&](const Vector3d& origin, const Vector3d& direction) {
    const auto hit = model.first_hit(origin, direction);
    if (!hit) return hit;
    const Vector3d point = origin + hit->distance * direction;
    if (point.z() <= 0.0) return hit;  // the underside, seen from below the ground
    ++counts.hits;
    counts.backs +=
        hit->normal.dot(direction) > 0.0 && is_seen_from_behind(model, origin, direction);
    counts.entered += is_inside(point);
    return hit;
  };
  for (long i = 0; i < count / 2; ++i) {
    Vector3d from = box.center() + 45.0 * random_direction();
    // Keep the start above the ground.
    if (from.z() < 0.01) from.z() = 2.0 * box.center().z() - from.z();
    Vector3d target;
    for (int axis = 0; axis < 3; ++axis) {
      target[axis] = box.min()[axis] + share(random) * box.sizes()[axis];
    }
    const Vector3d direction = (target - from).normalized();
    const auto hit = cast(from, direction);
    if (!hit) continue;
    const double near = std::max(0.0, hit->distance - 0.001 - 0.3 * share(random));
    const Vector3d start = from + near * direction;
    if (start.z() > 0.0) cast(start, random_direction());
  }
  return counts;
}

// SKYCAP_MODEL_RAYS=10000000 runs the long version.
TEST(RadcliffeCamera, BlocksRaysFromOutsideAndShowsNoBackFace) {
  const char* enabled = std::getenv("SKYCAP_MODEL_RAYS");
  const long count = enabled != nullptr ? std::atol(enabled) : 300000;
  const RayCounts counts = cast_rays(scene(), bounding_box(building()), count);
  EXPECT_GT(counts.hits, count / 4);
  EXPECT_EQ(counts.backs, 0);
  EXPECT_EQ(counts.entered, 0);
}

TEST(RadcliffeCamera, BlocksRaysAtAllLevelsOfDetailAndWithFlutes) {
  for (const auto& [detail, is_fluted] :
       {std::pair(LevelOfDetail::coarse, false), std::pair(LevelOfDetail::fine, false),
        std::pair(LevelOfDetail::standard, true)}) {
    ModelOptions options;
    options.detail = detail;
    options.has_fluted_columns = is_fluted;
    const geometry::Mesh mesh = builtin_model("radcliffe-camera", options);
    const RayCounts counts = cast_rays(Scene(mesh), bounding_box(mesh), 60000);
    EXPECT_EQ(counts.backs, 0) << mesh.triangles.size() << " triangles";
    EXPECT_EQ(counts.entered, 0) << mesh.triangles.size() << " triangles";
  }
}

TEST(RadcliffeCamera, KeepsShapeAtAllLevelsOfDetail) {
  const auto at = [](LevelOfDetail detail) {
    ModelOptions options;
    options.detail = detail;
    return builtin_model("radcliffe-camera", options);
  };
  const geometry::Mesh coarse = at(LevelOfDetail::coarse), fine = at(LevelOfDetail::fine);
  EXPECT_THAT(coarse.triangles.size(), testing::AllOf(testing::Ge(40000U), testing::Le(70000U)));
  EXPECT_THAT(building().triangles.size(),
              testing::AllOf(testing::Ge(400000U), testing::Le(600000U)));
  EXPECT_THAT(fine.triangles.size(), testing::AllOf(testing::Ge(2500000U), testing::Le(3500000U)));
  EXPECT_NEAR(bounding_box(coarse).max().z(), 40.0, 1e-9);
  EXPECT_NEAR(bounding_box(fine).max().z(), 40.0, 1e-9);

  // Points of the coarse surface are on the standard surface, up to both chord errors and omitted
  // details. From 2 m outside, the first surfaces have nearly the same distance.
  const Scene coarse_scene(coarse);
  std::vector<double> differences;
  for (int i = 0; i < 2000; ++i) {
    const double azimuth = 0.37 * i, z = 0.5 + 38.5 * i / 2000.0;
    const Vector3d out(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Vector3d from = 30.0 * out + Vector3d(0.0, 0.0, z);
    const auto one = coarse_scene.first_hit(from, -out), other = scene().first_hit(from, -out);
    ASSERT_EQ(one.has_value(), other.has_value());
    if (one) differences.push_back(std::abs(one->distance - other->distance));
  }
  std::sort(differences.begin(), differences.end());
  EXPECT_LT(differences[differences.size() / 2], 0.04);
  EXPECT_LT(differences[differences.size() * 9 / 10], 0.16);
}

TEST(RadcliffeCamera, IsDeterministic) {
  const geometry::Mesh again = builtin_model("radcliffe-camera");
  EXPECT_EQ(again.vertices, building().vertices);
  EXPECT_EQ(again.triangles, building().triangles);
}

TEST(RadcliffeCamera, FollowsTable) {
  models::RadcliffeTable wider = table;
  wider.longest_side = table.total_height;  // full size
  wider.projection_front = 16.0;
  const geometry::Mesh mesh = join(models::radcliffe_camera(wider, {{0.02}, false}));
  const auto hit = Scene(mesh).first_hit({30.0, 2.4, 3.0}, {-1.0, 0.0, 0.0});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(30.0 - hit->distance, 16.0, 1e-3);
}

}  // namespace
}  // namespace skycap::sim
