/// A choice of the density labels (density.h).
#pragma once

namespace skycap::geometry {

/// Which neighbour, besides a core one, makes a point a frontier.
enum class OutlierRule {
  non_core,  ///< any other non-core point. The labels follow from the cloud alone.
  labelled,  ///< a point now labelled outlier, perhaps the point itself. The labels depend on the
             ///< order of points and updates, as in the authors' released code.
};

}  // namespace skycap::geometry
