#include "survey/see/visibility_graph.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::survey {
namespace {

using Eigen::Vector3d;

// Trap T8: each condition of the selection in turn. The sensor is at the origin. Proposal 0 is the
// nearest one and covers one other frontier. Each test defines which proposals cover it.
class SelectByCoverage : public testing::Test {
 protected:
  std::size_t select() {
    return see::select_by_coverage(graph_, vertices_, positions_, 0, {0, 0, 0});
  }

  see::VisibilityGraph graph_;
  std::vector<std::uint32_t> vertices_ = {10, 20, 30, 40};
  std::vector<Vector3d> positions_ = {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
};

TEST_F(SelectByCoverage, SelectsNearestWhenNoViewSeesIt) {
  graph_.set_edges(10, {20});
  graph_.set_edges(20, {30, 40});
  EXPECT_EQ(select(), 0U);
}

TEST_F(SelectByCoverage, SelectsNearestWhenNoViewSeesMore) {
  graph_.set_edges(10, {20, 30});
  graph_.set_edges(20, {10, 30});  // equal count: the comparison is strict
  EXPECT_EQ(select(), 0U);
}

TEST_F(SelectByCoverage, SelectsMaxFrontiersPerMetreAmongViewsOfNearest) {
  graph_.set_edges(10, {20});
  graph_.set_edges(20, {10, 30});      // 2 frontiers for 2 m
  graph_.set_edges(30, {10, 20, 40});  // 3 frontiers for 3 m: not better, and farther away
  EXPECT_EQ(select(), 1U);
  positions_[2] = {2.9, 0, 0};
  EXPECT_EQ(select(), 2U);
}

TEST_F(SelectByCoverage, AcceptsProposalAtSensorPosition) {
  positions_[1] = {0, 0, 0};
  graph_.set_edges(20, {10});
  graph_.set_edges(30, {10, 20, 40});
  EXPECT_EQ(select(), 1U);
}

TEST(VisibilityGraph, RemovesEdgesWithTheirVertices) {
  see::VisibilityGraph graph;
  graph.set_edges(1, {2, 3});
  graph.set_edges(2, {1});
  graph.keep_only({1, 3});
  EXPECT_EQ(graph.out_degree(1), 1U);
  EXPECT_FALSE(graph.has_edge(1, 2));
  EXPECT_TRUE(graph.has_edge(1, 3));
  EXPECT_EQ(graph.out_degree(2), 0U);
  EXPECT_EQ(graph.out_degree(3), 0U);
}

}  // namespace
}  // namespace skycap::survey
