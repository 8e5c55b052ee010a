#include "missions/scan/scan_options.h"

#include "geometry/pose/platform.h"

namespace skycap::missions::scan {

Eigen::Isometry3d ScanFlightOptions::mount() const {
  Eigen::Isometry3d mount(geometry::make_rotation(mount_rotation));
  mount.translation() = mount_position;
  return mount;
}

}  // namespace skycap::missions::scan
