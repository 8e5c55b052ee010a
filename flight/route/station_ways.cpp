#include "flight/route/station_ways.h"

#include "flight/paths/sampling_path.h"

namespace skycap::flight {

using Eigen::Vector3d;

namespace {

/// Whether the survey came to a station from that place.
bool is_flown(const Vector3d& from, const Station& to) {
  return !to.way.empty() && to.way.front() == from && to.way.back() == to.view.position;
}

}  // namespace

StationWays::StationWays(const FreeSpace& space, const Vector3d& home, const RouteOptions& options)
    : space_(space),
      home_(home),
      clearance_(options.clearance.total()),
      worthwhile_saving_(options.path.worthwhile_saving),
      keeps_order_(!options.order_is_free),
      finder_(space, clearance_, options.path) {}

std::vector<Vector3d> StationWays::from_home(const Station& to) {
  if (std::vector<Vector3d> way = flown(home_, to); !way.empty() && is_free(way)) return way;
  Path path = finder_.find(home_, to.view.position);
  if (path.status == PathStatus::unreachable) {
    path = find_path_by_sampling(space_, home_, to.view.position, clearance_);
  }
  return path.status == PathStatus::found ? path.points : all_flown(to);
}

bool StationWays::is_free(const std::vector<Vector3d>& way) const {
  for (std::size_t i = 1; i < way.size(); ++i) {
    if (!space_.is_free({way[i - 1], way[i]}, clearance_)) return false;
  }
  return true;
}

std::vector<Vector3d> StationWays::flown(const Vector3d& from, const Station& to) const {
  return keeps_order_ && is_flown(from, to) ? to.way : std::vector<Vector3d>();
}

std::vector<Vector3d> StationWays::found(const Vector3d& from, const Vector3d& to) {
  const Path path = finder_.find(from, to);
  return path.status == PathStatus::found ? path.points : std::vector<Vector3d>();
}

std::vector<Vector3d> StationWays::all_flown(const Station& to) const {
  std::vector<Vector3d> way = {home_};
  for (const Station& next : flown_) {
    if (!is_flown(way.back(), next)) return {};
    way.insert(way.end(), next.way.begin() + 1, next.way.end());
    if (next.view_index == to.view_index) {
      return pull_tight(space_, clearance_, std::move(way), worthwhile_saving_);
    }
  }
  return {};
}

}  // namespace skycap::flight
