/// Standard flight patterns of photogrammetry: survey/patterns with the footprint of a photo.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"
#include "survey/patterns/patterns.h"
#include "survey/photo/candidates.h"

namespace skycap::survey::photo {

using patterns::Pattern;
using patterns::pattern_named;
using patterns::PatternOptions;
using PatternPhotos = patterns::PatternViews;

/// Returns the photos of a pattern around a target, see patterns::pattern_views(). A corridor runs
/// along the long axis of the target.
PatternPhotos pattern_photos(Pattern pattern, const geometry::PhotoCamera& camera,
                             const geometry::Mesh& target, const PatternOptions& options,
                             const PhotoSpace& space);

}  // namespace skycap::survey::photo
