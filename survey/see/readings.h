/// Where the SEE++ paper leaves a choice, or its released code does otherwise: each reading by
/// name. docs/explanation/see.md tells what each does to the results.
#pragma once

namespace skycap::survey::see {

/// What the optimiser calls the observing direction of a point.
enum class ObservingDirection {
  ray,         ///< from the sensor that measured the point to the point
  image_axis,  ///< the optical axis of that sensor
};

/// Whose centroid tells the adjustment on which side of the frontier the surface was seen.
enum class ScanCentroid {
  whole_scan,       ///< all points of the scan
  accepted_points,  ///< only those that were new at the spacing epsilon
};

/// Along which line from a frontier the clear offset (zeta) is looked for.
enum class OffsetLine {
  sight_line,  ///< towards the sensor that first measured the point (paper §III-A)
  normal,      ///< along the surface normal (released code)
};

/// Where the occlusion test ends. Never behind the sensor.
enum class MarchEnd {
  search_distance,              ///< at psi from the frontier (paper)
  search_distance_from_offset,  ///< at zeta + psi (released code)
};

/// How the view nearest to the sensor is found.
enum class NearestSearch {
  exact,
  octree,  ///< approximate, as in the released code
};

/// What becomes of a frontier that even the view from the clearest direction does not see.
enum class StillOccluded {
  give_up,  ///< it is an outlier until something new is measured beside it (paper)
  put_off,  ///< when nothing else is left it is looked at from where it was seen (ours)
  keep,     ///< the view is taken all the same
};

/// How a view is moved after it failed to resolve its frontier.
enum class Adjustment {
  rotation,  ///< shifted and turned about the frontier, with a gain that doubles (released code)
  shift,     ///< shifted without the turn
  none,      ///< the frontier is given up at the first failure
};

}  // namespace skycap::survey::see
