#include "flight/interpreter/fence_check.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Maximum distance of equal corners [degrees], about 0.1 m.
constexpr double same_corner = 1e-6;

/// Footprints closer than this to a leg may be omitted from the file [m].
constexpr double grazing = 0.05;

/// Returns the piece projected to the ground.
Segment flat(const InterpretedSegment& segment) {
  Segment leg{segment.start.to, segment.to};
  leg.from.z() = leg.to.z() = 0.0;
  return leg;
}

/// Minimum distance of all pieces from a footprint, and the pieces that touch it.
struct FootprintContact {
  double distance = std::numeric_limits<double>::infinity();
  std::vector<const InterpretedSegment*> segments;
};

FootprintContact find_contact(const InterpretedRoute& route, const Obstacles& footprint) {
  const KnownSpace space(footprint);
  FootprintContact result;
  for (const InterpretedSegment& segment : route.segments) {
    const double distance = space.closest(flat(segment), grazing).distance;
    result.distance = std::min(result.distance, distance);
    if (distance <= clearance_guard) result.segments.push_back(&segment);
  }
  return result;
}

bool is_same(const GeodeticPoint& a, const GeodeticPoint& b) {
  return std::abs(a.latitude_deg - b.latitude_deg) < same_corner &&
         std::abs(a.longitude_deg - b.longitude_deg) < same_corner;
}

/// Returns true if the polygons have the same corners, in either direction and from any start.
bool is_same(const std::vector<GeodeticPoint>& a, const std::vector<GeodeticPoint>& b) {
  const std::size_t n = a.size();
  if (b.size() != n) return false;
  for (std::size_t shift = 0; shift < n; ++shift) {
    bool forward = true, backward = true;
    for (std::size_t i = 0; i < n && (forward || backward); ++i) {
      forward = forward && is_same(a[i], b[(i + shift) % n]);
      backward = backward && is_same(a[i], b[(shift + n - i) % n]);
    }
    if (forward || backward) return true;
  }
  return false;
}

bool contains(const MavlinkMission& file, const Prism& prism, bool is_inclusion,
              const LocalFrame& frame) {
  std::vector<GeodeticPoint> corners;
  for (const Eigen::Vector2d& corner : prism.footprint) {
    corners.push_back(frame.to_geodetic({corner.x(), corner.y(), 0.0}));
  }
  return std::ranges::any_of(file.fence, [&](const FenceArea& area) {
    return area.is_inclusion == is_inclusion && is_same(area.corners, corners);
  });
}

void check_area(const FenceArea& area, const InterpretedRoute& route, const LocalFrame& frame,
                Problems& problems) {
  Prism prism{area.name, {}};
  for (const GeodeticPoint& corner : area.corners) {
    prism.footprint.emplace_back(frame.to_local(corner).head<2>());
  }
  Obstacles footprint;
  if (area.is_inclusion) {
    footprint.fence = prism;
  } else {
    footprint.no_fly = {prism};
  }
  try {
    for (const InterpretedSegment* segment : find_contact(route, footprint).segments) {
      problems.push_back("leg from " + segment->from_item + " to " + segment->to_item +
                         (area.is_inclusion ? " leaves " : " enters ") + area.name);
    }
  } catch (const Error& error) {
    problems.emplace_back(error.what());
  }
}

}  // namespace

Problems check_fence(const MavlinkMission& file, const InterpretedRoute& route,
                     const FlightFacts& facts) {
  Problems problems;
  if (!file.supports_fence) return problems;
  const LocalFrame frame(facts.site.origin);
  for (const FenceArea& area : file.fence) check_area(area, route, frame, problems);
  if (facts.fence && !contains(file, *facts.fence, true, frame)) {
    problems.push_back("geoFence does not contain the mission's fence \"" + facts.fence->name +
                       "\"");
  }
  for (const Prism& prism : facts.no_fly) {
    if (std::isfinite(prism.ceiling)) continue;  // A return may pass above it.
    Obstacles footprint;
    footprint.no_fly = {{prism.name, prism.footprint}};  // Unbounded in height.
    if (contains(file, prism, false, frame) || find_contact(route, footprint).distance < grazing)
      continue;
    problems.push_back("geoFence does not contain the mission's no-fly volume \"" + prism.name +
                       "\"");
  }
  return problems;
}

}  // namespace skycap::flight
