#include "missions/wizard/takeoff_point.h"

#include <Eigen/Geometry>

#include "missions/wizard/pad_search.h"

namespace skycap::missions::wizard {

Eigen::Vector3d choose_takeoff(const flight::FlightOptions& options,
                               std::span<const geometry::View> views) {
  if (options.takeoff) return *options.takeoff;
  Eigen::AlignedBox3d box = options.unknown_box;
  for (const Eigen::AlignedBox3d& other : options.extra_unknown_boxes) box.extend(other);
  for (const geometry::View& view : views) box.extend(view.position);
  constexpr double view_reach = 0.0;  // The box contains the views.
  const PadSearch search(options, {}, PadFence::keep);
  const Eigen::Vector3d pad = search.find_pad_beside(box, box.max().z(), view_reach)
                                  .value_or(options.pad(views.front().position));
  return pad + Eigen::Vector3d::Zero();  // Without negative zeros, for messages.
}

}  // namespace skycap::missions::wizard
