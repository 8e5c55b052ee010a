/// Variants of the density labels (density.h).
#pragma once

namespace skycap::geometry {

/// Neighbour that, in addition to a core point, makes a point a frontier.
enum class OutlierRule {
  non_core,  ///< Any other non-core point. The labels depend on the cloud alone.
  labelled,  ///< A point currently labelled as an outlier, possibly the point itself. The labels
             ///< depend on the order of points and updates, as in the authors' released code.
};

}  // namespace skycap::geometry
