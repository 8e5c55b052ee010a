#include "survey/photo/view_graph.h"

#include <cmath>

#include <Eigen/SVD>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/random_numbers.h"
#include "tests/survey/photo/test_scenes.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;
using geometry::View;
using testing::ElementsAre;

/// Returns photos that face a long wall from 8 m, at these positions along it.
class PhotosOfAWall : public testing::Test {
 protected:
  PhotosOfAWall() : target_(wall(60.0, 2.0, 4.0)), sights_(target_, 1) {
    SampleOptions options;
    options.count = 3000;
    options.free_length = 12.0;
    samples_ = sample_target(target_, sights_, options);
    rule_.view_distance = 8.0;
  }

  static std::vector<View> photos_at(const std::vector<double>& positions) {
    std::vector<View> photos;
    for (const double x : positions) photos.push_back({{x, -8.0, 4.0}, {0.0, 1.0, 0.0}});
    return photos;
  }
  IndexLists observed(const std::vector<View>& photos) const {
    return observed_samples(Observer(camera_, rule_, sights_, samples_), photos, 1);
  }

  geometry::PhotoCamera camera_{test_camera()};
  geometry::Mesh target_;
  geometry::SightLines sights_;
  TargetSamples samples_;
  StereoRule rule_;
};

TEST_F(PhotosOfAWall, ConnectWhereTheyShareEnough) {
  // The footprint is 11.3 m wide, or 10.9 m without its border. Photos 4 m apart share 63%, photos
  // 8 m apart 27%.
  const std::vector<View> photos = photos_at({10, 14, 18, 40, 44, 55});
  const ViewGraph graph = view_graph(photos, observed(photos), samples_, {}, 2);
  EXPECT_THAT(graph.part, ElementsAre(0, 0, 0, 1, 1, 2));
  EXPECT_THAT(graph.parts, ElementsAre(3, 2, 1));
  EXPECT_THAT(graph.degree, ElementsAre(1, 2, 1, 1, 1, 0));
  EXPECT_FALSE(graph.is_connected(0));
}

TEST_F(PhotosOfAWall, DoNotConnectAtTooMuchTilt) {
  const std::vector<View> photos = photos_at({10, 14});
  const auto edges = [&](const EdgeRule& rule) {
    return view_graph(photos, observed(photos), samples_, rule, 1).edges.size();
  };
  EXPECT_EQ(edges({.min_matchable = 0.5, .max_tilt = 1.5}), 1U);
  EXPECT_EQ(edges({.min_matchable = 0.5, .max_tilt = 1.05}), 0U);
}

TEST_F(PhotosOfAWall, DoNotConnectAtGrazingIncidence) {
  const auto towards = [](double incidence) {
    const Vector3d ray(std::sin(incidence), -std::cos(incidence), 0.0);
    return View{Vector3d(30.0, 0.0, 4.0) + 8.0 * ray, -ray};
  };
  constexpr double degrees = geometry::radians_per_degree;
  const auto edges = [&](double first, double second) {
    const std::vector<View> photos{towards(first * degrees), towards(second * degrees)};
    return view_graph(photos, observed(photos), samples_, {}, 1).edges.size();
  };
  EXPECT_EQ(edges(0.0, 30.0), 1U);
  EXPECT_EQ(edges(40.0, 70.0), 0U);  // The same parallax, but a transition tilt of 2.2.
}

TEST(TransitionTilt, AgreesWithSingularValues) {
  geometry::RandomNumbers random(3, 1);
  const auto observation = [&] {
    Vector3d ray;
    for (double& part : ray) part = random.uniform() - 0.5;
    ray.z() += 0.7;
    ray.normalize();
    return Observation{ray.cast<float>(), 1.0F, static_cast<float>(ray.z()), 0};
  };
  // Returns the orthographic map from the plane z = 0 to an image.
  const auto map = [](const Observation& o) {
    const Vector3d ray = o.ray.cast<double>();
    const Vector3d right = ray.unitOrthogonal(), up = ray.cross(right);
    Eigen::Matrix2d result;
    result << right.head<2>().transpose(), up.head<2>().transpose();
    return result;
  };
  for (int i = 0; i < 100; ++i) {
    const Observation a = observation(), b = observation();
    const Eigen::Matrix2d between = map(b) * map(a).inverse();
    const Eigen::Vector2d values = between.jacobiSvd().singularValues();
    EXPECT_NEAR(transition_tilt(a, b), values[0] / values[1], 1e-4 * values[0] / values[1]);
    EXPECT_NEAR(transition_tilt(a, b), transition_tilt(b, a), 1e-4);
  }
  const Observation front{{0.0F, 0.0F, 1.0F}, 1.0F, 1.0F, 0};
  EXPECT_NEAR(transition_tilt(front, front), 1.0, 1e-9);
  const float half = 0.5F, root = std::sqrt(0.75F);
  EXPECT_NEAR(transition_tilt(front, {{root, 0.0F, half}, 1.0F, half, 0}), 2.0, 1e-5);
}

TEST_F(PhotosOfAWall, AreConnectedByPhotosBetweenThem) {
  const std::vector<View> photos = photos_at({10, 14, 18, 30, 34, 38});
  std::vector<double> positions;
  for (double x = 5.5; x < 55.0; x += 1.0) positions.push_back(x);
  const std::vector<View> candidates = photos_at(positions);
  const std::vector<std::uint32_t> added = connecting_photos(
      photos, observed(photos), candidates, observed(candidates), samples_, {}, 3, 0.4, 100, 2);
  std::vector<View> all = photos;
  for (const std::uint32_t c : added) all.push_back(candidates[c]);
  const ViewGraph graph = view_graph(all, observed(all), samples_, {}, 1);
  EXPECT_TRUE(graph.is_connected(3));
  EXPECT_FALSE(view_graph(photos, observed(photos), samples_, {}, 1).is_connected(0));
  EXPECT_LE(added.size(), 12U);
}

TEST_F(PhotosOfAWall, RegisterWithTwoEdgesToRegisteredPhotos) {
  // Photos 2 m apart share 82%, photos 4 m apart 63%, photos 6 m apart 45%. Only 18 and 22 connect
  // both groups.
  const EdgeRule half{.min_matchable = 0.5};
  const std::vector<View> photos = photos_at({12, 14, 16, 18, 22, 24, 26, 28});
  const ViewGraph graph = view_graph(photos, observed(photos), samples_, half, 1);
  EXPECT_EQ(graph.parts.size(), 1U);
  EXPECT_EQ(graph.registered, 4U);
  const std::vector<View> chain = photos_at({10, 14, 18, 22});
  EXPECT_EQ(view_graph(chain, observed(chain), samples_, half, 1).registered, 2U);
  const std::vector<View> single = photos_at({10});
  EXPECT_EQ(view_graph(single, observed(single), samples_, half, 1).registered, 0U);

  std::vector<double> positions;
  for (double x = 5.5; x < 55.0; x += 1.0) positions.push_back(x);
  const std::vector<View> candidates = photos_at(positions);
  const std::vector<std::uint32_t> added = connecting_photos(
      photos, observed(photos), candidates, observed(candidates), samples_, half, 1, 0.4, 100, 2);
  std::vector<View> all = photos;
  for (const std::uint32_t c : added) all.push_back(candidates[c]);
  EXPECT_EQ(view_graph(all, observed(all), samples_, half, 1).registered, all.size());
  EXPECT_LE(added.size(), 2U);
}

}  // namespace
}  // namespace skycap::survey::photo
