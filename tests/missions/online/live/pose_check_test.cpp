#include "missions/online/live/pose_check.h"

#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/points/spaced_points.h"
#include "sim/models/masonry/solids.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "tests/missions/room_scene.h"
#include "tests/support/not_empty.h"

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double radius = 0.1;

/// Returns a room of 6 m with a cupboard and a pillar.
geometry::Mesh furnished() {
  geometry::Mesh mesh = tests::room_mesh({.width = 6.0, .height = 3.0, .wall = 0.2});
  geometry::append(mesh, sim::models::box({-3.0, 1.5, 0.0}, {-1.2, 3.0, 2.0}));
  geometry::append(mesh, sim::models::box({1.0, 1.0, 0.0}, {1.5, 1.4, 3.0}));
  return mesh;
}

sim::DepthCamera make_camera(double noise, std::uint64_t seed) {
  sim::DepthCameraConfig config;
  config.camera = {.width = 160, .height = 120, .horizontal_fov = 1.05, .vertical_fov = 0.82};
  config.camera.max_range = 20.0;
  config.noise = {.sigma = noise, .direction = sim::NoiseDirection::along_ray, .seed = seed};
  return sim::DepthCamera(config);
}

geometry::Scan moved(const geometry::Scan& scan, const Isometry3d& error) {
  return corrected(scan, error);
}

/// Returns a random pose error of `shift` [m] and 1 degree at the sensor.
Isometry3d error_at(const Vector3d& sensor, std::uint64_t seed, double shift = 0.1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> number;
  const auto any = [&] { return Vector3d{number(random), number(random), number(random)}; };
  Isometry3d error = Isometry3d::Identity();
  error.linear() =
      Eigen::AngleAxisd(geometry::radians_per_degree, any().normalized()).toRotationMatrix();
  error.translation() = sensor + shift * any().normalized() - error.linear() * sensor;
  return error;
}

/// Survey of the room from its centre.
class Survey {
 public:
  Survey(const sim::Scene& scene, double noise, std::uint64_t seed, bool registers = false)
      : scene_(scene), camera_(make_camera(noise, seed)), check_(radius, registers) {}

  geometry::Scan scan(const Vector3d& from, const Vector3d& to) {
    return camera_.scan(scene_, geometry::look_at(from, to), frame_++, 1);
  }
  void remember(const geometry::Scan& scan) {
    std::vector<Eigen::Vector3f> room;
    for (const Eigen::Vector3f& point : scan.points) {
      if (kept_.keep(point)) room.push_back(point);
    }
    check_.remember(scan, room);
  }
  PoseFinding find(const geometry::Scan& scan, const PoseCovariance& covariance = {}) {
    return check_.find(scan, covariance);
  }

 private:
  const sim::Scene& scene_;
  sim::DepthCamera camera_;
  PoseCheck check_;
  geometry::SpacedPoints kept_{0.03};
  std::uint64_t frame_ = 0;
};

const std::vector<Vector3d> stops{{0.0, 0.0, 1.5},  {-0.5, -0.5, 1.2}, {0.5, -1.0, 1.6},
                                  {-1.0, 0.2, 1.4}, {0.3, 0.4, 1.1},   {-0.2, -1.5, 1.8}};
const Vector3d cupboard(-1.5, 2.5, 1.0);

class PoseChecks : public testing::Test {
 protected:
  sim::Scene scene_{furnished(), 1};
};

TEST_F(PoseChecks, AcceptTruePoses) {
  for (const double noise : {0.0, 0.005, 0.02, 0.05}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      Survey survey(scene_, noise, seed);
      for (const Vector3d& stop : testing_support::not_empty(stops)) {
        const geometry::Scan scan = survey.scan(stop, cupboard);
        const PoseFinding finding = survey.find(scan);
        EXPECT_FALSE(finding.is_wrong)
            << "noise " << noise << ", seed " << seed << ": " << finding.shift;
        survey.remember(scan);
      }
    }
  }
}

/// All errors that the common surface of both scans can show. Unobservable shifts are not detected.
TEST_F(PoseChecks, DetectTenCentimetresAndOneDegree) {
  int missed = 0;
  for (const double noise : {0.0, 0.01, 0.02}) {
    Survey survey(scene_, noise, 1);
    survey.remember(survey.scan(stops[0], cupboard));
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Vector3d& stop = stops[1 + seed % 5];
      const geometry::Scan scan = survey.scan(stop, cupboard);
      const PoseFinding finding = survey.find(moved(scan, error_at(stop, seed)));
      EXPECT_TRUE(finding.is_checked);
      EXPECT_TRUE(finding.is_wrong || finding.unobservable > 0)
          << "noise " << noise << ", seed " << seed;
      missed += finding.is_wrong ? 0 : 1;
      EXPECT_FALSE(finding.correction);
      if (finding.unobservable > 0 || noise > 0.01) continue;
      EXPECT_NEAR(finding.shift, 0.1, 0.01);
      EXPECT_NEAR(finding.turn / geometry::radians_per_degree, 1.0, 0.1);
    }
  }
  EXPECT_LE(missed, 1) << "of 60";
}

TEST_F(PoseChecks, CorrectErrorsWithinSigma) {
  Survey survey(scene_, 0.005, 1, true);
  survey.remember(survey.scan(stops[0], cupboard));
  int whole = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Vector3d& stop = stops[1 + seed % 5];
    const geometry::Scan given = moved(survey.scan(stop, cupboard), error_at(stop, seed));
    EXPECT_TRUE(survey.find(given).is_wrong) << seed;
    const PoseFinding finding = survey.find(given, PoseCovariance::of(0.05, 0.01));
    EXPECT_FALSE(finding.is_wrong);
    ASSERT_TRUE(finding.correction);
    if (finding.unobservable > 0) continue;
    ++whole;
    const Isometry3d rest = *finding.correction * error_at(stop, seed);
    EXPECT_LT((rest * stop - stop).norm(), 0.01) << seed;
    EXPECT_LT(Eigen::AngleAxisd(rest.linear()).angle() / geometry::radians_per_degree, 0.1) << seed;
  }
  EXPECT_GE(whole, 8);
}

/// After such a jump the scans share no surface, but rays pass through known surface.
TEST_F(PoseChecks, DetectJumpsBeyondSurfaceExtent) {
  Survey survey(scene_, 0.01, 1);
  for (const Vector3d& stop : stops) survey.remember(survey.scan(stop, cupboard));
  for (const Vector3d& jump : {Vector3d(-1, 1, 0), Vector3d(1, -1, 0), Vector3d(0, 0, 2)}) {
    Isometry3d error = Isometry3d::Identity();
    error.translation() = 0.8 * jump;
    const PoseFinding finding = survey.find(moved(survey.scan(stops[0], cupboard), error));
    EXPECT_TRUE(finding.is_wrong) << jump.transpose() << ": " << finding.seen_through;
  }
}

/// A wall does not constrain motion along it.
TEST_F(PoseChecks, ReportUnobservableDirectionsOfWall) {
  Survey survey(scene_, 0.01, 1, true);
  const Vector3d stop(0.5, 0.0, 1.5), wall(0.5, -3.0, 1.5);
  survey.remember(survey.scan(Vector3d(0.6, -1.2, 1.5), wall));
  const PoseFinding finding = survey.find(survey.scan(Vector3d(0.5, -1.0, 1.5), wall));
  EXPECT_TRUE(finding.is_checked);
  EXPECT_FALSE(finding.is_wrong);
  EXPECT_EQ(finding.unobservable, 3);
}

TEST_F(PoseChecks, SkipScansWithoutOverlap) {
  Survey survey(scene_, 0.01, 1);
  EXPECT_FALSE(survey.find(survey.scan(stops[0], cupboard)).is_checked);
  survey.remember(survey.scan(stops[0], cupboard));
  const PoseFinding finding = survey.find(survey.scan(stops[0], Vector3d(1.0, -3.0, 1.5)));
  EXPECT_FALSE(finding.is_checked);
  EXPECT_FALSE(finding.is_wrong);
}

/// For any view direction, the errors are along the axes of the mission.
TEST_F(PoseChecks, AllowErrorsAlongCovarianceAxes) {
  for (int axis = 0; axis < 3; ++axis) {
    Survey survey(scene_, 0.005, 1, true);
    survey.remember(survey.scan(stops[0], cupboard));
    Isometry3d jump = Isometry3d::Identity();
    jump.translation() = 0.1 * Vector3d::Unit(axis);
    const geometry::Scan given = moved(survey.scan(stops[1], cupboard), jump);
    for (int known = 0; known < 3; ++known) {
      PoseCovariance covariance;
      covariance.matrix(known, known) = 0.05 * 0.05;
      const PoseFinding finding = survey.find(given, covariance);
      EXPECT_EQ(finding.is_wrong, known != axis) << axis << ", " << known;
      ASSERT_EQ(finding.correction.has_value(), known == axis) << axis << ", " << known;
      if (!finding.correction) continue;
      EXPECT_LT((*finding.correction * jump * stops[1] - stops[1]).norm(), 0.01);
    }
  }
}

/// A mast that tilts at its base: position and direction errors are fully correlated.
TEST_F(PoseChecks, RespectCorrelatedErrors) {
  Survey survey(scene_, 0.005, 1);
  survey.remember(survey.scan(stops[0], cupboard));
  const Vector3d sensor = stops[1], foot = sensor - Vector3d(2.0, 1.0, 0.0);
  const double turn = 2.0 * geometry::radians_per_degree;
  const Eigen::AngleAxisd about_z(turn, Vector3d::UnitZ());
  Isometry3d error = Isometry3d::Identity();
  error.linear() = about_z.toRotationMatrix();
  error.translation() = foot - about_z * foot;
  const geometry::Scan given = moved(survey.scan(sensor, cupboard), error);
  for (const double sign : {1.0, -1.0}) {
    PoseCovariance::Vector together;
    together << sign * Vector3d::UnitZ().cross(sensor - foot), Vector3d::UnitZ();
    together *= turn;
    const PoseFinding finding = survey.find(given, {together * together.transpose()});
    EXPECT_EQ(finding.is_wrong, sign < 0.0) << finding.shift << " " << finding.turn;
  }
}

TEST_F(PoseChecks, AreDeterministic) {
  const auto find = [&] {
    Survey survey(scene_, 0.01, 1, true);
    for (const Vector3d& stop : stops) survey.remember(survey.scan(stop, cupboard));
    return survey.find(survey.scan(stops[2], cupboard), PoseCovariance::of(0.05, 0.01));
  };
  EXPECT_TRUE(find().correction->matrix() == find().correction->matrix());
}

}  // namespace
}  // namespace skycap::missions::online
