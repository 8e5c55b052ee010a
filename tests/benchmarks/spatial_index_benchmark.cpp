/// Benchmark of the structures behind SpatialIndex. The same queries run on Skycap's grid, CGAL's
/// kd-tree (used in the forest), nanoflann and PCL's octree. The points form a building-sized shell
/// with SEE's spacing.
///
///   spatial_index_benchmark [points of the scan, 4000000]
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Simple_cartesian.h>
#include <nanoflann.hpp>
#include <pcl/octree/octree_search.h>

#include "geometry/points/density.h"
#include "geometry/points/point_grid.h"
#include "tests/benchmarks/interleaved.h"

namespace {

using Eigen::Vector3f;
using skycap::benchmarks::interleaved_medians;
using skycap::geometry::Neighbour;
using skycap::geometry::PointGrid;

constexpr double radius = 0.15, spacing = 0.0685;  // r and epsilon of the building in the paper
constexpr int rounds = 5;

/// Returns random points on a cylinder 40 m high and 30 m wide, with 1 cm of noise.
std::vector<Vector3f> shell(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  std::vector<Vector3f> points(count);
  for (Vector3f& p : points) {
    const float azimuth = 6.2831853F * uniform(random), across = 15.0F + noise(random);
    p = {across * std::cos(azimuth), across * std::sin(azimuth), 40.0F * uniform(random)};
  }
  return points;
}

/// Sorts the points into rows 3 cm high, each in the order of a scan line.
std::vector<Vector3f> in_rows(std::vector<Vector3f> points) {
  const auto sample_at = [](const Vector3f& p) {
    return std::pair(std::floor(p.z() / 0.03F), std::atan2(p.y(), p.x()));
  };
  std::ranges::sort(points, {}, sample_at);
  return points;
}

/// Adapts a vector of points to nanoflann.
struct PointsForNanoflann {
  const std::vector<Vector3f>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return points[index][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Nanoflann =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointsForNanoflann>,
                                        PointsForNanoflann, 3>;

using Kernel = CGAL::Simple_cartesian<double>;
using CgalTraits = CGAL::Search_traits_3<Kernel>;
using CgalTree = CGAL::Kd_tree<CgalTraits>;

void print(const char* what, const char* other, skycap::benchmarks::Medians times,
           std::size_t work) {
  const double each = 1e9 / static_cast<double>(work);
  std::printf("%-34s grid %7.0f ns   %-10s %7.0f ns   %s / grid = %.1f\n", what, each * times.first,
              other, each * times.second, other, times.second / times.first);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Vector3f> scan =
      shell(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 4'000'000);
  skycap::geometry::DensityMap map({.radius = radius, .core_threshold = 4, .spacing = spacing});
  map.insert(scan, 0);
  const std::vector<Vector3f>& points = map.cloud().positions;
  const std::vector<Vector3f> queries(scan.begin(), scan.begin() + scan.size() / 40);
  std::printf("%zu points at a spacing of %.4f m, balls of %.2f m, medians of %d rounds\n",
              points.size(), spacing, radius, rounds);

  PointGrid grid(radius);
  for (const Vector3f& p : points) grid.insert(p);
  const PointsForNanoflann nanoflann_points{points};
  Nanoflann nanoflann(3, nanoflann_points, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  nanoflann.buildIndex();
  std::vector<Kernel::Point_3> cgal_points;
  for (const Vector3f& p : points) cgal_points.emplace_back(p.x(), p.y(), p.z());
  CgalTree cgal(cgal_points.begin(), cgal_points.end());
  cgal.build();
  const auto pcl_points = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const Vector3f& p : points) pcl_points->emplace_back(p.x(), p.y(), p.z());
  pcl::octree::OctreePointCloudSearch<pcl::PointXYZ> octree(radius);
  octree.setInputCloud(pcl_points);
  octree.addPointsFromInputCloud();

  // All neighbours within the radius. The counts of the four structures must be equal.
  std::size_t found_by_grid = 0, found_by_other = 0;
  const auto ask_grid = [&] {
    std::vector<Neighbour> found;
    found_by_grid = 0;
    for (const Vector3f& query : queries) {
      found.clear();
      grid.find_within(query, radius, found);
      found_by_grid += found.size();
    }
  };
  const auto compare = [&](const char* name, auto ask_other) {
    print("neighbours within r", name, interleaved_medians(rounds, ask_grid, ask_other),
          queries.size());
    std::printf("%36sfound %zu and %zu\n", "", found_by_grid, found_by_other);
  };
  compare("nanoflann", [&] {
    std::vector<std::pair<std::uint32_t, float>> found;
    found_by_other = 0;
    for (const Vector3f& query : queries) {
      found_by_other += nanoflann.radiusSearch(query.data(), static_cast<float>(radius * radius),
                                               found, nanoflann::SearchParams(32, 0.0F, false));
    }
  });
  compare("CGAL", [&] {
    std::vector<Kernel::Point_3> found;
    found_by_other = 0;
    for (const Vector3f& query : queries) {
      found.clear();
      cgal.search(
          std::back_inserter(found),
          CGAL::Fuzzy_sphere<CgalTraits>(Kernel::Point_3(query.x(), query.y(), query.z()), radius));
      found_by_other += found.size();
    }
  });
  compare("PCL octree", [&] {
    pcl::Indices found;
    std::vector<float> distances;
    found_by_other = 0;
    for (const Vector3f& query : queries) {
      found_by_other += static_cast<std::size_t>(
          octree.radiusSearch({query.x(), query.y(), query.z()}, radius, found, distances));
    }
  });

  // Large radius, for which the kd-tree in the forest pays off.
  const std::vector<Vector3f> few(queries.begin(),
                                  queries.begin() + std::min<std::size_t>(300, queries.size()));
  const auto large_with_grid = [&] {
    std::vector<Neighbour> found;
    for (const Vector3f& query : few) {
      found.clear();
      grid.find_within(query, 5.0, found);
    }
  };
  print("neighbours within 5 m", "CGAL",
        interleaved_medians(rounds, large_with_grid,
                            [&] {
                              std::vector<Kernel::Point_3> found;
                              for (const Vector3f& query : few) {
                                found.clear();
                                cgal.search(
                                    std::back_inserter(found),
                                    CGAL::Fuzzy_sphere<CgalTraits>(
                                        Kernel::Point_3(query.x(), query.y(), query.z()), 5.0));
                              }
                            }),
        few.size());

  // Insertion of one scan at the spacing, compared with a copy of the points. The points arrive in
  // the original order, at random, and in rows like those of a scanner.
  const auto compare_insertion = [](const char* what, const std::vector<Vector3f>& returns) {
    const auto grow = [&] {
      skycap::geometry::DensityMap growing(
          {.radius = radius, .core_threshold = 4, .spacing = spacing});
      growing.insert(returns, 0);
    };
    print(what, "raw copy",
          interleaved_medians(rounds, grow,
                              [&] {
                                std::vector<Vector3f> copy;
                                for (const Vector3f& p : returns) copy.push_back(p);
                              }),
          returns.size());
  };
  compare_insertion("insert a return at the spacing", scan);
  compare_insertion("insert a return of a row", in_rows(scan));
  const auto build_grid = [&] {
    PointGrid fresh(radius);
    for (const Vector3f& p : points) fresh.insert(p);
  };
  print("build from the kept points", "nanoflann",
        interleaved_medians(rounds, build_grid,
                            [&] {
                              Nanoflann fresh(3, nanoflann_points,
                                              nanoflann::KDTreeSingleIndexAdaptorParams(10));
                              fresh.buildIndex();
                            }),
        points.size());
}
