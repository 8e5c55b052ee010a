#include "survey/photo/patterns.h"

namespace skycap::survey::photo {

PatternPhotos pattern_photos(Pattern pattern, const geometry::PhotoCamera& camera,
                             const geometry::Mesh& target, const PatternOptions& options,
                             const PhotoSpace& space) {
  const Eigen::Vector2d footprint = options.view_distance / camera.focal_length_px() *
                                    Eigen::Vector2d(camera.width(), camera.height());
  return patterns::pattern_views(pattern, footprint,
                                 patterns::target_of(geometry::triangle_corners(target)), options,
                                 [&](const geometry::View& view) { return space.allows(view); });
}

}  // namespace skycap::survey::photo
