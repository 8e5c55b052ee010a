// Legs near prior data, from files to verified legs. The obstacles differ from the ground truth by
// at most their uncertainty. Each verified leg must then keep its clearance from the ground truth.
// The independent check knows the ground truth and shares no code with the verification.
//
// PRIOR_LEGS in the environment is the number of legs; 100000 is the full test.

#include <cstdlib>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "flight/clearance/clearance.h"
#include "geometry/error.h"
#include "missions/site_data/site_priors.h"
#include "tests/flight/scenes.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using flight::Segment;
using testing_support::Cube;

/// Convex obstacles: blocks, points (blocks without extent) and the columns of a height model.
using Truth = std::vector<AlignedBox3d>;

/// Returns the distance between a leg and a block, up to rounding. The distance is convex along the
/// leg, so a golden-section search of point-to-box distances finds the minimum.
double distance(const Segment& leg, const AlignedBox3d& box) {
  const auto at = [&](double t) {
    const Vector3d p = leg.from + t * (leg.to - leg.from);
    const Vector3d off = (box.min() - p).cwiseMax(p - box.max()).cwiseMax(Vector3d::Zero());
    return off.norm();
  };
  double low = 0.0, high = 1.0;
  while (high - low > 1e-10) {
    const double a = low + 0.382 * (high - low), b = low + 0.618 * (high - low);
    (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
  }
  return std::min({at(low), at(high), at(0.0), at(1.0)});
}

/// A random site: files in the mission frame, and the ground truth from which they deviate.
class RandomSite {
 public:
  RandomSite(std::mt19937_64& random, const testing_support::TemporaryFolder& folder, int number)
      : random_(random), name_(folder.path() / std::to_string(number)) {
    write_blocks();
    write_scan();
    write_height_model();
  }
  const std::vector<Source>& sources() const { return sources_; }
  const Truth& truth() const { return truth_; }

 private:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  /// Returns a random length in whole millimetres, as in files.
  double length(double low, double high) { return std::round(1e3 * between(low, high)) / 1e3; }
  Vector3d pose(const AlignedBox3d& box) {
    return (flight::scenes::point_in(random_, box) * 1e3).array().round() / 1e3;
  }

  /// Returns a random error with the magnitude of the source's uncertainty.
  Vector3d error(double uncertainty) {
    return uncertainty *
           flight::scenes::point_in(random_, {Vector3d(-1, -1, -1), Vector3d(1, 1, 1)})
               .normalized();
  }

  Source& add_source(const std::string& extension, const std::string& bytes) {
    Source& source = sources_.emplace_back();
    source.file = name_.string() + extension;
    std::ofstream(source.file, std::ios::binary) << bytes;
    source.pose = SourcePose{};
    source.uncertainty = between(0.0, 1.5);
    return source;
  }

  void write_blocks() {
    for (int i = 0; i < 4; ++i) {
      Cube block{.low = pose({Vector3d(-30, -30, 0), Vector3d(20, 20, 10)}),
                 .size = {length(1, 9), length(1, 9), length(1, 9)}};
      const Source& source = i % 2 == 0
                                 ? add_source(std::to_string(i) + ".obj", make_obj(block))
                                 : add_source(std::to_string(i) + ".gml", make_citygml(block));
      const Vector3d off = error(*source.uncertainty);
      truth_.emplace_back(block.low + off, block.low + block.size + off);
    }
  }

  /// Writes points of a surface. The file contains one point for each cube, which represents the
  /// others.
  void write_scan() {
    Cube corners{.low = pose({Vector3d(-30, -30, 5), Vector3d(20, 20, 25)}),
                 .size = {length(0.05, 1), length(0.05, 1), length(0.05, 1)}};
    Source& source = add_source(".las", make_las(corners, 4, 6, local_wkt));
    source.spacing = between(0.1, 1.0);
    const Vector3d off = error(*source.uncertainty);
    for (int i = 0; i < 8; ++i)
      truth_.emplace_back(corners.corner(i) + off, corners.corner(i) + off);
  }

  /// Writes cells of 2 m. The columns below them extend downwards without limit.
  void write_height_model() {
    const Vector3d corner = pose({Vector3d(-30, -30, 0), Vector3d(0, 0, 0)});
    std::string text = "ncols 6\nnrows 5\nxllcorner " + std::to_string(corner.x()) +
                       "\nyllcorner " + std::to_string(corner.y()) +
                       "\ncellsize 2\nNODATA_value -9999\n";
    Truth cells;
    for (int row = 4; row >= 0; --row) {
      for (int column = 0; column < 6; ++column) {
        const bool is_there = between(0, 1) < 0.8;
        const double height = std::round(100.0 * between(0, 12)) / 100.0;
        text += (is_there ? std::to_string(height) : "-9999") + (column == 5 ? "\n" : " ");
        if (!is_there) continue;
        const Vector3d low(corner.x() + 2 * column, corner.y() + 2 * row, -1000.0);
        cells.emplace_back(low, Vector3d(low.x() + 2, low.y() + 2, height));
      }
    }
    const Source& source = add_source(".asc", text);
    const Vector3d off = error(*source.uncertainty);
    for (AlignedBox3d& cell : cells) truth_.push_back(cell.translate(off));
  }

  static constexpr const char* local_wkt =
      "LOCAL_CS[\"local east-north-up\",LOCAL_DATUM[\"mission origin\",0]]";

  std::mt19937_64& random_;
  std::filesystem::path name_;
  std::vector<Source> sources_;
  Truth truth_;
};

flight::KnownSpace known_space(const RandomSite& site) {
  flight::Obstacles obstacles;
  obstacles.priors = read_site_priors(site.sources(), {}, [](std::size_t, const std::string& what) {
                       throw Error(ErrorKind::bad_config, what);
                     }).obstacles;
  return flight::KnownSpace(obstacles);
}

std::size_t legs_to_try() {
  const char* const enabled = std::getenv("PRIOR_LEGS");  // NOLINT(concurrency-mt-unsafe)
  return enabled == nullptr ? 10'000 : std::stoul(enabled);
}

TEST(PriorLegs, AreVerifiedOnlyWhenClearOfGroundTruth) {
  std::mt19937_64 random(1019);
  const testing_support::TemporaryFolder folder;
  constexpr std::size_t legs_per_site = 500;
  std::size_t verified = 0, rejected = 0, touching = 0;
  for (std::size_t done = 0; done < legs_to_try(); done += legs_per_site) {
    const RandomSite site(random, folder, static_cast<int>(done / legs_per_site));
    const flight::KnownSpace space = known_space(site);
    std::uniform_real_distribution<double> clearances(0.2, 3.0);
    const AlignedBox3d around(Vector3d(-40, -40, 0), Vector3d(35, 35, 35));
    for (const Segment& leg : flight::scenes::legs(random, legs_per_site, around)) {
      const double clearance = clearances(random);
      double min = 1e9;
      for (const AlignedBox3d& thing : site.truth()) {
        min = std::min(min, distance(leg, thing));
      }
      touching += min == 0.0 ? 1 : 0;
      if (!space.is_free(leg, clearance)) {
        ++rejected;
        continue;
      }
      ++verified;
      // Single precision rounds by less than 0.1 mm.
      ASSERT_GE(min, clearance - 1e-4) << "leg " << verified + rejected;
    }
  }
  RecordProperty("legs", static_cast<int>(verified + rejected));
  RecordProperty("certified", static_cast<int>(verified));
  RecordProperty("really in the way", static_cast<int>(touching));
  EXPECT_GT(verified, legs_to_try() / 10);
  EXPECT_GT(rejected, legs_to_try() / 20);
  EXPECT_GT(touching, legs_to_try() / 50);
}

}  // namespace
}  // namespace skycap::missions::site_data
