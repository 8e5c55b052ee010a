/// Interpretations of the SEE++ paper where it is ambiguous or differs from the released code.
/// Their effects on the results are described in docs/explanation/see.md.
#pragma once

namespace skycap::survey::see {

/// Definition of the observing direction of a point in the view optimisation.
enum class ObservingDirection {
  ray,         ///< from the sensor that measured the point to the point
  image_axis,  ///< optical axis of that sensor
};

/// Set of points whose centroid determines the measured side of the frontier during view
/// adjustment.
enum class ScanCentroid {
  whole_scan,       ///< all points of the scan
  accepted_points,  ///< only points that were kept at the spacing epsilon
};

/// Line from a frontier along which the clear offset (zeta) is determined.
enum class OffsetLine {
  line_of_sight,  ///< towards the sensor that first measured the point (paper §III-A)
  normal,         ///< along the surface normal (released code)
};

/// End of the occlusion test. Never behind the sensor.
enum class MarchEnd {
  search_distance,              ///< at the distance psi from the frontier (paper)
  search_distance_from_offset,  ///< at the distance zeta + psi (released code)
};

/// Method of the search for the view nearest to the sensor.
enum class NearestSearch {
  exact,
  octree,  ///< approximate, as in the released code
};

/// Treatment of a frontier that is occluded even from the clearest direction.
enum class StillOccluded {
  discard,   ///< outlier until a new point is measured nearby (paper)
  deferred,  ///< deferred, and finally viewed on the line from which it was measured (extension of
             ///< Skycap)
  keep,      ///< the view is used unchanged
};

/// Adjustment of a view that did not resolve its frontier.
enum class Adjustment {
  rotation,  ///< shift and rotation about the frontier, with a gain that doubles (released code)
  shift,     ///< shift without rotation
  none,      ///< the frontier is discarded after the first failure
};

}  // namespace skycap::survey::see
