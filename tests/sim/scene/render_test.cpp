#include "sim/scene/render.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/models/masonry/solids.h"

namespace skycap::sim {
namespace {

using std::numbers::pi;

geometry::Mesh unit_ball() {
  const models::Fineness fine{5e-4};
  return models::revolve(models::Profile(fine, 0, -1).arc_to(0, 1, pi).points(), fine.circle(1));
}

RenderOptions small_image() {
  RenderOptions options;
  options.width = 120;
  options.height = 100;
  options.samples_per_side = 4;
  options.sky_rays = 1;
  options.has_floor = false;
  return options;
}

/// Temporary file that is removed with the object.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name)
      : path_(std::filesystem::path(testing::TempDir()) / name) {}
  ~TemporaryFile() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Returns the pixels that differ from the sky, with one sample for each.
std::vector<bool> covered(const geometry::Mesh& mesh, const RenderView& view,
                          RenderOptions options) {
  options.samples_per_side = 1;
  // A distant, tiny triangle behind the viewer, because a scene must not be empty.
  const Eigen::Vector3d behind = view.view.position - 100.0 * view.view.direction;
  const geometry::Mesh speck{
      {behind, behind + Eigen::Vector3d(1e-3, 0, 0), behind + Eigen::Vector3d(0, 1e-3, 1e-3)},
      {{0, 1, 2}}};
  const Image with = render(mesh, {&view, 1}, options),
              without = render(speck, {&view, 1}, options);
  std::vector<bool> result;
  for (std::size_t i = 0; i < with.pixels.size(); ++i) {
    result.push_back(with.pixels[i] != without.pixels[i]);
  }
  return result;
}

// From distance d, a unit ball fills a cone with tan = 1 / sqrt(d^2 - 1). Around the optical axis
// its outline is a circle with this radius in focal lengths.
TEST(Render, HasAnalyticAreaOfSphere) {
  const RenderOptions options = small_image();
  const double fov = 0.6, distance = 5.0;
  const RenderView view{geometry::look_at({0, -distance, 0}, {0, 0, 0}), fov};
  const std::vector<bool> pixels = covered(unit_ball(), view, options);
  const double focal = 0.5 * options.width / std::tan(0.5 * fov);
  const double radius = focal / std::sqrt(distance * distance - 1.0);
  // The sample of each pixel is distributed uniformly over it, so the count is unbiased. Its
  // variance is that of about 4/pi pixels for each unit of the outline, 1/6 each. The tolerance is
  // five sigma.
  const double sigma = std::sqrt(4 / pi * 2 * pi * radius / 6);
  const auto count = static_cast<double>(std::count(pixels.begin(), pixels.end(), true));
  EXPECT_NEAR(count, pi * radius * radius, 5 * sigma);
}

TEST(Render, IsBrighterTowardsTheSun) {
  RenderOptions options = small_image();
  options.sun_to_the_left = pi / 2;
  const RenderView view{geometry::look_at({0, -5, 0}, {0, 0, 0}), 0.6};
  const Image image = render(unit_ball(), {&view, 1}, options);
  EXPECT_GT(image.at(45, 45)[0], image.at(75, 45)[0] + 30);
}

TEST(Render, DoesNotDependOnThreadCount) {
  RenderOptions options = small_image();
  options.samples_per_side = 1;
  options.threads = 1;
  const Image one = render(unit_ball(), options);
  options.threads = 4;
  EXPECT_EQ(render(unit_ball(), options).pixels, one.pixels);
}

TEST(Render, ArrangesViewsInRows) {
  RenderOptions options = small_image();
  options.samples_per_side = 1;
  const Image image = render(unit_ball(), options);
  ASSERT_EQ(standard_views(unit_ball()).size(), 4U);
  EXPECT_EQ(image.width, 240);
  EXPECT_EQ(image.height, 200);
  options.columns = 3;
  EXPECT_EQ(render(unit_ball(), options).width, 360);
}

TEST(Render, ShowsWholeSceneInStandardViews) {
  for (const double aspect : {0.5, 1.0, 2.0}) {
    RenderOptions options = small_image();
    options.width = static_cast<int>(100 * aspect);
    const std::vector<RenderView> views = standard_views(unit_ball(), aspect);
    for (int i = 0; i < 3; ++i) {  // the fourth is a detail view
      const std::vector<bool> pixels = covered(unit_ball(), views[i], options);
      int inner = 0, edge = 0;
      for (int row = 0; row < options.height; ++row) {
        for (int column = 0; column < options.width; ++column) {
          const bool is_edge =
              row == 0 || column == 0 || row == options.height - 1 || column == options.width - 1;
          (is_edge ? edge : inner) += pixels[row * options.width + column];
        }
      }
      EXPECT_EQ(edge, 0);
      // The ball has nearly the maximum size: more than half of the largest circle.
      const double max = 0.5 * std::min(options.width, options.height);
      EXPECT_GT(inner, 0.5 * pi * max * max);
    }
  }
}

TEST(Render, ReportsTheInvalidOption) {
  RenderOptions options;
  options.width = 0;
  EXPECT_THAT([&] { options.validate(); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("width is 0")));
  options = {};
  options.sun_elevation = 2.0;
  EXPECT_THAT([&] { options.validate(); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("sun_elevation")));
}

TEST(Png, RoundTripsImage) {
  Image image{37, 11, {}};
  for (int i = 0; i < 37 * 11; ++i) {
    image.pixels.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(7 * i),
                            static_cast<std::uint8_t>(255 - i)});
  }
  const TemporaryFile file("skycap_png_test.png");
  write_png(image, file.path());
  const Image back = read_png(file.path());
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 11);
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST(Png, ReportsFileThatCannotBeWrittenOrRead) {
  const Image image{1, 1, {Rgb{1, 2, 3}}};
  EXPECT_THAT([&] { write_png(image, "/dev/null/picture.png"); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("/dev/null/picture.png")));
  const TemporaryFile file("skycap_not_a_png.png");
  std::ofstream(file.path()) << "not a picture";
  EXPECT_THAT([&] { read_png(file.path()); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("skycap_not_a_png.png")));
}

}  // namespace
}  // namespace skycap::sim
