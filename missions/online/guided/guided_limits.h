/// What is asked of a flight that is guided from here.
#pragma once

namespace skycap::missions::online {

struct GuidedLimits {
  double corridor = 1.0;    ///< how far from its leg the vehicle may take itself to be [m]
  double arrival = 0.3;     ///< how near to a stop it has to come [m]
  double hold = 0.5;        ///< at rest and aimed before a scan [s]
  double patience = 60.0;   ///< for a vehicle to be heard and to know where it is [s]
  double pad_radius = 2.0;  ///< how far from the pad it may stand [m]
  double pad_height = 1.0;  ///< how far from its height it may take itself to be [m]
};

}  // namespace skycap::missions::online
