// Outlines and groups of the buildings in a district, and the models that are cut out.
#include "missions/batch/district/targets.h"

#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/batch/district/city_text.h"
#include "missions/batch/district/outline.h"
#include "tests/flight/scenes.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions::batch {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using flight::scenes::box;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

site_data::Object object(const std::string& id, const geometry::Mesh& mesh) {
  site_data::Object made;
  made.id = id;
  made.mesh = mesh;
  made.surfaces.assign(mesh.triangles.size(), site_data::SurfaceKind::roof);
  return made;
}

std::vector<std::vector<double>> corners(const Ring& ring) {
  std::vector<std::vector<double>> list;
  for (const Vector2d& location : ring) list.push_back({location.x(), location.y()});
  return list;
}

TEST(Outline, IsBaseOfBox) {
  const auto rings = compute_outline(box({1, 2, 0}, {4, 6, 9}));
  ASSERT_EQ(rings.size(), 1U);
  EXPECT_THAT(corners(rings[0]), UnorderedElementsAre(ElementsAre(1, 2), ElementsAre(4, 2),
                                                      ElementsAre(4, 6), ElementsAre(1, 6)));
}

TEST(Outline, HasTwoRingsForTwoBoxes) {
  geometry::Mesh mesh = box({0, 0, 0}, {2, 2, 5});
  append(mesh, box({5, 0, 0.2}, {7, 2, 5}));
  append(mesh, box({9, 0, 3}, {11, 2, 5}));  // has no support below it
  EXPECT_EQ(compute_outline(mesh).size(), 2U);
}

// A tent has no floor.
TEST(Outline, IsHullWithoutLevelFace) {
  geometry::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 3}};
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const auto rings = compute_outline(mesh);
  ASSERT_EQ(rings.size(), 1U);
  EXPECT_THAT(corners(rings[0]), ElementsAre(ElementsAre(0, 0), ElementsAre(4, 0),
                                             ElementsAre(4, 4), ElementsAre(0, 4)));
}

TEST(Groups, JoinsObjectsWithinMergeDistance) {
  const std::vector<site_data::Object> row{
      object("a", box({0, 0, 0}, {10, 10, 8})), object("b", box({30, 0, 0}, {40, 10, 8})),
      object("c", box({10, 0, 0}, {20, 10, 6})), object("d", box({20.3, 0, 0}, {29, 10, 6}))};
  EXPECT_THAT(grouped(row, 0.5), ElementsAre(ElementsAre(0, 2, 3), ElementsAre(1)));
  EXPECT_THAT(grouped(row, 1.5), ElementsAre(ElementsAre(0, 1, 2, 3)));
  EXPECT_EQ(grouped(row, 0.0).size(), 4U);
}

// A row of terraced houses is divided into several surveys.
TEST(Groups, LimitsGroupSize) {
  std::vector<site_data::Object> street;
  street.reserve(20);
  for (int i = 0; i < 20; ++i) {
    street.push_back(object(std::to_string(i), box({10.0 * i, 0, 0}, {10.0 * i + 10, 10, 8})));
  }
  std::size_t members = 0;
  for (const Group& group : grouped(street, 0.5)) {
    members += group.size();
    EXPECT_LE(group.size(), 8U);
  }
  EXPECT_EQ(members, street.size());
}

TEST(CityJsonWriter, WritesObjectsThatReadBackEqual) {
  const tests::TestFolder folder;
  site_data::Object tower = object("tower \"A\"", box({1000.25, -3, 0}, {1010.5, 7, 21.125}));
  tower.surfaces.back() = site_data::SurfaceKind::wall;
  const site_data::Object shed = object("shed", box({0, 0, 0}, {3, 2, 2}));
  site_data::Source source;
  const std::vector<const site_data::Object*> objects{&tower, &shed};
  source.file = folder.write("cut.city.json", city_text(objects));
  const site_data::Prior read = site_data::read_prior(source, {});
  ASSERT_EQ(read.objects.size(), 2U);
  for (const site_data::Object* written : objects) {
    const auto found = std::ranges::find(read.objects, written->id, &site_data::Object::id);
    ASSERT_NE(found, read.objects.end());
    const auto box_read = geometry::bounding_box(found->mesh);
    const auto box_written = geometry::bounding_box(written->mesh);
    EXPECT_LE((box_read.min() - box_written.min()).cwiseAbs().maxCoeff(), city_step);
    EXPECT_LE((box_read.max() - box_written.max()).cwiseAbs().maxCoeff(), city_step);
    EXPECT_NEAR(surface_area(found->mesh), surface_area(written->mesh), 1e-2);
    EXPECT_EQ(std::ranges::count(found->surfaces, site_data::SurfaceKind::wall),
              std::ranges::count(written->surfaces, site_data::SurfaceKind::wall));
  }
}

}  // namespace
}  // namespace skycap::missions::batch
