#include "flight/route/leg_planner.h"

#include <algorithm>
#include <utility>

#include "flight/paths/sampling_path.h"
#include "flight/route/route.h"

namespace skycap::flight {

using Eigen::Vector3d;

LegPlanner::LegPlanner(const FreeSpace& space, double clearance, const PathOptions& options)
    : space_(space),
      worthwhile_saving_(options.worthwhile_saving),
      finder_(space, clearance, options) {}

void LegPlanner::require_returns(const RtlProfile& rtl_profile, const Vector3d& home) {
  returns_.emplace(space_, rtl_profile, home, clearance());
}

const Path& LegPlanner::path(const Vector3d& from, const Vector3d& to) {
  const std::array ends{from.x(), from.y(), from.z(), to.x(), to.y(), to.z()};
  if (const auto known = paths_.find(ends); known != paths_.end()) return known->second;
  return paths_.emplace(ends, finder_.find(from, to)).first->second;
}

Path LegPlanner::wide_or_narrow_path(const Vector3d& from, const Vector3d& to) {
  const Path& wide = path(from, to);
  if (wide.status != PathStatus::unreachable) return wide;
  return find_path_by_sampling(space_, from, to, clearance());
}

std::vector<Vector3d> LegPlanner::with_returns(std::vector<Vector3d> path) const {
  if (!returns_) return path;
  return returns_->with_returns(std::move(path), worthwhile_saving_);
}

std::optional<VerifiedPath> LegPlanner::verified(std::vector<Vector3d> path) const {
  if (path.empty()) return std::nullopt;
  const double cap = clearance() + reported_surplus;
  VerifiedPath leg{std::move(path), cap};
  for (std::size_t i = 1; i < leg.points.size(); ++i) {
    const LegVerification verification =
        verify(space_, {leg.points[i - 1], leg.points[i]}, clearance(), cap);
    if (!verification.is_verified) return std::nullopt;
    leg.clearance = std::min(leg.clearance, verification.clearance);
  }
  return leg;
}

std::optional<VerifiedPath> LegPlanner::leg(const Vector3d& from, const Vector3d& to) {
  if (returns_ && returns_->no_return_reason(to)) return std::nullopt;
  const Path& found = path(from, to);
  if (found.status != PathStatus::found) return std::nullopt;
  return verified(with_returns(found.points));
}

std::vector<Vector3d> LegPlanner::pulled_tight(std::vector<Vector3d> path) const {
  return pull_tight(space_, clearance(), std::move(path), worthwhile_saving_);
}

void LegPlanner::forget() {
  finder_.forget();
  paths_.clear();
}

}  // namespace skycap::flight
