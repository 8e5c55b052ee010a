#include "missions/support/reconstruction.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/support/external_program.h"
#include "tests/missions/run_skycap.h"
#include "tests/sim/shapes.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Returns points of a sphere of 2 m, about 0.07 m apart, without points below `min_z`.
geometry::AttributedCloud ball_cloud(float min_z = -10.0F) {
  const geometry::SurfaceSamples samples =
      geometry::sample_surface(sim::sphere({1, 2, 3}, 2.0, 5), 8000, 4);
  geometry::AttributedCloud cloud;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    if (samples.points[i].z() < min_z) continue;
    cloud.positions.push_back(samples.points[i]);
    cloud.normals.push_back(samples.normals[i]);
  }
  return cloud;
}

double largest_error(const geometry::Mesh& mesh) {
  double largest = 0.0;
  for (const Vector3d& vertex : mesh.vertices) {
    largest = std::max(largest, std::abs((vertex - Vector3d(1, 2, 3)).norm() - 2.0));
  }
  return largest;
}

// A sphere has the area 4 pi r^2, and its triangles face away from its centre.
TEST(Reconstruct, ReturnsClosedOutwardSphere) {
  const geometry::AttributedCloud cloud = ball_cloud();
  const support::Reconstruction result = support::reconstruct(cloud.positions, cloud.normals, {});
  EXPECT_EQ(result.points, cloud.positions.size());
  EXPECT_EQ(result.trimmed_triangles, 0U);
  EXPECT_LT(largest_error(result.mesh), 0.02);  // a third of the point spacing
  EXPECT_NEAR(geometry::surface_area(result.mesh), 16.0 * std::numbers::pi, 0.5);
  for (const auto& [a, b, c] : result.mesh.triangles) {
    const auto& v = result.mesh.vertices;
    const Vector3d normal = (v[b] - v[a]).cross(v[c] - v[a]);
    if (normal.norm() < 1e-9) continue;
    EXPECT_GT(normal.dot(v[a] - Vector3d(1, 2, 3)), 0.0);
  }
}

TEST(Reconstruct, EstimatesMissingNormals) {
  const support::Reconstruction result = support::reconstruct(ball_cloud().positions, {}, {});
  EXPECT_LT(largest_error(result.mesh), 0.02);
  EXPECT_NEAR(geometry::surface_area(result.mesh), 16.0 * std::numbers::pi, 0.5);
}

// The sphere above z = 2, 3 m of its 4 m height, has the area 2 pi r h. Poisson reconstruction
// closes the hole below. Triangles without points nearby are removed.
TEST(Reconstruct, KeepsHoles) {
  const geometry::AttributedCloud cloud = ball_cloud(2.0F);
  const support::Reconstruction trimmed = support::reconstruct(cloud.positions, cloud.normals, {});
  EXPECT_GT(trimmed.trimmed_triangles, 100U);
  EXPECT_NEAR(geometry::surface_area(trimmed.mesh), 12.0 * std::numbers::pi, 1.5);
  for (const Vector3d& vertex : trimmed.mesh.vertices) EXPECT_GT(vertex.z(), 1.8);

  const support::Reconstruction closed =
      support::reconstruct(cloud.positions, cloud.normals, {.min_density = 0.0});
  EXPECT_EQ(closed.trimmed_triangles, 0U);
  EXPECT_GT(geometry::surface_area(closed.mesh), geometry::surface_area(trimmed.mesh) + 1.0);
}

TEST(Reconstruct, DownsamplesCloudToSpacing) {
  const geometry::AttributedCloud cloud = ball_cloud();
  const support::Reconstruction result =
      support::reconstruct(cloud.positions, cloud.normals, {.spacing = 0.3});
  EXPECT_LT(result.points, cloud.positions.size() / 5);
  EXPECT_LT(largest_error(result.mesh), 0.1);
}

TEST(Reconstruct, RejectsUnusableInput) {
  const std::vector<Vector3f> few(99, Vector3f::Zero());
  EXPECT_THAT(testing_support::thrown_message([&] { support::reconstruct(few, {}, {}); }),
              testing::HasSubstr("too few points: 99"));
  EXPECT_THAT(
      testing_support::thrown_message([&] { support::reconstruct(few, {}, {.depth = 13}); }),
      testing::HasSubstr("reconstruction.depth is 13"));
  EXPECT_THAT(
      testing_support::thrown_message([&] { support::reconstruct(few, {}, {.spacing = -1.0}); }),
      testing::HasSubstr("reconstruction.spacing is -1.0"));
  EXPECT_THAT(
      testing_support::thrown_message([&] { support::reconstruct(few, {}, {.min_density = 1.0}); }),
      testing::HasSubstr("reconstruction.min_density is 1.0"));
}

class ReconstructCommand : public testing::Test {
 protected:
  const tests::TestFolder folder;
};

TEST_F(ReconstructCommand, WritesMeshAcceptedByEvaluate) {
  geometry::write_cloud(folder / "ball.ply", make_columns(ball_cloud()));
  geometry::write_mesh(folder / "truth.ply", sim::sphere({1, 2, 3}, 2.0, 5));
  const tests::ProgramRun run = tests::run_skycap({"reconstruct", folder / "ball.ply"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, testing::HasSubstr("ball_mesh.ply"));
  const tests::ProgramRun evaluated =
      tests::run_skycap({"evaluate", "--mesh", folder / "ball_mesh.ply", "--model",
                         folder / "truth.ply", "--distance", "0.02", "--samples", "2000"});
  EXPECT_EQ(evaluated.exit_code, 0) << evaluated.err;
  EXPECT_THAT(evaluated.out, testing::HasSubstr("coverage  100.00%"));
}

TEST_F(ReconstructCommand, NamesCloudWithTooFewPoints) {
  const std::string cloud = folder.write("few.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  const tests::ProgramRun run = tests::run_skycap({"reconstruct", cloud});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, testing::HasSubstr("few.xyz: too few points: 3; a surface requires"));
  EXPECT_FALSE(std::filesystem::exists(folder / "few_mesh.ply"));
}

/// The program in a separate folder, independent of its build folder.
class MovedProgram : public testing::Test {
 protected:
  MovedProgram() {
    std::filesystem::copy_file(built_, folder_ / "skycap");
    geometry::write_cloud(folder_ / "ball.ply", geometry::make_columns(ball_cloud()));
  }
  void add_module() {
    const char* module = "libskycap_reconstruction.so";
    std::filesystem::copy_file(built_.parent_path() / module, folder_ / module);
  }
  support::ProgramResult reconstruct() const {
    return support::run_external_program({folder_ / "skycap", "reconstruct", "ball.ply"},
                                         folder_.path());
  }

  const std::filesystem::path built_ = SKYCAP_PROGRAM;
  const tests::TestFolder folder_;
};

TEST_F(MovedProgram, LoadsModuleFromSameFolder) {
  add_module();
  const support::ProgramResult result = reconstruct();
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_LT(largest_error(geometry::read_mesh(folder_ / "ball_mesh.ply")), 0.02);
}

TEST_F(MovedProgram, NamesMissingModule) {
  const support::ProgramResult result = reconstruct();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, testing::HasSubstr((folder_ / "libskycap_reconstruction.so") +
                                                ": cannot load this program module"));
}

}  // namespace
}  // namespace skycap::missions
