#include "missions/batch/district/pad_choice.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "geometry/error.h"

namespace skycap::missions::batch {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Of targets from pads [m].
constexpr double reach = 300.0;

std::vector<AlignedBox3d> unknown_boxes(std::span<const PreparedTarget> targets) {
  std::vector<AlignedBox3d> boxes;
  for (const PreparedTarget& target : targets) boxes.push_back(target.unknown);
  return boxes;
}

/// On the map.
double distance(const Vector3d& pad, const AlignedBox3d& box) {
  const Eigen::AlignedBox2d base(box.min().head<2>().eval(), box.max().head<2>().eval());
  return base.exteriorDistance(Eigen::Vector2d(pad.head<2>()));
}

}  // namespace

PadChoice::PadChoice(const DistrictFile& district, const flight::FlightOptions& draft,
                     const flight::GeodeticPoint& origin, std::span<const PreparedTarget> targets)
    : targets_(targets), search_(draft, unknown_boxes(targets)), own_(targets.size()) {
  take_given(district, origin);
}

void PadChoice::take_given(const DistrictFile& district, const flight::GeodeticPoint& origin) {
  const flight::LocalFrame frame(origin);
  double top = 0.0;
  for (const PreparedTarget& target : targets_) top = std::max(top, target.unknown.max().z());
  for (const wizard::Click& click : district.pads) {
    const Vector3d place = frame.to_local({click.latitude_deg, click.longitude_deg, origin.height});
    const auto pad = search_.at(place.head<2>());
    if (!pad || search_.room_over(*pad, top, 1.0) <= 0.0) {
      throw Error(ErrorKind::bad_config,
                  fmt::format("{}: key pads: {:.7f},{:.7f} is not free, level and even ground "
                              "outside the surveyed objects; use another position",
                              district.file.string(), click.latitude_deg, click.longitude_deg));
    }
    given_.push_back(*pad);
  }
}

std::optional<Vector3d> PadChoice::pad_of(std::size_t target, double top) {
  const AlignedBox3d& unknown = targets_[target].unknown;
  own_[target] = search_.beside(unknown, top);
  if (own_[target] || given_.empty()) return own_[target];
  return *std::ranges::min_element(given_, {},
                                   [&](const Vector3d& pad) { return distance(pad, unknown); });
}

std::vector<Vector3d> PadChoice::pads_of_flight() const {
  if (!given_.empty()) return given_;
  AlignedBox3d all;
  for (const PreparedTarget& target : targets_) all.extend(target.unknown);
  std::vector<Vector3d> pads;
  const Vector3d* next = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& pad : own_) {
    if (!pad) continue;
    const double here = (pad->head<2>() - all.center().head<2>()).norm();
    if (here < nearest) next = &*pad;
    nearest = std::min(nearest, here);
  }
  while (next != nullptr) {
    pads.push_back(*next);
    next = nullptr;
    double farthest = reach;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      if (!own_[i]) continue;
      double off = std::numeric_limits<double>::infinity();
      for (const Vector3d& pad : pads) off = std::min(off, distance(pad, targets_[i].unknown));
      if (off > farthest) next = &*own_[i];
      farthest = std::max(farthest, off);
    }
  }
  return pads;
}

}  // namespace skycap::missions::batch
