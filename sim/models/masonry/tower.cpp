#include "sim/models/masonry/tower.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace skycap::sim::models {

namespace {

using Eigen::Vector2d;
using geometry::Mesh;
using std::numbers::pi;
using Loop = std::vector<std::uint32_t>;

}  // namespace

Tower::Tower(double bottom) { mesh_.vertices.emplace_back(0.0, 0.0, bottom); }

Tower& Tower::add(const Polyline2& profile, int chords) {
  for (const Vector2d& point : profile) {
    Loop ring;
    for (int j = 0; j < chords; ++j) {
      const double azimuth = 2.0 * pi * j / chords;
      ring.push_back(static_cast<std::uint32_t>(mesh_.vertices.size()));
      mesh_.vertices.emplace_back(point.x() * std::cos(azimuth), point.x() * std::sin(azimuth),
                                  point.y());
    }
    join_to(ring);
  }
  return *this;
}

Tower& Tower::add(const Band& band) {
  const auto offset = static_cast<std::uint32_t>(mesh_.vertices.size());
  append(mesh_, band.mesh);
  Loop bottom = band.bottom, top = band.top;
  for (std::uint32_t& v : bottom) v += offset;
  for (std::uint32_t& v : top) v += offset;
  join_to(bottom);
  rim_ = std::move(top);
  return *this;
}

Mesh Tower::close(double top) {
  const auto apex = static_cast<std::uint32_t>(mesh_.vertices.size());
  mesh_.vertices.emplace_back(0.0, 0.0, top);
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    mesh_.triangles.push_back({rim_[i], rim_[(i + 1) % rim_.size()], apex});
  }
  return std::move(mesh_);
}

void Tower::join_to(const Loop& next) {
  if (rim_.empty()) {  // The floor, seen from below.
    for (std::size_t i = 0; i < next.size(); ++i) {
      mesh_.triangles.push_back({0, next[(i + 1) % next.size()], next[i]});
    }
    rim_ = next;
    return;
  }
  const auto azimuth = [&](std::uint32_t v) {
    return std::atan2(mesh_.vertices[v].y(), mesh_.vertices[v].x());
  };
  const auto gap = [&](std::uint32_t a, std::uint32_t b) {
    return std::abs(std::remainder(azimuth(b) - azimuth(a), 2.0 * pi));
  };
  const auto nearest = std::min_element(
      next.begin(), next.end(),
      [&](std::uint32_t a, std::uint32_t b) { return gap(rim_[0], a) < gap(rim_[0], b); });
  const auto first = static_cast<std::size_t>(nearest - next.begin());
  const auto lower = [&](std::size_t i) { return rim_[i % rim_.size()]; };
  const auto upper = [&](std::size_t j) { return next[(first + j) % next.size()]; };

  // Azimuths along each edge, increasing beyond a full circle.
  const auto azimuths = [&](const auto& vertex, std::size_t size, double start) {
    std::vector<double> angles{start};
    for (std::size_t i = 1; i <= size; ++i) {
      const double step = azimuth(vertex(i)) - azimuth(vertex(i - 1));
      angles.push_back(angles.back() + std::remainder(step, 2.0 * pi));
    }
    return angles;
  };
  const double lag = std::remainder(azimuth(upper(0)) - azimuth(lower(0)), 2.0 * pi);
  const std::vector<double> below = azimuths(lower, rim_.size(), 0.0);
  const std::vector<double> above = azimuths(upper, next.size(), lag);

  // Both edges are traversed together. Each step is on the edge whose next side has the smaller
  // mean azimuth, so no triangle crosses a corner of the plan.
  std::size_t i = 0, j = 0;
  while (i < rim_.size() || j < next.size()) {
    const bool step_below =
        j == next.size() || (i < rim_.size() && below[i] + below[i + 1] <= above[j] + above[j + 1]);
    if (step_below) {
      mesh_.triangles.push_back({lower(i), lower(i + 1), upper(j)});
      ++i;
    } else {
      mesh_.triangles.push_back({lower(i), upper(j + 1), upper(j)});
      ++j;
    }
  }
  rim_ = next;
}

}  // namespace skycap::sim::models
